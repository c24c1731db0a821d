"""How the simulations of a campaign ended, and why some blocks have no result, kept next to the shards."""

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from enum import IntEnum
from pathlib import Path

from gfmd_numba.campaign import shards
from gfmd_numba.solvers import status
from gfmd_numba.storage import json_file

_SUFFIX = ".failed"


class Ending(IntEnum):
    """How a simulation of a campaign ended, if not as a contact does, whose states have other numbers."""

    timeout = 7
    crashed = 8
    unfinished = 9
    not_asked = 10


SENTENCES: dict[IntEnum, str] = {
    **status.SENTENCES,
    Ending.timeout: (
        "The block took longer than case_timeout: raise it, and run the block again with `gfmd run --retry-failed`."
    ),
    Ending.crashed: (
        "The program or its worker broke down: `gfmd status` gives the reason and the command that runs it again."
    ),
    Ending.unfinished: "The simulation has not run yet: `gfmd run` resumes.",
    Ending.not_asked: "The case has fewer realisations than others: nothing is missing.",
}


@dataclass(frozen=True)
class Failure:
    """How a block ended, `crashed` or `timeout`, and the reason in words."""

    status: str
    reason: str


def record(directory: Path, name: str, failure: Failure) -> None:
    """Keep the failure of a block in a campaign's output directory."""
    json_file.write(path_of(directory, name), asdict(failure))


def forget(directory: Path, name: str) -> None:
    """Let a block be tried again."""
    json_file.remove(path_of(directory, name))


def of(directory: Path, name: str) -> Failure | None:
    """Return the failure of a block, None if there is none that can be read."""
    found = json_file.read(path_of(directory, name))
    return Failure(**found) if found else None


def of_all(directory: Path, names: Iterable[str]) -> dict[str, Failure]:
    """Return the failures of those blocks that have failed, by name."""
    found = {name: of(directory, name) for name in names}
    return {name: failure for name, failure in found.items() if failure is not None}


def path_of(directory: Path, name: str) -> Path:
    """Return the file in which the failure of a block is kept."""
    return directory / shards.FOLDER / f"{name}{_SUFFIX}"

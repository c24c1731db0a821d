"""Why some blocks have no result: kept next to the shards until they are tried again."""

from dataclasses import asdict, dataclass
from pathlib import Path

from gfmd_numba.campaign import shards
from gfmd_numba.campaign.outcome import Outcome
from gfmd_numba.storage import json_file

_SUFFIX = ".failed"
_OUTCOMES = (Outcome.crashed.name, Outcome.timeout.name)


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
    """Failure of a block, None if there is none that can be read."""
    found = json_file.read(path_of(directory, name))
    status, reason = found.get("status"), found.get("reason")
    return (
        Failure(status, reason) if isinstance(status, str) and status in _OUTCOMES and isinstance(reason, str) else None
    )


def path_of(directory: Path, name: str) -> Path:
    """File in which the failure of a block is kept."""
    return directory / shards.FOLDER / f"{name}{_SUFFIX}"

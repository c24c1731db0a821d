"""Why some blocks have no result: kept beside the shards until they are tried again."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from gfmd_numba.campaign import shards

_SUFFIX = ".failed"


@dataclass(frozen=True)
class Failure:
    """How a block ended, a name of `Status`, and the reason in words."""

    status: str
    reason: str


def record(directory: Path, name: str, failure: Failure) -> None:
    """Keep the failure of a block in a campaign's output directory."""
    shards.replace(_path(directory, name), json.dumps(asdict(failure)).encode())


def forget(directory: Path, name: str) -> None:
    """Let a block be tried again."""
    _path(directory, name).unlink(missing_ok=True)


def of(directory: Path, name: str) -> Failure | None:
    """Failure of a block, None if there is none that can be read."""
    try:
        return Failure(**json.loads(_path(directory, name).read_text()))
    except (OSError, ValueError, TypeError):
        return None


def _path(directory: Path, name: str) -> Path:
    return directory / "shards" / f"{name}{_SUFFIX}"

"""The version of results: what a shard holds and which code made it, derived so that nobody has to remember it."""

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path

from gfmd_numba.contact.observables import OBSERVABLES, Observable
from gfmd_numba.interface.table import LAWS
from gfmd_numba.solvers.table import SOLVERS

_PACKAGE = Path(__file__).parent.parent
_MAKE_NO_NUMBERS = {"analysis", "campaign", "cli", "scene", "simulate", "storage", "text"}  # of what a shard holds
_TEXT = rb'"""(?s:.*?)"""'
_PROSE = re.compile(  # lines of comments and docstrings, and empty ones; a text that is no docstring stays
    rb"^[ \t]*(?P<prose>#.*|[rR]?" + _TEXT + rb")?[ \t]*\n|(?P<kept>" + _TEXT + rb")", re.MULTILINE
)


@lru_cache(maxsize=1)
def results_version() -> str:
    """Hash of the code that makes numbers and of the tables' rows: shards of another version are not used.

    Comments and docstrings count for nothing.
    """
    decided = {
        "code": code_digest(_PACKAGE),
        "observables": rows_without_prose(OBSERVABLES),
        "solvers": {name: asdict(row) | {"sentence": ""} for name, row in SOLVERS.items()},
        "laws": {name: (sorted(row.model_fields), row.implementation) for name, row in LAWS.items()},
    }
    return hashlib.sha256(json.dumps(decided, sort_keys=True, default=sorted).encode()).hexdigest()[:12]


def code_digest(package: Path) -> str:
    """SHA-256 of the modules of a package that make numbers, without their prose: all but those of rooms known not to.

    What scenes and campaigns describe is in the identity of each problem, number by number.
    """
    digest = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        module = file.relative_to(package).as_posix()
        if module.partition("/")[0] not in _MAKE_NO_NUMBERS:
            code = _PROSE.sub(rb"\g<kept>", file.read_bytes().replace(b"\r\n", b"\n"))
            digest.update(f"{module} {len(code)}\n".encode() + code)
    return digest.hexdigest()


def rows_without_prose(table: Mapping[str, Observable]) -> dict[str, tuple[str, str]]:
    """What a table of observables decides of the numbers."""
    return {name: (row.of, row.unit) for name, row in table.items()}

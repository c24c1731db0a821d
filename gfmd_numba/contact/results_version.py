"""The version of results: what a shard holds and which code made it, derived so that nobody has to remember it."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict
from functools import lru_cache

from gfmd_numba.contact.observables import OBSERVABLES, Observable
from gfmd_numba.interface.table import LAWS
from gfmd_numba.solvers.table import SOLVERS

NUMBERS = 15  # raised whenever a change of the code changes a number: older shards are then not reused


@lru_cache(maxsize=1)
def results_version() -> str:
    """Hash of `NUMBERS` and of the tables' rows without their prose: shards of another version are not used."""
    decided = {
        "numbers": NUMBERS,
        "observables": rows_without_prose(OBSERVABLES),
        "solvers": {name: asdict(row) | {"sentence": ""} for name, row in SOLVERS.items()},
        "laws": {name: (sorted(row.model_fields), row.implementation) for name, row in LAWS.items()},
    }
    return hashlib.sha256(json.dumps(decided, sort_keys=True, default=sorted).encode()).hexdigest()[:12]


def rows_without_prose(table: Mapping[str, Observable]) -> dict[str, tuple[str, str]]:
    """What a table of observables decides of the numbers."""
    return {name: (row.of, row.unit) for name, row in table.items()}

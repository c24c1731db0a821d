"""What is recorded where topographies of deformable bodies are followed, in addition to what all contacts have."""

from collections.abc import Mapping
from dataclasses import replace

from gfmd_numba.contact.observables import Observable

ROUGH_BODY_OBSERVABLES = {
    "next_order": Observable("contact", "height", "most that the next order in the slope would add to a displacement"),
}
OF_PUNCH, OF_SUM = "of the punch", "of the sum of the heights"


def recorded_of_rough_bodies(rows: Mapping[str, Observable]) -> dict[str, Observable]:
    """Rows of a contact as those of rough bodies: the surface is the sum of theirs, and an error is expected."""
    named = {name: replace(row, long_name=row.long_name.replace(OF_PUNCH, OF_SUM)) for name, row in rows.items()}
    return named | ROUGH_BODY_OBSERVABLES

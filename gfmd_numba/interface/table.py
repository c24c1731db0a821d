"""The table of interaction laws, in the order of the scene file: pure data.

What computes a law, what it acts on and what it needs stands with its record, where the rules between the laws of a
scene read it too.
"""

from typing import get_args

from gfmd_numba.scene.interface_records import Interface, Law, LawRecord

_FIELDS = {name: get_args(field.annotation)[0] for name, field in Interface.model_fields.items()}
LAWS: dict[str, type[Law]] = {name: record for name, record in _FIELDS.items() if issubclass(record, LawRecord)}

"""What several observables of a contact share is computed once."""

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

from gfmd_numba.contact.solution import Contact

Found = TypeVar("Found")


def once(function: Callable[[Contact], Found]) -> Callable[[Contact], Found]:
    """Compute a function of a contact once, and keep what it has found with the contact; nobody changes that."""

    @wraps(function)
    def found(contact: Contact) -> Found:
        if function not in contact.found:
            contact.found[function] = function(contact)
        known: Found = contact.found[function]
        return known

    return found

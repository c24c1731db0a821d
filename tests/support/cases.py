"""Cases of a test that are many of one kind: some are looked at each time, the others by the long tests."""

import pytest


def some_of(cases, *quick):
    """Cases, of which all but those at the given places are long."""
    return [
        case if i in quick else pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.long)
        for i, case in enumerate(cases)
    ]

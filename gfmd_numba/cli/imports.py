"""Imports of weight without the garbage collector, which takes a third of the time of a short command."""

from __future__ import annotations

import atexit
import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_collections() -> Iterator[None]:
    """Import without looking for garbage: what an import leaves lives until the end, and is not looked at again.

    Nor is anything else when the process ends, as its memory goes back all the same.
    """
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if collecting:
            gc.enable()
        atexit.unregister(gc.freeze)  # once is enough
        atexit.register(gc.freeze)

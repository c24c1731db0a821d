"""Heavy imports without the garbage collector, which takes a third of the time of a short command."""

from __future__ import annotations

import atexit
import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_collections() -> Iterator[None]:
    """Import without collecting garbage. What an import leaves lives until the end, and is never looked at again.

    Nothing is collected when the process ends either, because its memory is freed anyway.
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

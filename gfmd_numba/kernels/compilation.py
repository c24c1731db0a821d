"""How kernels are compiled, and what they have in common.

Kernels work in place on batches `[realisation, x]`, on the rows listed in `active`. Rows may be longer than the `n`
samples they hold (padding keeps each row aligned for the transforms).
"""

import hashlib
import pickle
from collections.abc import Callable
from typing import Any

import numba
from numba.core.compiler import CompileResult
from numba.core.runtime import rtsys  # type: ignore[attr-defined]
from numba.core.serialize import dumps

from gfmd_numba.storage import kernel_cache

# sums side by side, as of the nodes of a tile, are found at once: the same numbers, far compliances a third faster
numba.config.SLP_VECTORIZE = 1  # type: ignore[attr-defined]


def jit(function: Callable[..., Any]) -> Any:
    """Compile a kernel on its first call, or find it compiled; threads may run it side by side."""
    kernel = numba.njit(error_model="numpy", nogil=True)(function)
    if hasattr(kernel, "_cache"):  # a plain function without compiler has none
        kernel._cache = _OnDisk(f"{function.__module__}.{function.__qualname__}")
    return kernel


class _OnDisk:
    """Cache of the code of one kernel, for each signature, with the methods that numba calls.

    The cache of numba unpickles its files, which may run any code, without a check of who wrote them and whether they
    are complete.
    """

    def __init__(self, kernel: str) -> None:
        self._kernel = kernel
        self.cache_path = str(kernel_cache.folder())

    def load_overload(self, signature: Any, target: Any) -> Any:
        # what `refresh` does first: the rest prepares to compile, and takes longer than a contact
        rtsys.initialize(target)
        code = kernel_cache.load(self._name(signature, target.codegen()))
        return None if code is None else CompileResult._rebuild(target, *pickle.loads(code))

    def save_overload(self, signature: Any, compiled: Any) -> None:
        if compiled.library.has_dynamic_globals:  # addresses of this process
            return
        try:
            code = compiled._reduce()
        except RuntimeError as error:  # LLVM's callback swallows Ctrl-C, and leaves no code
            if "no compiled object" in str(error):
                raise KeyboardInterrupt from None
            raise
        kernel_cache.save(self._name(signature, compiled.codegen), dumps(code))

    def flush(self) -> None:
        """Forget nothing: a kernel compiled anew takes the place of the old one."""

    def _name(self, signature: Any, codegen: Any) -> str:
        """File name of the code for a signature and a processor."""
        key = hashlib.sha256(repr((signature, codegen.magic_tuple())).encode()).hexdigest()
        return f"{self._kernel}-{key[:16]}.kernel"

"""A disk that fails at one call: what Python asks of the system for files in a folder, counted and refused."""

import errno
import os
from contextlib import contextmanager

CALLS = ("open", "write", "fsync", "replace", "rename", "link", "unlink", "mkdir", "chmod", "ftruncate")


class FailingDisk:
    """Counts calls for a folder; refuses the one with the number `at`, and all writing after it if it is `full`."""

    def __init__(self, folder, at=-1, full=False):
        self.folder, self.at, self.full = os.path.realpath(folder), at, full
        self.n_calls = 0
        self.refused = ""

    def _concerns(self, name, given):
        path = os.readlink(f"/proc/self/fd/{given[0]}") if isinstance(given[0], int) else os.fspath(given[0])
        writes = name != "open" or given[1] & (os.O_WRONLY | os.O_RDWR)
        return os.path.abspath(path).startswith(self.folder) and writes

    def _call(self, name, real, *given, **options):
        if self._concerns(name, given):
            number, self.n_calls = self.n_calls, self.n_calls + 1
            grows = name in ("open", "write", "mkdir")
            if number == self.at or (self.full and self.refused and grows):
                self.refused = self.refused or f"{name} {given[0]}"
                code = errno.ENOSPC if self.full or grows else errno.EIO
                raise OSError(code, os.strerror(code), *([] if isinstance(given[0], int) else [os.fspath(given[0])]))
        return real(*given, **options)

    @contextmanager
    def mounted(self):
        """Have the calls of this process go through it."""
        real = {name: getattr(os, name) for name in CALLS}
        try:
            for name in CALLS:
                setattr(os, name, lambda *given, name=name, **options: self._call(name, real[name], *given, **options))
            yield self
        finally:
            for name in CALLS:
                setattr(os, name, real[name])

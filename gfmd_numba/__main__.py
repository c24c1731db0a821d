"""The `gfmd` command as a process, also as `python -m gfmd_numba`."""

import sys
from types import ModuleType

from gfmd_numba.cli import main


def command() -> None:
    """Run the command line of this process."""
    # xarray and SciPy ask of arrays whether they are dask's. None is, and its module takes as long to load as a contact
    # to solve: a class without instances answers as well.
    if "dask.array" not in sys.modules:
        stands_in = ModuleType("dask.array")
        stands_in.Array = type("Array", (), {})  # type: ignore[attr-defined]
        sys.modules["dask.array"] = stands_in
    main(prog_name="gfmd")


if __name__ == "__main__":
    command()

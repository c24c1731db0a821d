"""The `gfmd` command as a process, also as `python -m gfmd_numba`."""

import sys

from gfmd_numba.cli import main


def command() -> None:
    """Run the command line of this process."""
    # xarray asks of each array whether it is one of dask, whose module takes longer to load than a contact to solve.
    # None is, so that it need not be found.
    sys.modules.setdefault("dask.array", None)  # type: ignore[arg-type]
    main(prog_name="gfmd")


if __name__ == "__main__":
    command()

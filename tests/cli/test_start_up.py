"""What a command loads before it computes: time that nobody asked for."""

import pytest

from support.command_line import gfmd, python
from support.scenes import SCENE

OURS = "import gfmd_numba.fourier.transform as ours"
THEIRS = "import pyfftw, pyfftw.interfaces.numpy_fft, numpy as np"


@pytest.mark.long
def test_transforms_load_no_other_library_of_transforms():
    names = ("dask", "scipy.fftpack", "pyfftw.interfaces", "pyfftw.builders")
    assert python(f"import sys; {OURS}; print([name for name in {names} if name in sys.modules])") == "[]\n"


@pytest.mark.long
@pytest.mark.parametrize("imports", [f"{OURS}; {THEIRS}", f"{THEIRS}; {OURS}"], ids=["before", "after"])
def test_pyfftw_is_whole_for_who_imports_it(imports):
    script = f"""{imports}
assert pyfftw.pyfftw.FFTW is pyfftw.FFTW
assert isinstance(ours.Transform(1, 8)._inverse[0], pyfftw.FFTW)
assert np.allclose(pyfftw.interfaces.numpy_fft.rfft([1.0, 2.0, 3.0, 4.0]), np.fft.rfft([1.0, 2.0, 3.0, 4.0]))
assert pyfftw.builders.rfft(pyfftw.zeros_aligned(8))().size == 5
print("whole")"""
    assert python(script) == "whole\n"


@pytest.mark.long
def test_a_module_that_needs_its_package_is_loaded_with_it():
    script = f"""import sys, pyfftw
from importlib.machinery import PathFinder
find, _ = PathFinder.find_spec, sys.modules.pop("pyfftw.pyfftw")
PathFinder.find_spec = lambda name, *places: None if name == "pyfftw.pyfftw" else find(name, *places)
{OURS}
print(ours.pyfftw is pyfftw)"""
    assert python(script) == "True\n"


def test_help_loads_no_records_and_no_arrays():
    script = (
        "import sys; from gfmd_numba.cli import main\n"
        "try: main(['--help'])\n"
        "finally: print({'numpy', 'numba', 'dask', 'pydantic', 'yaml', 'xarray'} & sys.modules.keys())"
    )
    assert python(script).endswith("set()\n")


@pytest.mark.long
def test_solve_loads_no_cluster_no_pictures_and_no_statistics_and_at_its_end_looks_for_no_garbage(tmp_path):
    (tmp_path / "scene.yaml").write_text(SCENE)
    names = (
        "distributed",
        "matplotlib",
        "pyfftw.interfaces",
        "rich",
        "scipy.interpolate",
        "scipy.optimize",
        "scipy.stats",
    )
    script = (
        "import atexit, gc, sys; from gfmd_numba.cli import main\n"
        "atexit.register(lambda: print(len(gc.get_objects())))\n"
        "try: main(sys.argv[1:])\n"
        f"finally: print([name for name in {names} if name in sys.modules])"
    )
    *_, loaded, left = python(script, "solve", tmp_path / "scene.yaml", "-o", tmp_path / "out.nc").splitlines()
    assert loaded == "[]"
    assert int(left) < 1000  # frozen ones are not among them


@pytest.mark.long
def test_a_fit_loads_no_solvers_and_no_pictures(results):
    names = ("distributed", "numba", "pyfftw", "matplotlib", "scipy.stats")
    script = (
        "import sys; from gfmd_numba.cli import main\n"
        "try: main(sys.argv[1:])\n"
        f"finally: print([name for name in {names} if name in sys.modules])"
    )
    assert python(script, "fit", results).endswith("[]\n")


@pytest.mark.long
def test_a_process_that_solves_loads_no_arrays_of_dask_and_does_not_prepare_to_compile(tmp_path):
    (tmp_path / "scene.yaml").write_text(SCENE)
    gfmd("solve", tmp_path / "scene.yaml", "-o", tmp_path / "compiled.nc")  # so that kernels are on the disk
    script = (
        "import runpy, sys; sys.argv = ['gfmd', *sys.argv[1:]]\n"
        "try: runpy.run_module('gfmd_numba', run_name='__main__')\n"
        "finally: print('dask.array.core' in sys.modules, 'numba.np.linalg' in sys.modules)"
    )
    said = python(script, "solve", tmp_path / "scene.yaml", "-o", tmp_path / "out.nc")
    assert said.endswith("False False\n")


@pytest.mark.long
def test_a_worker_loads_no_datasets_and_no_statistics():
    names = ("xarray", "pandas", "netCDF4", "matplotlib", "scipy.optimize", "scipy.stats", "pint")
    script = "import sys, gfmd_numba.campaign.execution; print([name for name in {} if name in sys.modules])"
    assert python(script.format(names)) == "[]\n"

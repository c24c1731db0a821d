"""There is one convention of transforms: nothing outside the room `fourier` calls a transform of its own."""

import ast
from pathlib import Path

import pytest

import gfmd_numba

ROOT = Path(gfmd_numba.__file__).parent
OUTSIDE = sorted(path for path in ROOT.rglob("*.py") if path.parent != ROOT / "fourier")
LIBRARIES = ("numpy.fft", "scipy.fft", "scipy.fftpack", "pyfftw")


def mentioned(text):
    """Full names of the modules a source imports, and of what it takes from numpy and scipy as attributes."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            yield f"{ {'np': 'numpy'}.get(node.value.id, node.value.id) }.{node.attr}"


def transforms(text):
    if "fft" not in text:  # which is in all their names; to parse takes longer
        return set()
    return {name for name in mentioned(text) if name.startswith(LIBRARIES)}


def test_no_module_outside_fourier_transforms_on_its_own():
    assert len(OUTSIDE) > 100
    found = {str(path.relative_to(ROOT)): transforms(path.read_text()) for path in OUTSIDE}
    assert {name: own for name, own in found.items() if own} == {}


def test_only_planned_transforms_import_fftw():
    found = {
        path.name
        for path in ROOT.glob("fourier/*.py")
        if any("pyfftw" in name for name in transforms(path.read_text()))
    }
    assert found == {"transform.py", "distributed.py"}


@pytest.mark.parametrize(
    "text",
    ["np.fft.rfft(h)", "from numpy.fft import rfft", "import scipy.fft as f", "from scipy import fft", "import pyfftw"],
)
def test_every_way_to_a_transform_is_noticed(text):
    assert transforms(text)

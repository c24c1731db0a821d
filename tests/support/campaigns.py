"""Files of small campaigns, and what of their results is independent of the run."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import xarray as xr

SMALL = """
name: small
seed: 1
realisations: 6
scene:
  body: {youngs_modulus: 70e9, poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
reference: {eps_c: 1/4, eps_f: 1/16, eps_t: 1/2}
limits: {eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/16, 1/32]}
grid: {hurst: [0.3, 0.8]}
"""
MAPS = """\
name: maps
seed: 1
realisations: 2
scene:
  dimension: 2
  body: {poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
"""  # the discretisations are for the test to add


def campaign(folder: Path, text: str = SMALL, **replacements: str) -> Path:
    for old, new in replacements.items():
        assert old in text
        text = text.replace(old, new)
    path = folder / "campaign.yaml"
    path.write_text(text)
    return path


class Killed(BaseException):
    """The end of a run that nothing in it catches."""


@contextmanager
def killed_in(module: object, name: str, calls: int) -> Iterator[None]:
    """Kill what happens inside when a function of a module is called once more than so many times."""
    work, left = getattr(module, name), iter(range(calls))

    def dying(*given: object, **options: object) -> object:
        if next(left, None) is None:
            raise Killed
        return work(*given, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, name, dying)
        with pytest.raises(Killed):
            yield


def numbers(dataset: xr.Dataset) -> xr.Dataset:
    return dataset.drop_vars(["wall_time", "case_seconds"]).drop_attrs()


TINY = """
name: tiny
seed: 1
realisations: 2
scene:
  body: {poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
reference: {eps_c: 1/2, eps_f: 1/4, eps_t: 1}
"""

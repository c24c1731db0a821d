"""A fit learns what is physics from the attributes of the coordinates, and pools no different physics."""

import numpy as np
import pytest

from gfmd_numba.analysis import UnusableDataError, fit_tfc, plot_campaign
from gfmd_numba.analysis.selection import axes
from gfmd_numba.cli.tables import of_fit
from gfmd_numba.cli.terminal import tell
from support.synthetic_campaigns import ALPHA, campaign, noisy, with_axes

TOY = {"long_name": "toy parameter", "units": "m", "symbol": "tau", "label": r"$\tau$", "axis": "physics"}


@pytest.fixture
def toy():
    """Two values of a parameter that analysis has never heard of, in place of a Hurst exponent."""
    dataset = noisy(campaign(hursts=(0.3, 0.8)), np.random.default_rng(0), spread=0.02)
    return dataset.drop_vars("hurst").assign_coords(toy=("case", np.repeat([2e-6, 5e-6], 10), TOY))


def test_a_parameter_unknown_to_analysis_forms_groups_and_keeps_its_attributes(toy):
    fitted = fit_tfc(toy, fixed=ALPHA)
    assert fitted["toy"].values.tolist() == [2e-6, 5e-6]
    assert fitted["toy"].attrs == TOY
    assert set(axes(fitted)) == set(axes(toy))


@pytest.mark.long
def test_a_parameter_unknown_to_analysis_is_drawn_and_printed_by_its_symbols(toy, capsys):
    fitted = fit_tfc(toy, fixed=ALPHA)
    figure = plot_campaign(toy, fitted)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:2] == [r"$\tau = 2\,\mathrm{µm}$", r"$\tau = 5\,\mathrm{µm}$"]
    assert figure.axes[-1].get_xlabel() == r"$\tau$ (m)"
    tell(of_fit(fitted))
    assert "tau (m)" in capsys.readouterr().out


def test_a_dataset_that_does_not_say_what_is_physics_is_refused():
    bare = campaign()
    for coordinate in bare.coords.values():
        coordinate.attrs = {}
    with pytest.raises(UnusableDataError, match="do not say, by the attribute `axis`, which of them are physics"):
        fit_tfc(bare)


def test_different_physics_is_never_pooled(toy):
    toy["toy"].attrs = {}
    with pytest.raises(UnusableDataError, match="which no coordinate with the attribute `axis` tells apart"):
        fit_tfc(toy, fixed=ALPHA)


def test_colours_go_by_the_hurst_exponent_where_there_is_one():
    dataset = campaign(hursts=(0.3, 0.8))
    slabs = with_axes(dataset.assign_coords(aspect_ratio=("case", np.tile([1.0, np.inf], 10))))
    figure = plot_campaign(slabs)
    colours = [handle.get_color() for handle in figure.legends[0].legend_handles[:4]]
    labels = [text.get_text() for text in figure.legends[0].get_texts()[:4]]
    assert [label.split(",")[0] for label in labels] == ["$H = 0.3", "$H = 0.3", "$H = 0.8", "$H = 0.8"]
    assert colours[0] == colours[1] != colours[2] == colours[3]

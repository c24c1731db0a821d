"""Pictures of campaigns and contacts: what is drawn, where, and how it is named."""

import re

import matplotlib.pyplot as plt
import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_hex

from gfmd_numba.analysis import fit_tfc, plot_campaign, plot_contact
from gfmd_numba.text.input_error import InputError
from support.legible import faults
from support.synthetic_campaigns import with_axes

pytestmark = pytest.mark.usefixtures("laws_that_hold")

REFERENCE = {"eps_c": 1 / 2, "eps_f": 1 / 1024, "eps_t": 1 / 2}
LEVELS = {"eps_c": [1, 1 / 4, 1 / 8], "eps_f": [1 / 256, 1 / 512, 1 / 2048], "eps_t": [1, 1 / 4, 1 / 8]}
FIXED = dict.fromkeys(LEVELS, 1.0)


@pytest.fixture
def campaign(original):
    return original.copy(deep=True)


@pytest.fixture(scope="module")
def fitted(original, laws_that_hold):
    return fit_tfc(original, fixed=FIXED)


@pytest.fixture(scope="module")
def original():
    rng = np.random.default_rng(0)
    rows = []
    for hurst in (0.3, 0.8):
        rows.append((hurst, "reference", REFERENCE))
        rows += [(hurst, name, REFERENCE | {name: e}) for name, values in LEVELS.items() for e in values]
    n = len(rows)
    coords = {name: ("case", np.array([eps[name] for _, _, eps in rows])) for name in LEVELS}
    coords |= {
        "hurst": ("case", [hurst for hurst, _, _ in rows]),
        "limit": ("case", [limit for _, limit, _ in rows]),
        "is_reference": ("case", [limit == "reference" for _, limit, _ in rows]),
        "case_id": ("case", [f"case-{index}" for index in range(n)]),
        "poissons_ratio": ("case", np.full(n, 0.33)),
        "aspect_ratio": ("case", np.full(n, np.inf)),
        "reduced_pressure": ("case", np.full(n, 0.007)),
        "rms_gradient_target": ("case", np.full(n, 0.01)),
    }
    means = np.array([4 - 2 * h + 0.4 * e["eps_c"] + 90 * e["eps_f"] + 0.3 * e["eps_t"] for h, _, e in rows])
    kappa = means[:, None] + 0.1 * rng.standard_normal((1, 8)) + 0.02 * rng.standard_normal((n, 8))
    dims = ("case", "realisation")
    dataset = xr.Dataset(
        {
            "kappa": (dims, kappa),
            "kappa_counted": (dims, 1.1 * kappa),
            "mean_pressure": (dims, kappa * 1e6, {"long_name": "mean pressure", "units": "Pa"}),
            "status": (dims, np.zeros((n, 8), np.int8)),
        },
        coords,
    )
    return with_axes(dataset)


@pytest.fixture
def contact():
    x = np.arange(512) / 512 * 1e-4
    height = 1e-6 * (1 - np.cos(2 * np.pi * x / 1e-4))
    displacement = np.where(height < 0.2e-6, height, 0.2e-6)
    pressure = 1e8 * np.sqrt(np.clip(1 - height / 0.2e-6, 0, None))
    metres, pascals = {"units": "m"}, {"units": "Pa"}
    return xr.Dataset(
        {
            "height": ("x", -height, metres),
            "displacement": ("x", displacement, metres),
            "gap": ("x", height - displacement, metres),
            "pressure": ("x", pressure, pascals),
        },
        {"x": ("x", x, metres)},
    )


def colours(axis):
    return {to_hex(line.get_color()) for line in axis.lines}


def drawn_points(axis):
    return np.concatenate(
        [np.column_stack(container.lines[0].get_data()).astype(float) for container in axis.containers]
    )


def test_one_panel_per_limit_and_points_are_the_means(campaign):
    figure = plot_campaign(campaign)
    assert [axis.get_title() for axis in figure.axes] == [
        "Continuum limit",
        "Fractal limit",
        "Thermodynamic limit",
    ]
    thermodynamic = drawn_points(figure.axes[2])
    expected = campaign["kappa"].mean("realisation").values[np.isin(campaign["limit"], ["eps_t", "reference"])]
    np.testing.assert_allclose(np.sort(thermodynamic[:, 1]), np.sort(expected), rtol=1e-12)
    # points stand next to their tick, never so far that the level is in doubt
    assert abs(np.log2(thermodynamic[:, 0]) % 1 - 0.5).min() > 0.3


def test_error_bars_are_standard_errors(campaign):
    container = plot_campaign(campaign).axes[1].containers[0]
    (segments,) = (collection.get_segments() for collection in container.lines[2])
    half = np.array([np.ptp(segment[:, 1]) / 2 for segment in segments])
    group = campaign.isel(case=(campaign["hurst"] == 0.3).values & (campaign["limit"] == "eps_f").values)
    expected = group["kappa"].std("realisation", ddof=1) / np.sqrt(8)
    assert np.isclose(half[:, None], expected.values, rtol=1e-9).any(axis=0).all()


@pytest.mark.long
def test_fit_adds_curves_and_the_extrapolated_panel(campaign, fitted):
    fit, figure = fitted, plot_campaign(campaign, fitted)
    assert figure.axes[-1].get_title() == "TFC limit"
    np.testing.assert_allclose(drawn_points(figure.axes[-1])[:, 1], fit["kappa_tfc"])
    curves = [line for line in figure.axes[0].lines if len(line.get_xdata()) > 40]
    assert len(curves) == 2
    together = fit["correction"].sum("limit") + fit["interaction"].sum("pair")
    for curve, tfc, apart in zip(curves, fit["kappa_tfc"], together, strict=True):
        x, y = curve.get_data()
        at_reference = np.interp(2.0, x, y)
        np.testing.assert_allclose(at_reference, tfc + apart, rtol=1e-4)
        assert x.min() > 1  # roughness at Nyquist is not part of the fit


@pytest.mark.long
def test_a_prescribed_displacement_has_no_pressure_but_a_picture(campaign):
    campaign["reduced_pressure"][:] = np.nan
    figure = plot_campaign(campaign, fit_tfc(campaign, fixed=FIXED))
    assert figure.axes[-1].get_title() == "TFC limit"
    assert [text.get_text() for text in figure.legends[0].get_texts()][:2] == ["$H = 0.3$", "$H = 0.8$"]


def test_a_reference_at_nyquist_is_drawn_with_its_curves(campaign):
    campaign = campaign.isel(case=campaign["limit"].values != "eps_c")
    campaign["eps_c"][:] = 1.0
    figure = plot_campaign(campaign, fit_tfc(campaign, fixed=FIXED))
    assert [axis.get_title() for axis in figure.axes] == ["Fractal limit", "Thermodynamic limit", "TFC limit"]
    assert "not fitted" not in [text.get_text() for text in figure.legends[0].get_texts()]


def test_a_refused_fit_draws_points_only(campaign, fitted):
    fit = fitted.copy(deep=True)
    fit["fit_status"][:] = "refused"
    figure = plot_campaign(campaign, fit)
    assert len(figure.axes) == 3
    assert max(len(line.get_xdata()) for axis in figure.axes for line in axis.lines) < 10


def test_colour_means_hurst_and_other_parameters_are_named(campaign):
    second = campaign.assign_coords(
        aspect_ratio=("case", np.full(campaign.sizes["case"], 0.1)),
        case_id=("case", np.char.add(campaign["case_id"].values, "-slab")),
    )
    both = xr.concat([campaign, second], "case")
    figure = plot_campaign(both)
    assert len(colours(figure.axes[1])) == 2
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert r"$H = 0.3, a = \infty$" in texts
    assert "$H = 0.8, a = 0.1$" in texts
    assert len(texts) == 5  # four groups and the counted nodes


def test_failed_results_and_absent_cases_do_not_enter(campaign):
    campaign["kappa"][0, 0] = 1e6
    campaign["status"][0, 0] = 4
    campaign["kappa"][1] = np.nan
    assert np.nanmax(drawn_points(plot_campaign(campaign).axes[0])[:, 1]) < 10


def test_single_realisation_has_points_without_bars(campaign):
    figure = plot_campaign(campaign.isel(realisation=slice(0, 1)))
    assert np.isfinite(drawn_points(figure.axes[0])).all()


def test_other_variables_carry_their_name_and_unit(campaign, fitted):
    figure = plot_campaign(campaign, variable="mean_pressure")
    assert figure.axes[0].get_ylabel() == "mean pressure (Pa)"
    with pytest.raises(ValueError, match="fit: you gave one of 'kappa'"):
        plot_campaign(campaign, fitted, "mean_pressure")
    with pytest.raises(ValueError, match="no variable 'kapa'"):
        plot_campaign(campaign, variable="kapa")


def test_legend_covers_no_panel(campaign, fitted):
    figure = plot_campaign(campaign, fitted)
    figure.draw_without_rendering()
    legend = figure.legends[0].get_window_extent()
    assert not any(legend.overlaps(axis.get_window_extent()) for axis in figure.axes)
    assert legend.x0 > 0
    assert legend.x1 < figure.bbox.x1


def test_nothing_varied_is_an_error(campaign):
    with pytest.raises(ValueError, match="no discretisation is varied"):
        plot_campaign(campaign.isel(case=[0]))


def test_contact_shows_punch_body_and_pressure_in_scaled_units(contact):
    figure = plot_contact(contact)
    whole, above, below = figure.axes
    assert whole.get_ylabel() == "Position (nm)"
    assert above.get_ylabel() == "Close-up (nm)"
    assert whole.get_ylim()[1] >= above.lines[0].get_ydata().max()  # the whole punch
    assert below.get_ylabel() == "Pressure $p$ (MPa)"
    assert below.get_xlabel() == "Position $x$ (µm)"
    punch, body = (line.get_ydata() for line in above.lines[:2])
    np.testing.assert_allclose(punch - body, 1e9 * contact["gap"])
    assert above.get_ylim()[1] < punch.max()  # the view follows the body, not the valleys of the punch
    assert above.get_ylim()[0] < body.min()
    np.testing.assert_allclose(below.lines[0].get_ydata().max(), contact["pressure"].max() / 1e6)


def test_contact_without_units_is_in_lx_and_estar(contact):
    for name in contact.variables:
        contact[name].attrs["units"] = "1"
    whole, _, below = plot_contact(contact).axes
    assert whole.get_ylabel() == r"Position ($10^{-7}\,L_x$)"
    assert "E^*" in below.get_ylabel()


@pytest.mark.long
def test_full_contact_and_no_load_are_drawn(contact):
    contact["gap"][:] = 0
    plot_contact(contact)
    contact["displacement"][:] = 0
    contact["pressure"][:] = 0
    plot_contact(contact).draw_without_rendering()


def test_no_pyplot_state_is_left(contact):
    plot_contact(contact)
    assert plt.get_fignums() == []


@pytest.mark.long
def test_the_legend_stays_inside_the_figure():
    rows = []
    for hurst in (0.3, 0.8):
        for aspect_ratio in (0.05, 0.1, np.inf):
            reference = {"eps_c": 0.25, "eps_f": 0.01, "eps_t": 0.5}
            cases = [("reference", {})] + [(limit, {limit: reference[limit] / 2}) for limit in reference]
            rows += [{"hurst": hurst, "aspect_ratio": aspect_ratio, "limit": n, **reference, **c} for n, c in cases]
    columns = {name: ("case", [row[name] for row in rows]) for name in rows[0]}
    n = len(rows)
    dataset = xr.Dataset(
        {
            "kappa": (("case", "realisation"), np.ones((n, 2))),
            "kappa_counted": (("case", "realisation"), np.ones((n, 2))),
        },
        columns
        | {
            "case_id": ("case", [str(i) for i in range(n)]),
            "is_reference": ("case", [row["limit"] == "reference" for row in rows]),
            "poissons_ratio": ("case", np.full(n, 0.3)),
            "reduced_pressure": ("case", np.full(n, 0.01)),
            "rms_gradient_target": ("case", np.full(n, 0.01)),
        },
    )
    figure = plot_campaign(with_axes(dataset))
    figure.draw_without_rendering()
    box = figure.legends[0].get_window_extent()
    assert box.x0 >= 0
    assert box.x1 <= figure.bbox.width


@pytest.mark.long
def test_many_groups_leave_the_panels_their_height(campaign, tmp_path):
    """A legend of dozens of lines above panels of no height would be a warning, and no picture."""
    of_one = campaign.isel(case=np.isin(campaign["limit"], ["reference", "eps_c"]))
    n = of_one.sizes["case"]
    copies = [
        of_one.assign_coords(
            reduced_pressure=("case", np.full(n, load)), case_id=("case", [f"{load}-{case}" for case in range(n)])
        )
        for load in np.geomspace(0.001, 1.0, 12)
    ]
    figure = plot_campaign(with_axes(xr.concat(copies, "case")))
    figure.savefig(tmp_path / "many.png", dpi=50)
    assert figure.axes[0].get_position().height * figure.get_figheight() > 2.5


@pytest.mark.long
@pytest.mark.parametrize("finest", [14, 20])
def test_the_levels_of_a_limit_can_be_read(campaign, finest):
    limited = (campaign["limit"] == "eps_f").values
    levels = np.where(limited, 0.0, 1 / campaign["eps_f"])
    levels[limited] = np.tile(2.0 ** np.array([6, finest - 2, finest]), 2)
    figure = plot_campaign(campaign.assign_coords(eps_f=("case", 1 / levels, campaign["eps_f"].attrs)))
    assert faults(figure) == []
    assert figure.axes[1].get_xticklabels()[-1].get_text() == str(2**finest)


@pytest.mark.parametrize(
    ("attributes", "fault"),
    [
        ({"label": r"$\frac{1}$"}, r"in which height has a label or a unit that is no formula, '$\\frac{1}$'"),
        ({"label": "fine", "units": "$a^$"}, r"that is no formula, '$a^$'"),
        ({"label": "5 $^ only"}, ""),
    ],
)
def test_labels_and_units_are_formulae_that_can_be_drawn(contact, attributes, fault):
    contact["height"].attrs |= attributes
    if not fault:
        plt.close(plot_contact(contact))
        return
    with pytest.raises(InputError, match=re.escape(fault)):
        plot_contact(contact)

"""Pictures in the width of a journal's column: their text can be read and stays text; what is marked in pictures."""

import functools
import re
from itertools import combinations

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Text

import gfmd_numba
from gfmd_numba.analysis import plot_campaign, plot_conductance, plot_contact, plot_curve, plot_statistics
from gfmd_numba.analysis.plots.kinds import KINDS
from gfmd_numba.analysis.plots.path import _mark_jumps, plot_path
from gfmd_numba.analysis.plots.rounds import plot_rounds
from gfmd_numba.cli.tables import column
from gfmd_numba.storage.atomic_file import write_picture
from support import synthetic_campaigns
from support.legible import faults
from support.solved_maps import made, paraboloid, pressed
from support.synthetic_campaigns import with_axes

pytestmark = pytest.mark.usefixtures("laws_that_hold")

BODY = {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "aspect_ratio": 0.5}
SCENE = {
    "length": 1e-4,
    "body": BODY,
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
    "interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}},
    "loading": {"reduced_pressure": 0.05},
}
GRID = {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}
SLIDING = [{"sliding": 5e-9 * step} for step in (1, 2, 1, 0)]
CREEPING = {
    "scene": SCENE | {"interface": {"hard_wall": {}}, "body": BODY | {"relaxation": [{"modulus": 2e9, "time": 1.0}]}},
    "discretisation": GRID,
}


@functools.cache
def contact():
    return gfmd_numba.solve({"scene": SCENE, "discretisation": GRID, "path": SLIDING})


@functools.cache
def map_():
    return gfmd_numba.solve({"scene": SCENE | {"dimension": 2}, "discretisation": GRID, "path": SLIDING[:1]})


@functools.cache
def campaign():
    made_up = synthetic_campaigns.campaign((0.3, 0.8), realisations=20)
    return synthetic_campaigns.noisy(made_up, np.random.default_rng(1))


@functools.cache
def fit():
    return gfmd_numba.fit_tfc(campaign(), fixed=synthetic_campaigns.ALPHA)


def rounds():
    seconds, error = np.geomspace(2.0, 500.0, 4), np.array([0.05, 0.03, 0.018, 0.009])
    columns = {"round_cpu_seconds": seconds, "round_error": error, "round_predicted_error": 1.2 * error}
    columns["round_error_factor"] = np.full(4, 1.5)
    return xr.Dataset({name: ("round", each) for name, each in columns.items()}, {"round": range(4)}).assign_attrs(
        target='{"kappa": 0.01}'
    )


def studies():
    curves = [(name, curve) for name in ("solver residual", "eps_c", "eps_f", "surfaces") for curve in ("one", "other")]
    rows = [(*curve, 0.5**i, 0.1 * 0.5**i, 2.0**i) for curve in curves for i in range(4)]
    columns = zip(("study", "curve", "setting", "error", "seconds"), zip(*rows, strict=True), strict=True)
    return xr.Dataset({name: ("point", list(each)) for name, each in columns} | {"failed": ("point", [0] * len(rows))})


def surface(dimension):
    drawn = {"method": "psd", "hurst": 0.8, "rms_height": 3e-7, "points": 48, "cut_on": "6 um", "roll_off": "50 um"}
    return gfmd_numba.make_surface({"surface": drawn, "length": 1e-4, "dimension": dimension})


def loaded(dimension):
    boundary = {"normal_traction": 1e6, "tangential_traction": 2e5}
    return gfmd_numba.solve(
        {"scene": {"dimension": dimension, "length": 1e-4, "body": BODY, "boundary": boundary}, "points": 16}
    )


def flowed():
    body = {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "plasticity": {"yield_stress": 5e6, "sublayers": 8}}
    scene = SCENE | {"interface": {"hard_wall": {}}, "body": body}
    return gfmd_numba.solve({"scene": scene, "discretisation": GRID})


def draws(kind, made):
    return lambda width: KINDS[kind][1](made(), width=width)


def step(dataset):
    return dataset.isel(step=-1)


DRAWN = {
    "contact of a profile": draws("contact", contact),
    "contact of a map": draws("contact", map_),
    "loading path": lambda width: plot_path(contact(), width=width),
    "creep curve": draws("creep curve", lambda: gfmd_numba.load_curve(CREEPING, times=[0.1, 1.0])),
    "campaign": lambda width: plot_campaign(campaign(), fit(), width=width),
    "fit": draws("fit", fit),
    "rounds": lambda width: plot_rounds(rounds(), width=width),
    "accuracy": draws("accuracy", studies),
    "section of a body": draws("fields inside a body", lambda: gfmd_numba.body_fields(step(contact()))),
    "planes of a body": draws(
        "fields inside a body", lambda: gfmd_numba.body_fields(step(map_()), planes=[-1e-6, -5e-6])
    ),
    "statistics of a contact": draws("statistics of a contact", lambda: gfmd_numba.contact_statistics(contact())),
    "profile": draws("surface", lambda: surface(1)),
    "map": draws("surface", lambda: surface(2)),
    "loaded profile": draws("loaded body", lambda: loaded(1)),
    "loaded map": draws("loaded body", lambda: loaded(2)),
    "body that flows": draws("body that flows", flowed),
    "leakage": draws("leakage", lambda: gfmd_numba.leakage(step(map_()))),
    "conductance of a map": draws("conductance", lambda: gfmd_numba.contact_conductance(step(map_()))),
}


def texts(figure):
    return [each for each in figure.findobj(Text) if each.get_visible() and each.get_text().strip()]


def crowded(figure):
    """Return pairs of entries of a legend, of titles and of labels that overlap."""
    labels = [each for axes in figure.axes for each in (axes.title, axes.xaxis.label, axes.yaxis.label)]
    groups = [labels, *(legend.get_texts() for legend in figure.findobj(Legend))]
    found = []
    for group in groups:
        boxes = [(each.get_text(), each.get_window_extent()) for each in group if each.get_text()]
        found += [f"{one} and {other}" for (one, a), (other, b) in combinations(boxes, 2) if a.padded(-1.0).overlaps(b)]
    return found


WIDE = ("contact of a map", "planes of a body", "loading path")  # which arrange their panels otherwise


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "width"), [*((kind, "single") for kind in DRAWN), *((kind, "double") for kind in WIDE)]
)
def test_a_picture_of_a_column_can_be_read(kind, width, recwarn):
    figure = DRAWN[kind](width)
    assert figure.get_figwidth() == pytest.approx({"single": 3.4, "double": 7.0}[width])
    assert faults(figure) == []
    assert crowded(figure) == []
    assert min(each.get_fontsize() for each in texts(figure)) >= 7.0
    assert [each for each in recwarn if "layout" in str(each.message)] == []


@pytest.mark.long
def test_the_names_of_rounds_stand_inside_the_axes():
    figure = plot_rounds(rounds(), "single")
    figure.draw_without_rendering()
    (axis,) = figure.axes
    named = [each for each in axis.texts if each.get_text()]
    assert [each.get_text() for each in named] == ["pilot", "1", "2", "3"]
    assert min(each.get_window_extent().x0 for each in named) > axis.get_window_extent().x0


@pytest.mark.parametrize("kind", [pytest.param("pdf", marks=pytest.mark.long), "svg"])
def test_text_stays_text_in_vector_graphics(kind, tmp_path):
    write_picture(tmp_path / f"rounds.{kind}", DRAWN["rounds"]("single"))
    written = (tmp_path / f"rounds.{kind}").read_bytes()
    if kind == "pdf":
        assert b"/FontFile2" in written
        assert b"/Subtype /Type3" not in written
    else:
        said = re.sub(r"<[^>]*>", "", written.decode())
        assert "Processor time of the contacts" in said
        assert b"<text" in written


@pytest.mark.long
def test_an_outlier_makes_no_map_grey_and_stretches_no_axis():
    spoilt = step(map_()).copy(deep=True)
    spread = float(spoilt["height"].std())
    spoilt["height"][3, 5] -= 55.0 * spread
    spoilt["gap"][3, 5] += 55.0 * spread
    heights = plot_contact(spoilt).axes[0].images[0]
    assert np.ptp(np.quantile(np.asarray(heights.norm(heights.get_array())), [0.05, 0.95])) > 0.4
    assert heights.colorbar.extend == "min"
    gap = plot_statistics(gfmd_numba.contact_statistics(spoilt)).axes[1]
    assert gap.get_xlim()[1] < 8.0


@pytest.mark.long
def test_a_mean_with_an_error_beyond_all_others_stretches_no_axis():
    spoilt = campaign().copy(deep=True)
    spoilt["kappa"][0, :2] += [55.0, -55.0]
    usual = plot_campaign(campaign()).axes[0].get_ylim()
    assert np.ptp(plot_campaign(spoilt).axes[0].get_ylim()) < 3.0 * np.ptp(usual)


@pytest.mark.long
def test_what_a_fit_tends_to_along_a_limit_is_drawn_in_its_panel():
    panel = plot_campaign(campaign(), fit()).axes[0]
    found = fit().isel(group=0)
    corrections = found["correction"].sel(limit=["eps_f", "eps_t"]).sum()
    others = corrections + found["interaction"].sel(pair="eps_f eps_t").fillna(0.0)
    drawn = [line.get_ydata()[0] for line in panel.lines if line.get_linestyle() == ":"]
    assert min(abs(np.array(drawn) - float(found["kappa_tfc"] + others))) < 1e-9


def test_loads_are_told_apart_by_colour():
    one = campaign().isel(case=campaign()["hurst"].values == 0.3)
    loads = [one.assign_coords(reduced_pressure=("case", [load] * one.sizes["case"])) for load in (0.1, 0.2)]
    handles = plot_campaign(with_axes(xr.concat(loads, "case"))).legends[0].legend_handles
    assert len({handle.get_color() for handle in handles[:2]}) == 2


def test_a_loop_has_arrows_and_a_jump_is_named():
    x = np.r_[np.linspace(0.0, 1.0, 11), np.linspace(0.9, -0.5, 15)] * 1e-8
    y = np.where(x < -2e-9, 0.0, 1e6 * (1.0 + 1e8 * x))
    path = xr.Dataset(
        {
            "mean_pressure": ("step", y, {"units": "Pa"}),
            "contact_area_fraction": ("step", y / 1e7),
            "status": ("step", np.zeros(len(x), int)),
        },
        {"punch_displacement": ("step", x, {"units": "m"})},
    )
    (axis,) = plot_path(path).axes
    assert axis.get_xlabel() == "Punch displacement (nm)"  # 0 to within rounding has no say in the prefix
    assert sum(each.arrow_patch is not None for each in axis.texts) == 5
    assert [each.get_text() for each in axis.texts if each.get_text()] == ["jump"]


@pytest.mark.filterwarnings("ignore:.*the grid has too few nodes")
def test_a_table_and_a_picture_of_a_curve_have_the_same_units():
    curve = gfmd_numba.load_curve(
        {"scene": SCENE | {"interface": {"hard_wall": {}}}, "discretisation": GRID}, [1e-3, 1.0]
    )
    picture = plot_curve(curve)
    drawn = [axes.get_ylabel() for axes in picture.axes[1:]] + [picture.axes[2].get_xlabel()]
    for name, label in zip(("mean_gap", "contact_stiffness", "peak_pressure", "mean_pressure"), drawn, strict=True):
        assert column(curve, name)[0].rpartition(" (")[2] == label.rpartition(" (")[2]


@pytest.mark.long
def test_the_hottest_spot_of_a_large_map_is_enlarged():
    small, large = paraboloid(24), pressed(paraboloid(96), 4.0 / 3.0 * (9 / 96) ** 3 / 100.0)
    (inset,) = plot_contact(large).axes[1].child_axes
    x, y = inset.get_xlim(), inset.get_ylim()
    row, column = np.unravel_index(int(np.argmax(large["pressure"].values)), large["pressure"].shape)
    assert x[0] < (column + 0.5) / 96 < x[1]
    assert y[0] < (row + 0.5) / 96 < y[1]
    assert plot_conductance(gfmd_numba.contact_conductance(large)).axes[0].child_axes
    assert not plot_contact(pressed(small, 4.0 / 3.0 * (3 / 24) ** 3 / 100.0)).axes[1].child_axes


def test_no_contact_is_hidden_by_what_is_enlarged():
    """Contacts in three corners leave the fourth; in all four nothing is enlarged."""
    touching = np.zeros((64, 64), dtype=bool)
    touching[[5, 5, 58], [5, 58, 5]] = True
    (inset,) = plot_conductance(gfmd_numba.contact_conductance(made(touching))).axes[0].child_axes
    assert inset.get_position().x0 > 0.5
    touching[58, 58] = True
    assert not plot_conductance(gfmd_numba.contact_conductance(made(touching))).axes[0].child_axes


@pytest.mark.long
def test_a_worn_path_is_drawn_over_its_sliding(tmp_path):
    scene = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": {"hard_wall": {}, "wear": {"rate": 1e-4}},
        "loading": {"reduced_pressure": 0.1},
    }
    file = {"scene": scene, "path": [{"sliding": 1.0}, {"sliding": 3.0}]}
    eps = {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}
    whole = {"name": "worn", "seed": 1, "realisations": 2, "reference": eps}
    for found in (gfmd_numba.solve(file | {"discretisation": eps}), gfmd_numba.run(file | whole, tmp_path / "out")):
        depth, area = plot_path(found).axes
        assert depth.get_ylabel().startswith("Mean worn depth")
        assert area.get_ylabel() == "Contact area fraction"


def test_only_steps_that_lose_energy_between_two_others_jump():
    x, y = np.arange(5.0), np.array([0.0, 0.1, 5.0, 5.1, 5.2])
    for lost, names in ((None, ["jump"]), (np.array([0.0, 0.0, 1.0, 0.0, 0.0]), ["jump"]), (np.zeros(5), [])):
        figure = Figure()
        _mark_jumps(figure.subplots(), x, y, lost)
        assert [each.get_text() for each in figure.axes[0].texts] == names
    figure = Figure()
    _mark_jumps(figure.subplots(), x[:2], y[1:3], None)  # a step alone has none beside it
    assert not figure.axes[0].texts


def test_two_bodies_that_creep_are_no_rigid_punch():
    """At order 0 the dataset has the sum of their heights, and how far both give way together."""
    rubber = {"youngs_modulus": 3e6, "poissons_ratio": 0.5, "relaxation": [{"modulus": 9e6, "time": 1.0}]}
    rough = {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}}
    scene = {"length": 1e-3, "body": rubber, "counter_body": rubber | rough, "interface": {"hard_wall": {}}}
    contact = gfmd_numba.solve(
        {
            "scene": scene | {"loading": {"pressure": 1e4}},
            "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1},
        }
    )
    (legend,) = plot_contact(contact).findobj(Legend)
    named = [text.get_text() for text in legend.get_texts()]
    assert named[:2] == ["heights of both surfaces", "displacement of both"]

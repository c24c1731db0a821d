"""What all figures share: their sheet, colours, fonts, and values in the SI prefix that suits them."""

import re
import textwrap
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, wraps
from itertools import pairwise
from typing import Annotated, Any, Literal, TypeVar

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis, XAxis
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Text
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from gfmd_numba.analysis.arguments import Given, Kind, checked
from gfmd_numba.analysis.forms import UnusableDataError
from gfmd_numba.arrays import Reals
from gfmd_numba.text.input_error import brief
from gfmd_numba.text.numbers import si_prefix

# Okabe and Ito: told apart with any colour vision. In grey the first two are alike: lines of both need a dash or marker
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
_FENCE = 3.5  # of the distance of the quartiles: three of them beyond either quartile
_KAPPA = r"$\kappa = a_r\,E^*\bar{g}\,/\,\bar{p}$"
_SYMBOLS = {"kappa": r"$\kappa$", "kappa_counted": r"$\kappa$ of counted nodes", "kappa_r": r"$\kappa_r$"}

T = TypeVar("T")
Width = Annotated[Literal["single", "double"], Kind(Literal["single", "double"], "'single' or 'double'")]
_INCHES = {"single": 3.4, "double": 7.0}  # columns of journals
_POINTS, _POINTS_OF_COLUMNS = 11.0, 8.0
_STACKED = 0.55  # height over width of a panel that would stand beside others, were the column wider
_EM_OF_LETTER = 0.62  # at most, on average
_TIE = "\xa0"
_LOWEST = 1.7  # inches that it has at least
_SIZES = {  # in points, of text of 11 points
    "font.size": 11.0,
    "axes.linewidth": 0.8,
    "errorbar.capsize": 2.5,
    "grid.linewidth": 0.7,
    "lines.linewidth": 1.3,
    "lines.markersize": 4.5,
    **{f"{axis}tick.{kind}": size for axis in "xy" for kind, size in (("major.size", 3.5), ("major.width", 0.8))},
    **{f"{axis}tick.{kind}": size for axis in "xy" for kind, size in (("minor.size", 2.0), ("minor.width", 0.6))},
}
_STYLE: dict[Any, Any] = {
    "axes.axisbelow": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "grid.color": "0.9",
    "legend.frameon": False,
    "legend.handlelength": 2.6,  # a whole dash and dot
    **dict.fromkeys(("axes.titlesize", "figure.labelsize", "figure.titlesize"), "medium"),
}
_PRESCRIBED = (
    ("reduced_pressure", "$p^*$", ""),
    ("punch_displacement", "punch displacement", "L_x"),
    ("sliding", "sliding", "L_x"),
    ("sliding_y", "sliding along $y$", "L_x"),
)


class _Picture(Figure):
    """A figure whose text stays text in the files of vector graphics."""

    def savefig(self, *args: Any, **options: Any) -> None:
        """Save the figure as matplotlib does."""
        with mpl.rc_context({"pdf.fonttype": 42, "ps.fonttype": 42, "svg.fonttype": "none"}):
            super().savefig(*args, **options)


_Place = Literal["outside upper center", "outside lower center"]


def drawn(figure: Callable[Given, Figure]) -> Callable[Given, Figure]:
    """Make a figure check what it is given, as `checked` does, and that it can draw the labels and units of datasets.

    Raises InputError.
    """
    of_checked = checked(figure)

    @wraps(figure)
    def call(*args: Given.args, **kwargs: Given.kwargs) -> Figure:
        for dataset in (each for each in (*args, *kwargs.values()) if isinstance(each, xr.Dataset)):
            for name, variable in dataset.variables.items():
                for text in (variable.attrs.get(key, "") for key in ("label", "units")):
                    if not _is_formula(str(text)):
                        raise UnusableDataError(
                            f"you gave a dataset in which {name} has a label or a unit that is no formula, "
                            f"{brief(text)}; gfmd allows text, and between two $ what matplotlib reads"
                        )
        return of_checked(*args, **kwargs)

    return call


@cache
def _is_formula(text: str) -> bool:
    """Whether matplotlib can draw a text, which may hold formulae."""
    try:
        if text.count("$") > 1:
            MathTextParser("path").parse(text)
    except ValueError:
        return False
    return True


@contextmanager
def sheet(
    count: int,
    columns: int,
    panel: tuple[float, float],
    width: Width | None,
    *,
    title: str = "",
    least: float = 2.2,
    around: tuple[float, float] | None = None,
    **grid: Any,
) -> Iterator[tuple[Figure, list[Axes]]]:
    """Yield a figure and so many axes by rows, and see to it that all its text has room once it is drawn.

    A panel has a width and a height in inches if text has 11 points. A column of a journal has text of 8 points, and
    has panels below each other that would be narrower than `least` inches. A map keeps its shape within the inches
    `around` it, for text of 11 points. `grid` goes to matplotlib's subplots.
    """
    scale, fitting = 1.0, max(1, min(columns, count))
    across, up = panel
    if width is not None:
        scale, columns = _POINTS_OF_COLUMNS / _POINTS, fitting
        fitting = min(fitting, max(1, int(_INCHES[width] / least)))
        across, up = _INCHES[width] / fitting, scale * up
        if around is not None:
            beside, above = (scale * inches for inches in around)
            up = min(up, above + (across - beside) * (panel[1] - around[1]) / (panel[0] - around[0]))
        elif fitting < columns:
            grid.pop("width_ratios", None)
            up = min(up, max(_STACKED * across, _LOWEST))
    rows = max(1, -(-count // fitting))
    with mpl.rc_context(_STYLE | {name: scale * size for name, size in _SIZES.items()}):
        figure = _Picture((fitting * across, rows * up), dpi=150 if width is None else 300, layout="constrained")
        axes = figure.subplots(rows, fitting, squeeze=False, **grid).ravel().tolist()
        for spare in axes[count:]:
            spare.remove()
        if title:
            em = scale * _POINTS / 72.0
            wide = int(figure.get_figwidth() / (_EM_OF_LETTER * em))
            lines = [
                line for each in _tied(title).splitlines() for line in textwrap.wrap(each, wide, break_on_hyphens=False)
            ]
            figure.suptitle("\n".join(lines).replace(_TIE, " "), x=0.01, ha="left")
            _grow(figure, (0.3 + 1.3 * len(lines)) * em)
        yield figure, axes[:count]
        for bins in (4, 4, 3, 3, 2, 2) if width is not None else ():
            # labels that are longer than their place are broken, and labels of ticks that collide thinned or turned
            figure.get_layout_engine().execute(figure)  # type: ignore[union-attr]
            room, drawn = figure.bbox.width / fitting, figure.axes
            changed = [_break(each, axis, room) for each in drawn for axis in ("x", "y", "")]
            changed += [_thin(axis, bins) for each in drawn for axis in (each.xaxis, each.yaxis)]
            if not any(changed):
                break


def small() -> float:
    """Return the size in points of notes within a panel, of a figure that is being drawn."""
    return 0.875 * float(mpl.rcParams["font.size"])


def _grow(figure: Figure, inches: float) -> None:
    """Make a figure higher, so that its panels keep their height."""
    figure.set_figheight(figure.get_figheight() + inches)


def add_legend(figure: Figure, handles: Sequence[Artist], columns: int, place: _Place = "outside upper center") -> None:
    """Put a legend above or below all panels, which keep their height, in so many columns or as many as fit."""
    for fitting in range(min(columns, len(handles)), 0, -1):
        legend = figure.legend(handles=handles, loc=place, ncols=fitting)
        box = legend.get_window_extent()
        if box.width <= figure.bbox.width or fitting == 1:
            break
        legend.remove()
    _grow(figure, box.height / figure.dpi)


def _break(axes: Axes, which: str, across: float) -> bool:
    """Break the label of an axis, or the title, in one more line at spaces outside formulae, if it is too long."""
    text: Text = getattr(axes, f"{which}axis").label if which else axes.title
    box, panel = text.get_window_extent(), axes.get_window_extent()
    middle = 0.5 * (box.x0 + box.x1) % across
    upright, room = which == "y", 2.0 * min(middle, across - middle)
    room = room if which else min(room, panel.width)  # beside a panel stand the numbers of its colours
    if (box.height if upright else box.width) <= (panel.height if upright else room):
        return False
    said, lines = text.get_text(), 2 + text.get_text().count("\n")
    tied = _tied(said.replace("\n", " "))
    text.set_text(textwrap.fill(tied, len(tied) // lines + 4, break_long_words=False).replace(_TIE, " "))
    return text.get_text() != said


def _tied(text: str) -> str:
    """Return a text in which formulae, equations, and numbers with their units have no space to be broken at."""
    return re.sub(r"\$[^$]*\$| = |(?<=\d) (?=[^\W\d])", lambda found: found[0].replace(" ", _TIE), text)


def _thin(axis: Axis, bins: int) -> bool:
    """Have fewer labels on an axis on which some collide; turn those that stand at fixed places."""
    low, high = sorted(axis.get_view_interval())
    ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
    labels = [label for tick in ticks if low <= tick.get_loc() <= high for label in (tick.label1, tick.label2)]
    boxes = [label.get_window_extent() for label in labels if label.get_visible() and label.get_text()]
    apart = 0.4 * max((min(box.width, box.height) for box in boxes), default=0.0) if isinstance(axis, XAxis) else 0.0
    ends = sorted((box.x0, box.x1 + apart) if isinstance(axis, XAxis) else (box.y0, box.y1) for box in boxes)
    if all(before[1] < after[0] for before, after in pairwise(ends)):
        return False
    axis.set_minor_formatter(NullFormatter())
    if isinstance(axis.get_major_locator(), FixedLocator):
        axis.set_tick_params(rotation=90)
    else:
        axis.set_major_locator(LogLocator(numticks=bins) if axis.get_scale() == "log" else MaxNLocator(bins))
    return True


def ordered_colours(count: int) -> list[str]:
    """Return colours of ordered values, from dark to light, so that they are told apart in grey too.

    All have a contrast of at least 3 : 1 to white.
    """
    if count == 1:
        return [COLOURS[0]]
    return [to_hex(mpl.colormaps["viridis"](float(place))) for place in np.linspace(0.0, 0.6, count)]


def few_ticks(axis: Axis) -> None:
    """Leave room between the labels of a linear axis of a small panel."""
    axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))


def least_span(axis: Axis) -> None:
    """Let a linear axis span a tenth of its values at least, so that differences by rounding look like none."""
    low, high = axis.get_data_interval()
    room = 0.05 * max(abs(low), abs(high))
    if high - low < 2.0 * room:  # unlike the interval of an axis without data
        axis.set_view_interval(0.5 * (low + high) - room, 0.5 * (low + high) + room, ignore=True)


def log_ticks(axis: Axis) -> None:
    """Label a logarithmic axis so that values can be read: with plain numbers, and between few powers of ten."""
    low, high = axis.get_view_interval()
    if high < 100.0 * low:
        between = (1.0, 2.0, 5.0) if high < 20.0 * low else (1.0, 3.0)
        axis.set_major_locator(MaxNLocator(3) if high < 4.0 * low else LogLocator(subs=between))
        axis.set_minor_formatter(NullFormatter())
    if high < 100.0 * low or (low >= 1e-4 and high < 1e5):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def of_variable(dataset: xr.Dataset, variable: str) -> str:
    """Label of what is measured."""
    long_name = dataset[variable].attrs.get("long_name", variable)
    return _KAPPA if variable == "kappa" else with_unit(long_name, dataset[variable])


def symbol(variable: str) -> str:
    """Short name of what is measured, within a label."""
    return _SYMBOLS.get(variable, variable.replace("_", " "))


def with_unit(text: str, variable: xr.DataArray) -> str:
    """Text with the unit of a variable behind it."""
    unit = str(variable.attrs.get("units", "1"))
    return text if unit == "1" else f"{text} ({unit})"


def told(value: float, unit: str, digits: int = 4) -> str:
    """Return a number with its unit for a sentence; a unit that begins with a power of ten is multiplied."""
    times, number = r"$\times$" if unit.startswith("$10^") else " ", f"{value:.{digits}g}"
    return (f"${in_formula(number)}$" if "e" in number else number) + (times + unit if unit else "")


def in_formula(number: str) -> str:
    """Return a number as a formula has it: with a power of ten for an exponent, which may stand alone."""
    mantissa, e, exponent = number.replace("inf", r"\infty").partition("e")
    return rf"{mantissa} \times ".removeprefix(r"1 \times ") + f"10^{{{int(exponent)}}}" if e else mantissa


def scaled(variable: xr.DataArray, text: str, natural: str) -> tuple[Reals, str]:
    """Values in the SI prefix that suits them, and their label; `natural` stands for the unit 1."""
    factor, unit = prefix(variable, natural)
    return factor * variable.values, f"{text} ({unit})"


def prefix(
    variable: xr.DataArray | Sequence[xr.DataArray], natural: str, size: Callable[[list[float]], float] | None = None
) -> tuple[float, str]:
    """Return factor and label of the SI prefix that suits the values; natural stands for the unit 1.

    The prefix is that of the largest value, of the largest of several variables, or of a `size` of all values, like the
    one that tables take.
    """
    if not isinstance(variable, xr.DataArray):
        variable = max(variable, key=lambda each: float(abs(each).max()))
    unit = str(variable.attrs.get("units", "1"))
    largest = float(abs(variable).max()) if size is None else size(variable.values.ravel().tolist())
    if unit == "1":
        power = int(np.floor(np.log10(largest))) if largest else 0
        return (1.0, f"${natural}$") if -2 <= power <= 3 else (10.0**-power, rf"$10^{{{power}}}\,{natural}$")
    return si_prefix(largest, unit)


def last_step(dataset: xr.Dataset) -> tuple[str, xr.Dataset]:
    """Return the last step of a path, after its name and its loading; a dataset without a path as it is, after ""."""
    last = dataset.isel(step=-1) if "step" in dataset.dims else dataset
    if dataset.sizes.get("step", 1) == 1:
        return "", last
    said = f"Step {dataset.sizes['step'] - 1}, the last"
    for name, symbol, natural in _PRESCRIBED:
        if name in dataset and dataset[name].any():
            factor, unit = prefix(dataset[name], natural) if natural else (1.0, "")
            said += f", {symbol} = {told(factor * float(dataset[name][-1]), unit)}"
    return said, last


def usual(values: Reals) -> tuple[float, float]:
    """Return the least and the largest finite value that is no outlier (Tukey's outer fences); 0 and 1 without any."""
    known = values[np.isfinite(values)]
    if not known.size:
        return 0.0, 1.0
    low, high = np.quantile(known, (0.25, 0.75))
    inside = known[abs(known - 0.5 * (low + high)) <= _FENCE * (high - low)]
    return (float(inside.min()), float(inside.max())) if inside.size else (float(known.min()), float(known.max()))


def by_nodes(dataset: xr.Dataset, of_profiles: Callable[..., T], of_maps: Callable[..., T]) -> Callable[..., T]:
    """Return what draws a dataset over x, or over x and y: all figures that differ by that ask here."""
    return of_maps if "y" in dataset.dims else of_profiles


def fill(axis: Axes, x: Reals, values: Reals, **named: Any) -> None:
    """Draw values over x, with the area below them, on axes that begin at 0 or below; `named` are settings of these."""
    axis.fill_between(x, values, color=COLOURS[1], alpha=0.35, lw=0)
    axis.plot(x, values, color=COLOURS[1], lw=0.9)
    axis.set(xlim=(x[0], x[-1]), ylim=(min(0.0, values.min()), None), **named)


def edges(centres: Reals) -> Reals:
    """Return the edges of bins of one width around their centres."""
    half = 0.5 * (centres[1] - centres[0])
    return np.append(centres - half, centres[-1] + half)

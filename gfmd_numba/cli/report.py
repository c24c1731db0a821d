"""The command that writes one page of results: what was asked, what came out, how sure that is, what it cost."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from time import sleep, strftime
from typing import TYPE_CHECKING, Any

import click

from gfmd_numba.cli.arguments import NEW_FILE, results_argument
from gfmd_numba.cli.fits import naming
from gfmd_numba.cli.group import main
from gfmd_numba.cli.outputs import check_output, companion, pictures, say_written
from gfmd_numba.cli.tables import duration, endings, fit_options, has_limits, meanings, of_results
from gfmd_numba.cli.terminal import Line, Table, waiting

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from gfmd_numba.campaign.status import Progress

_SECONDS_BETWEEN = 10
_ACROSS, _BETWEEN = 42, 2  # characters of a table that a telephone has room for, and between its columns
_DOTS_OF_TELEPHONES = 220
_UNFINISHED = ("unfinished", "not_asked")
_TREATED = (("measured surface", "processing"), ("left out", "dropped_effects"))
_PROVENANCE = ("seed", "solver", "versions", "git_commit", "fft_plans", "campaign_sha256", "content_sha256")


@main.command()
@results_argument
@click.option("-o", "--output", type=NEW_FILE, help="HTML file to write [next to RESULTS]")
@click.option("--watch", is_flag=True, help="Write the page again every ten seconds until the run has ended")
def report(results: Path, output: Path | None, watch: bool) -> None:
    """Write one HTML page of RESULTS that needs no other file.

    RESULTS is the output directory of a campaign, also of one that runs, or a netCDF file that gfmd wrote. The page
    has the numbers with their errors, the pictures, all warnings, the cost, and the YAML that gives them again. While
    a campaign runs, the page in a browser reloads itself.
    """
    from gfmd_numba.campaign.results import read_results

    while True:
        file, now = _collected(results)
        page = output or companion(file, "report", ".html")
        check_output(page, file, file.parent / "campaign.yaml", suffixes=[".html"])
        running = now if now is not None and now.running else None
        with waiting("writing the report"), naming(file):
            _write(page, read_results(file), file, running)
        if not watch or running is None:
            break
        sleep(_SECONDS_BETWEEN)
    say_written("report", page)


def _collected(results: Path) -> tuple[Path, Progress | None]:
    """Return the file of results, with all that a campaign that runs has finished, and how far that is."""
    from gfmd_numba.campaign.collection import collect
    from gfmd_numba.campaign.results import results_file
    from gfmd_numba.campaign.status import campaign_in, progress

    if not (results / "campaign.yaml").is_file():
        return results_file(results), None
    now = progress(results)
    return (collect(campaign_in(results)[0], results) if now.running else results_file(results)), now


def _write(page: Path, dataset: xr.Dataset, file: Path, running: Progress | None) -> None:
    import jinja2

    from gfmd_numba.analysis import fit_tfc
    from gfmd_numba.storage import mark
    from gfmd_numba.storage.atomic_file import replace
    from gfmd_numba.text.recorded_scene import asked, described

    fitted = None
    if "case" in dataset.dims and has_limits(dataset) and running is None:
        fitted = fit_tfc(dataset, **fit_options(dataset))
    loader = jinja2.PackageLoader("gfmd_numba", "cli")
    template = jinja2.Environment(loader=loader, autoescape=True, trim_blocks=True).get_template("report.html")
    versions = json.loads(dataset.attrs.get("versions", "{}"))
    known = {**dataset.attrs, "versions": ", ".join(f"{name} {number}" for name, number in versions.items())}
    told = list(of_results(dataset, fitted)) if running is None else []
    content = template.render(
        title=dataset.attrs.get("title", file.stem),
        subtitle=f"gfmd-numba, from {file.name}, {strftime('%Y-%m-%d %H:%M')}",
        seconds_to_reload=_SECONDS_BETWEEN if running else None,
        running=_state(running) if running else None,
        pressed=described(dataset.attrs.get("scene", "{}"), load="prescribed_load" not in dataset.dims),
        told=list(_parts(told)),
        has_notes=any(isinstance(each, Line) and each.label == "note" for each in told),
        meanings=meanings(told, dataset, fitted),
        pictures=list(_drawn(dataset, fitted)),
        warnings=list(_warnings(dataset)),
        left_out=[(label, each) for label, name in _TREATED for each in str(known.get(name, "")).splitlines() if each],
        asked="\n".join(asked(dataset.attrs).values()) or "The file does not say.",
        cost=list(_cost(dataset)),
        provenance=[(name.replace("_", " "), known[name]) for name in _PROVENANCE if known.get(name, "") != ""],
    )
    replace(page, mark.marked(content.encode()), mark.is_product)


def _parts(told: list[Table | Line]) -> Iterator[dict[str, Any] | list[tuple[str, str]]]:
    """Yield what is told, tables with title, headings and rows, and lines that follow each other as one list."""
    lines: list[tuple[str, str]] = []
    for each in told:
        if isinstance(each, Line):
            lines.append((each.label, each.text))
            continue
        if lines:
            yield lines
        lines = []
        shared = {heading: cells[0] for heading, cells in each.parameters.items() if len(set(cells)) == 1}
        title = ", ".join((each.title, *(f"{heading} = {cell}" for heading, cell in shared.items() if cell != "-")))
        columns = {name: cells for name, cells in {**each.parameters, **each.values}.items() if name not in shared}
        widths = [max(map(len, [*name.split(), *cells]), default=0) for name, cells in columns.items()]
        rows = list(zip(*columns.values(), strict=True))
        stacked = sum(widths) + _BETWEEN * len(widths) > _ACROSS
        yield {"title": title, "headings": list(columns), "rows": rows, "stacked": stacked}
    if lines:
        yield lines


def _drawn(dataset: xr.Dataset, fitted: xr.Dataset | None) -> Iterator[dict[str, Any]]:
    """Yield each picture: its name, its width in inches and, as text, the PNG and that of a column for telephones."""
    wide, narrow = (pictures(dataset, fitted, Path("picture.png"), width) for width in (None, "single"))
    for path, draw in wide.items():
        figure = draw()
        columns = _png(narrow[path](), _DOTS_OF_TELEPHONES)
        yield {"name": path.stem, "width": figure.get_figwidth(), "content": _png(figure), "narrow": columns}


def _png(figure: Figure, dots: int | None = None) -> str:
    """Return a figure as text, with so many dots per inch or those that it has."""
    import base64
    import io

    content = io.BytesIO()
    figure.savefig(content, format="png", dpi=dots or "figure")
    return base64.b64encode(content.getvalue()).decode()


def _warnings(dataset: xr.Dataset) -> Iterable[str]:
    """Yield the reasons to doubt the results, and how simulations ended that are not ok."""
    yield from dataset.attrs.get("validity", "").splitlines()
    yield from dataset.attrs.get("failures", "").splitlines()
    if "status" in dataset and "flag_sentences" in dataset["status"].attrs:
        for name, which, sentence in endings(dataset["status"]):
            if name not in _UNFINISHED:
                yield f"{int(which.sum())} of {which.size} ended as {name}, and stand in no mean. {sentence}"


def _cost(dataset: xr.Dataset) -> Iterator[tuple[str, str]]:
    attributes = dataset.attrs
    if "cpu_seconds" in attributes:
        yield "processor time of the contacts", duration(attributes["cpu_seconds"])
    if "predicted_cpu_seconds_p50" in attributes:
        ends = [duration(attributes[f"predicted_cpu_seconds_{end}"]) for end in ("p50", "p90")]
        yield "predicted", f"{ends[0]}, with 90 % probability below {ends[1]}"
    if "last_run_seconds" in attributes:
        yield "the last run", duration(attributes["last_run_seconds"])
    for name in ("n_iterations", "n_transforms"):
        if name in dataset:
            yield name.removeprefix("n_"), f"{int(dataset[name].sum()):,}"
    for name in ("machine", "threads"):
        if name in attributes:
            yield name, str(attributes[name])


def _state(now: Progress) -> str:
    left = "" if now.seconds_left is None else f", about {duration(now.seconds_left)} left"
    return f"{now.campaign} is running: {now.done} of {now.blocks} blocks are done{left}. This page reloads itself."

"""Commands that look at input files."""

from __future__ import annotations

import importlib.util
import json
import sys
import time
from importlib.resources import files
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import click

from gfmd_numba.cli.arguments import NEW_FILE, file_argument
from gfmd_numba.cli.group import SOME_FAILED, main
from gfmd_numba.cli.tables import dimensions
from gfmd_numba.cli.terminal import COLUMNS, say, waiting, warn
from gfmd_numba.text.input_error import InputError
from gfmd_numba.text.numbers import counted
from gfmd_numba.text.printable import printable, word

if TYPE_CHECKING:
    from gfmd_numba.campaign.file import Campaign
    from gfmd_numba.scene import Document, Scene


@main.command()
@file_argument
def check(file: Path) -> None:
    """Check a campaign, scene, surface or cluster FILE.

    The command prints what the file describes, with the size, modulus and load that it gives. If something is wrong,
    the message names the line, the column, what was given and what is allowed. No contact is computed.
    """
    from gfmd_numba.campaign.cluster import NO_JOBQUEUE, Cluster, load_cluster
    from gfmd_numba.scene import Measured, Scene, SceneFile
    from gfmd_numba.scene.document import read_document
    from gfmd_numba.scene.plausible_numbers import implausible
    from gfmd_numba.scene.surface_file import load_surface

    document = read_document(file)
    keys = document.data.keys() if isinstance(document.data, dict) else set()
    of_scenes = SceneFile.model_fields.keys() | Scene.model_fields.keys()
    of_jobs = keys & (Cluster.model_fields.keys() - of_scenes) and not keys & (of_scenes - {"interface"})  # in both
    if {"name", "realisations", "reference", "limits", "grid"} & keys:
        kind, doubt = _check_campaign(document)
    elif of_jobs:
        cluster = load_cluster(document)
        kind = f"a cluster of up to {cluster.jobs.max} jobs, {cluster.most_workers} workers"
        usable = importlib.util.find_spec("dask_jobqueue") is not None
        doubt = "" if usable else f"this cluster cannot be used here: {NO_JOBQUEUE}"
    elif "surface" in keys:
        from gfmd_numba.simulate.surface import made_surface

        described = load_surface(document)[0]
        doubts = made_surface(described, document).doubts if isinstance(described.surface, Measured) else ()
        kind, doubt = "a surface", "\n".join((*implausible(described), *doubts))
    else:
        kind, doubt = _check_scene(document)
    click.echo(f"{printable(file)}: {kind}")
    for sentence in doubt.splitlines():
        warn(sentence)


@main.command()
@file_argument
@click.option("--unit", help="Unit of the moduli, like MPa, if the header of FILE states none")
@click.option("--poissons-ratio", type=float, help="Poisson's ratio of the body; moduli of shear (G') need it")
def relaxation(file: Path, unit: str | None, poissons_ratio: float | None) -> None:
    """Fit the relaxation of a body to a table of dynamic mechanical analysis (DMA).

    FILE is a text file. Its header names the columns, like `f [Hz]; E' [MPa]; tan delta`; without names, they are
    frequency in Hz, storage modulus and loss modulus. The command prints the `body` of a scene, and how far the fit is
    from the table.
    """
    from gfmd_numba.scene.units import PRESSURE
    from gfmd_numba.simulate.dma_table import read_table
    from gfmd_numba.simulate.prony_fit import fit_relaxation

    table = read_table(file, unit, poissons_ratio)
    for sentence in table.warnings():
        warn(sentence)
    found = fit_relaxation(table)
    span = f"{table.frequency[0]:g} to {table.frequency[-1]:g} Hz"

    def told(modulus: float) -> str:
        return f"{PRESSURE.in_unit(modulus, table.unit):.6g} {table.unit}"

    fitted = f"{printable(file)}: {table.frequency.size} frequencies, {span}; rms misfit {found.misfit:.2%}"
    for sentence in (fitted, f"read {printable(table.read)}"):
        for line in wrap(sentence, COLUMNS - 4, break_long_words=False, break_on_hyphens=False):
            click.echo(f"  # {line}")
    click.echo(f"  body:\n    youngs_modulus: {told(found.youngs_modulus)}")
    nu = "# poissons_ratio: 0.5   # not in the table" if poissons_ratio is None else f"poissons_ratio: {poissons_ratio}"
    click.echo(f"    {nu}\n    relaxation:")
    for modulus, decay in zip(found.series.moduli, found.series.times, strict=True):
        click.echo(f"      - {{modulus: {told(modulus * found.youngs_modulus)}, time: {decay:.6g} s}}")
    if found.warning:
        warn(found.warning)


def _check_campaign(document: Document) -> tuple[str, str]:
    from gfmd_numba.campaign.axes import doubt_of_numbers, values_of
    from gfmd_numba.campaign.file import is_without_levels, load_campaign

    campaign = load_campaign(document)[0]
    doubts = doubt_of_numbers(campaign.scene, campaign.grid, campaign.path).splitlines()
    scene, few = campaign.scene, _has_few_levels(campaign)
    hardened = values_of(campaign.grid, "hardness") is not None
    if few or hardened or _needs_surfaces(scene) or scene.follows_topography or scene.boundary is not None:
        from gfmd_numba.campaign.plan import plan

        planned = plan(document)
        campaign, doubts = planned.campaign, planned.validity.splitlines()
        if few:
            from gfmd_numba.campaign.plan import refused_limits

            doubts += refused_limits(planned.campaign, planned.cases)
    kind = f"a campaign of {counted(campaign.n_cases, 'case')}"
    if is_without_levels(document, campaign):
        targets = " and ".join(f"{share:.2%} of {variable}" for variable, share in (campaign.target or {}).items())
        kind = f"a campaign to {targets}, which begins with {counted(campaign.n_cases, 'case')}"
    elif campaign.seed is not None:
        kind += f" x {campaign.realisations.reference} realisations"
    kind += f" along a path of {counted(len(campaign.path), 'step')}" if campaign.path else ""
    return ", ".join(filter(None, (kind, dimensions(campaign.scene, campaign.grid)))), "\n".join(doubts)


def _has_few_levels(campaign: Campaign) -> bool:
    """Return whether the fit itself must check the levels. Three of each are always enough, and need not import it."""
    known = {name for name, exponent in campaign.fit.fixed if exponent is not None}
    placed = [each.discretisation for each in campaign.discretisations() if each.discretisation is not None]
    for axis in campaign.limits.varied:
        levels = {getattr(eps, axis) for eps in placed} - ({1.0} if axis == "eps_c" else set())
        if getattr(campaign.limits, axis) is None or len(levels) < (2 if axis in known else 3):
            return True
    return False


def _check_scene(document: Document) -> tuple[str, str]:
    from gfmd_numba.contact.refusal import check_combination
    from gfmd_numba.scene import load_scene
    from gfmd_numba.scene.plausible_numbers import implausible

    file, document = load_scene(document)
    doubts: list[str] = []
    if _needs_surfaces(file.scene):
        from gfmd_numba.contact.contact_input import read
        from gfmd_numba.contact.validity import input_warnings

        given = read(file, document)
        file, doubts = given.file, input_warnings(given)
    check_combination(document, file.scene, file.numerics, file.path)
    kind = "a scene" if file.scene.has_punch else "a loaded body"
    told = ", ".join(filter(None, (kind, dimensions(file.scene)))) if file.scene.has_punch else kind
    return told, "\n".join((*implausible(file.scene, file.path), *doubts))


def _needs_surfaces(scene: Scene) -> bool:
    """Return whether a check takes more than records: measured surfaces, and what pressures are to be held against."""
    from gfmd_numba.scene import Measured

    if any(isinstance(surface, Measured) for surface in scene.surfaces.values()):
        return True
    acting = scene.interface
    return acting.reaches_across or acting.hardness is not None or scene.body.plasticity is not None


@main.command()
@click.argument(
    "kind", type=click.Choice(["campaign", "scene", "surface", "cluster", "combinations"]), default="campaign"
)
def schema(kind: str) -> None:
    """Print the JSON Schema of a KIND of file.

    Editors use it to complete and check YAML. The kind "combinations" prints what goes together in a scene, as
    Markdown.
    """
    if kind == "combinations":
        from gfmd_numba.contact.combinations import combinations_page

        click.echo(combinations_page(), nl=False)
        return
    click.echo(json.dumps(schemas()[kind], indent=2))


def schemas() -> dict[str, dict[str, Any]]:
    """Return the JSON Schemas of all kinds of files, with the names of the solvers."""
    from pydantic import BaseModel

    from gfmd_numba.campaign.cluster import Cluster
    from gfmd_numba.campaign.file import Campaign
    from gfmd_numba.scene import SceneFile
    from gfmd_numba.scene.surface_file import SurfaceFile
    from gfmd_numba.solvers.table import SOLVERS

    records: dict[str, type[BaseModel]] = {
        "campaign": Campaign,
        "scene": SceneFile,
        "surface": SurfaceFile,
        "cluster": Cluster,
    }
    described = {kind: record.model_json_schema() for kind, record in records.items()}
    for schema_of_kind in described.values():
        if "Numerics" in schema_of_kind.get("$defs", {}):
            schema_of_kind["$defs"]["Numerics"]["properties"]["solver"]["enum"] = ["auto", *SOLVERS]
    return described


@main.command()
@click.argument("file", type=NEW_FILE, default="campaign.yaml")
def init(file: Path) -> None:
    """Write an example campaign with comments to FILE."""
    from gfmd_numba.storage.atomic_file import replace
    from gfmd_numba.storage.mark import is_product

    if file.exists() or file.is_symlink():
        raise InputError(f"{file}: this file exists, and gfmd overwrites nothing; choose a new name")
    replace(file, [files("gfmd_numba.campaign").joinpath("template.yaml").read_bytes()], is_product)
    say("campaign", f"{file}: `gfmd plan {word(file)}` says what it costs, `gfmd run {word(file)}` runs it")


@main.command()
def doctor() -> None:
    """Check this installation.

    The command prints the versions of the packages and the cache folder, solves a contact whose solution is known, and
    starts two workers.
    """
    from gfmd_numba.campaign import provenance
    from gfmd_numba.storage import cache

    for name, installed in provenance.versions().items():
        say(name, installed, width=14)
    say("machine", provenance.machine(), width=14)
    say("cache", str(cache.directory()), width=14)
    ill = False
    for name, examine in (("a contact", _examine_contact), ("two workers", _examine_workers)):
        begun = time.perf_counter()
        try:
            with waiting(f"examining {name}"):
                finding = examine()
        except Exception as error:
            ill, finding = True, f"failed: {type(error).__name__}: {error}"
        say(name, f"{finding} ({time.perf_counter() - begun:.1f} s)", width=14)
    if ill:
        sys.exit(SOME_FAILED)


def _examine_contact() -> str:
    """Press a wave and compare with Westergaard, which shows that kernels compile and transforms are scaled rightly."""
    import numpy as np

    from gfmd_numba.elasticity import stiffness
    from gfmd_numba.elasticity.spectral_response import SpectralResponse
    from gfmd_numba.fourier import grid
    from gfmd_numba.solvers.equilibrium import equilibrate
    from gfmd_numba.solvers.table import Options
    from gfmd_numba.theory import closed_forms

    nx, amplitude, load = 256, 0.01, 0.01
    x = np.arange(nx) / nx - 0.5
    punch = amplitude * (1.0 - np.cos(2.0 * np.pi * x))[np.newaxis]
    half_space = SpectralResponse.of_normal(stiffness.half_space(grid.wavenumbers(nx)))
    found = equilibrate(punch, half_space, load, Options("conjugate_gradients"))
    expected = closed_forms.westergaard_pressure(x, load, amplitude)
    expected[np.abs(x) > closed_forms.westergaard_half_width(load, amplitude)] = 0.0
    error = float(np.sqrt(np.mean((found.pressure[0] - expected) ** 2)) / expected.max())
    if error > 0.01:
        raise ArithmeticError(f"pressure under a wave is {error:.1%} off Westergaard's solution")
    return f"right to {error:.1e} of Westergaard's peak pressure"


def _examine_workers() -> str:
    from gfmd_numba.campaign import provenance
    from gfmd_numba.campaign.workers import local

    with local(2) as client:
        if client.submit(provenance.versions).result(timeout=60) != provenance.versions():
            raise RuntimeError("their packages differ from those of this process")
        return f"{len(client.nthreads())} started"

"""Commands that look at input files."""

from __future__ import annotations

from pathlib import Path

import click

from gfmd_numba.cli.arguments import file_argument
from gfmd_numba.cli.group import main


@main.command()
@file_argument
def check(file: Path) -> None:
    """Check a campaign, scene or surface FILE and say what is wrong with it."""
    from gfmd_numba.campaign.specification import Campaign, load_campaign
    from gfmd_numba.scene import load_scene, read_document
    from gfmd_numba.scene.surface_file import load_surface

    data = read_document(file).data
    if isinstance(data, dict) and {"name", "realisations", "reference", "limits", "grid"} & data.keys():
        campaign: Campaign = load_campaign(file)[0]
        click.echo(f"{file}: a campaign of {campaign.n_cases} cases x {campaign.realisations} realisations")
    elif isinstance(data, dict) and "surface" in data:
        load_surface(file)
        click.echo(f"{file}: a surface")
    else:
        load_scene(file)
        click.echo(f"{file}: a scene")

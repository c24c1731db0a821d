"""Commands on the output directory of a campaign: how far it is, what it has found, and whether files are sound."""

from __future__ import annotations

import json
import sys
import time
from dataclasses import asdict
from pathlib import Path

import click

from gfmd_numba.cli.arguments import json_option
from gfmd_numba.cli.group import SOME_FAILED, main
from gfmd_numba.cli.outputs import say_written
from gfmd_numba.cli.tables import duration
from gfmd_numba.cli.terminal import say, say_command, warn

_directory = click.argument("directory", type=click.Path(exists=True, file_okay=False, path_type=Path))


@main.command()
@_directory
@json_option
@click.option("--watch", is_flag=True, help="Repeat every two seconds until the run has ended")
def status(directory: Path, as_json: bool, watch: bool) -> None:
    """Show how far the campaign in an output DIRECTORY is.

    If blocks have failed, the command prints the reason of each, and the command that runs it again.
    """
    from gfmd_numba.campaign.status import progress

    while True:
        now = progress(directory)
        if as_json:
            click.echo(json.dumps(asdict(now)))
        else:
            left = "" if now.seconds_left is None or not now.running else f", about {duration(now.seconds_left)} left"
            state = "running" if now.running else "finished" if now.done == now.blocks else "not running"
            failed = f", {len(now.failed)} failed" if now.failed else ""
            say("", f"{now.campaign}: {now.done} of {now.blocks} blocks done{failed}; {state}{left}", width=0)
        if not watch or not now.running:
            break
        time.sleep(2.0)
    if not as_json:
        for block, failure in now.failed.items():
            say(failure.status, f"{block}: {failure.reason}", width=10)
            say_command(now.retry[block], width=10)


@main.command()
@_directory
def collect(directory: Path) -> None:
    """Write the finished work in a DIRECTORY to its netCDF file.

    You can do this while the campaign runs. DIRECTORY is the output directory of a campaign.
    """
    from gfmd_numba.campaign.collection import collect as collect_campaign
    from gfmd_numba.campaign.results import read_results
    from gfmd_numba.campaign.status import campaign_in

    results = collect_campaign(campaign_in(directory), directory)
    say_written("results", results)
    for doubt in read_results(results).attrs["validity"].splitlines():
        warn(doubt)


@main.command()
@_directory
def verify(directory: Path) -> None:
    """Compare the files of an output DIRECTORY with their digests.

    These are the shards, the results, the notes of the run, its mark and its copy of the campaign file. The command
    exits with 3 if one of them is damaged or was changed.
    """
    from gfmd_numba.campaign.output_directory import AlteredError
    from gfmd_numba.campaign.status import verify as verify_files

    try:
        verdict = verify_files(directory)
    except AlteredError as error:
        warn(f"{error}; nothing else was looked at")
        sys.exit(SOME_FAILED)
    click.echo(f"shards   {verdict.sound} sound, {len(verdict.damaged)} damaged, {verdict.missing} missing")
    for name in verdict.damaged:
        say("damaged", f"{name}: `gfmd run` computes it again")
    for name in verdict.foreign:
        say("foreign", f"{name}: belongs to no case of this campaign and is not used")
    for file, state in verdict.altered.items():
        say("damaged", f"{file}, {state}")
    if not verdict.altered:
        click.echo("others   sound")
    if verdict.damaged or verdict.altered:
        sys.exit(SOME_FAILED)

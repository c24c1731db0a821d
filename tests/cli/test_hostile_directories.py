"""Whatever stands in an output directory: no command changes what is not gfmd's, hangs, or ends in a traceback."""

import random
import shutil
import signal
import stat
import sys

import pytest
from click.testing import CliRunner

from gfmd_numba.campaign import collection
from gfmd_numba.campaign.plan import plan
from gfmd_numba.cli import main
from support.campaigns import TINY, campaign
from support.hostile_files import KINDS, damage, is_ours, put, state
from support.scenes import SCENE

pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="no pipes and no alarm"),
    pytest.mark.usefixtures("undrawn"),
]
SECONDS = 120  # in which nothing takes so long but what waits for a pipe
COMMANDS = (
    "run {file} -o {out} --workers=0",
    "run {file} -o {out} --workers=0 --retry-failed",
    "run {out}/campaign.yaml -o {out} --workers=0",
    "collect {out}",
    "status {out}",
    "status {out} --json",
    "verify {out}",
    "fit {out}",
    "fit {out}/tiny.nc -o {name}",
    "plot {out}",
    "plot {out}/tiny.nc -o {name}",
    "solve {scene} -o {name}",
    "curve {scene} --loads 0.05,0.1 -o {name}",
    "check {out}/campaign.yaml",
)


def gfmd(command):
    """Run a command in this process; a hang is an error."""

    def too_long(*_):
        raise TimeoutError(command)

    before = signal.signal(signal.SIGALRM, too_long)
    signal.alarm(SECONDS)
    try:
        return CliRunner().invoke(main, command.split())
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    """A finished campaign, another of the same name, and what lies outside of both."""
    folder = tmp_path_factory.mktemp("world")
    for name, text in (("out", TINY), ("others", TINY.replace("seed: 1", "seed: 2"))):
        (folder / f"for {name}").mkdir()
        path = campaign(folder / f"for {name}", text)
        assert CliRunner().invoke(main, ["run", str(path), "-o", str(folder / name), "--workers=0"]).exit_code == 0
    outside = folder / "outside"
    (outside / "folder").mkdir(parents=True)
    (outside / "folder" / "thesis.tex").write_text("precious")
    (outside / "thesis.tex").write_text("precious")
    (outside / "scene.yaml").write_text(SCENE)
    campaign(outside, TINY)
    command = ["solve", str(outside / "scene.yaml"), "-o", str(outside / "contact.nc")]
    assert CliRunner().invoke(main, command).exit_code == 0
    return folder


@pytest.fixture(scope="module", autouse=True)
def _quick():
    """Nothing is compiled beforehand, and git is not asked."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gfmd_numba.campaign.run.compile_kernels", lambda problems: None)
        patch.setattr(collection, "git_commit", str)
        yield


def names_of(out):
    """Names that gfmd gives to files of an output directory, and some that only look so."""
    block, shards = next(iter(plan(out / "campaign.yaml").blocks)).name, out / "shards"
    return [
        *(out / name for name in ("tiny.nc", "tiny.png", "tiny-rounds.png", "run.json", "rounds.json")),
        *(out / name for name in (".gfmd-campaign", ".lock", "campaign.yaml", "shards", "jobs", "fit.nc", "curve.csv")),
        *(out / name for name in ("notes.late.tmp", f"a.{'0123456789abcdef' * 2}.tmp", "thesis.tex")),
        *(shards / f"{block}{suffix}" for suffix in (".shard", ".failed", ".bundle")),
        *(shards / name for name in ("notes.late.tmp", f"{block}.late.{32 * '0'}.tmp")),
    ]


def trial(world, folder, seed):
    pick = random.Random(seed)
    out, outside = folder / "out", folder / "outside"
    shutil.copytree(world / "outside", outside)
    if pick.random() < 0.8:
        shutil.copytree(world / "out", out)
    else:
        out.mkdir()
    names = names_of(world / "out")
    told = []
    for _ in range(pick.randint(1, 3)):
        name = out / pick.choice(names).relative_to(world / "out")
        if name.is_file() and not name.is_symlink() and name.stat().st_size and pick.random() < 0.3:
            damage(name, pick)
            told.append(f"{name.name} damaged")
        elif name.parent.is_dir() and not name.parent.is_symlink():
            kind = pick.choice(KINDS)
            put(name, kind, outside, world / "others")
            told.append(f"{name.name}: {kind.__name__}")
    before = state(folder)
    kept = {path: entry for path, entry in before.items() if not is_ours(entry) and not stat.S_ISDIR(entry[0])}
    for command in pick.choices(COMMANDS, k=4):
        chosen = out / pick.choice(names).relative_to(world / "out")
        asked = command.format(
            file=outside / "campaign.yaml", out=out, scene=outside / "scene.yaml", name=chosen.with_suffix(".nc")
        )
        told.append(asked)
        done = gfmd(asked)
        assert done.exception is None or isinstance(done.exception, SystemExit), (told, done.exception)
        assert done.exit_code in (0, 2, 3), (told, done.output)
        assert "Traceback" not in done.output, told
        after = state(folder)
        for path, entry in kept.items():
            assert after.get(path) == entry, (path, told)
        assert [path for path in after if outside in path.parents and path not in before] == []
    return told


@pytest.mark.parametrize("seeds", [range(1), pytest.param(range(1, 13), marks=pytest.mark.long)])
def test_no_command_touches_what_is_not_ours(world, tmp_path, seeds):
    for seed in seeds:
        folder = tmp_path / str(seed)
        folder.mkdir()
        trial(world, folder, seed)
        shutil.rmtree(folder)

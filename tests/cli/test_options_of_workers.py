"""`gfmd run` takes one kind of workers, and `gfmd check` reads the file of a cluster."""

import pytest
from click.testing import CliRunner

from gfmd_numba.cli import main
from support.campaigns import campaign
from support.command_line import unfolded

CLUSTER = "cores: 4\nmemory: 8 GB\nwalltime: 2 h\njobs: {max: 10}\n"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (
            ["--workers=2", "--scheduler=tcp://127.0.0.1:1"],
            "--scheduler: you gave --workers as well; gfmd allows one of them",
        ),
        (
            ["--scheduler=tcp://127.0.0.1:1", "--cluster=c.yaml"],
            "--cluster: you gave --scheduler as well; gfmd allows one",
        ),
        (["--insecure"], "--insecure: you gave no --scheduler, and --insecure is about its address"),
    ],
)
def test_options_that_name_two_kinds_of_workers_are_refused(tmp_path, options, said):
    refused = CliRunner().invoke(main, ["run", str(campaign(tmp_path)), *options])
    assert refused.exit_code == 2
    assert said in unfolded(refused.output)


def test_a_cluster_file_is_checked(tmp_path):
    (tmp_path / "cluster.yaml").write_text(CLUSTER)
    checked = CliRunner().invoke(main, ["check", str(tmp_path / "cluster.yaml")])
    assert (checked.exit_code, checked.output.partition(": ")[2]) == (0, "a cluster of up to 10 jobs, 40 workers\n")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("cores: 4\n", "jobs: you gave nothing; gfmd needs a mapping of 'min', 'max'"),
        ("partition: long\ninterface: ib0\n", "cores: you gave nothing; gfmd needs a whole number from 1"),
        ("body: {poissons_ratio: 0.3}\ncores: 4\n", "cores: you gave an unknown key; gfmd allows one of 'body'"),
    ],
)
def test_a_file_is_judged_as_a_cluster_by_any_of_its_keys(tmp_path, text, said):
    (tmp_path / "file.yaml").write_text(text)
    checked = CliRunner().invoke(main, ["check", str(tmp_path / "file.yaml")])
    assert checked.exit_code == 2
    assert said in unfolded(checked.output)


def test_a_fault_in_a_cluster_file_is_told_before_a_run_begins(tmp_path):
    (tmp_path / "cluster.yaml").write_text(CLUSTER.replace("8 GB", "8 m"))
    output = str(tmp_path / "out")
    command = ["run", str(campaign(tmp_path)), "-o", output, "--cluster", str(tmp_path / "cluster.yaml")]
    refused = CliRunner().invoke(main, command)
    assert refused.exit_code == 2
    assert "cluster.yaml:2:9: memory: you gave '8 m'; gfmd allows a memory in B, MB, GB" in unfolded(refused.output)
    assert not (tmp_path / "out").exists()

"""The cluster file: what it may say, and what is told where it says something else."""

import pytest

from gfmd_numba.campaign.cluster import load_cluster
from gfmd_numba.scene import InputError
from support.command_line import unfolded

CLUSTER = "cores: 4\nmemory: 8 GB\nwalltime: 2 h\njobs: {max: 10}\n"


def test_a_cluster_file_may_give_memory_and_walltime_with_units(tmp_path):
    (tmp_path / "cluster.yaml").write_text(CLUSTER)
    cluster = load_cluster(tmp_path / "cluster.yaml")
    assert (cluster.memory, cluster.walltime, cluster.most_workers) == (8e9, 7200.0, 40)
    assert cluster == load_cluster({"cores": 4, "memory": 8e9, "walltime": 7200.0, "jobs": {"max": 10}})


@pytest.mark.parametrize(
    ("seconds", "lifetime"),
    [(60.0, 45), (5400.0, 5280), (180_000.5, 179_880)],
)
def test_workers_leave_before_their_walltime_ends(seconds, lifetime):
    cluster = load_cluster({"cores": 1, "memory": 1e9, "walltime": seconds, "jobs": {"max": 1}})
    assert cluster.lifetime == lifetime


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("8 GB", "8G", "2:9: memory: you gave '8G'; gfmd allows a memory in B, MB, GB or the like"),
        ("2 h", "02:00:00", "3:11: walltime: you gave '02:00:00'; gfmd allows a time in s, min, h or the like"),
        ("{max: 10}", "{min: 11, max: 10}", "4:13: jobs.min: you gave 11; gfmd allows at most jobs.max, 10"),
        ("{max: 10}", "10", "4:7: jobs: you gave 10; gfmd allows a mapping of 'min', 'max'"),
        ("cores: 4", "cores: 0", "1:8: cores: you gave 0; gfmd allows a whole number from 1 to 4096"),
        (
            "cores: 4",
            "cores: 4\nqueue: main",
            "2:1: queue: you gave an unknown key; gfmd allows one of 'system', 'cores'",
        ),
        ("cores: 4", "cores: 4\nsystem: pbs", "2:9: system: you gave 'pbs'; gfmd allows 'slurm'"),
        ("cores: 4", "cores: 4\npartition: a b", "2:12: partition: you gave 'a b'; gfmd allows up to 100 letters"),
        ("cores: 4", "cores: 4\naccount: --wrap", "2:10: account: you gave '--wrap'; gfmd allows up to 100 letters"),
        ("cores: 4", "cores: 4\naccount: $(id)", "2:10: account: you gave '$(id)'; gfmd allows up to 100 letters"),
        ("cores: 4", 'cores: 4\npartition: "a\\nb"', "partition: you gave 'a\\nb'; gfmd allows up to 100 letters"),
        (
            "cores: 4",
            'cores: 4\ndirectives: ["-x\\n id"]',
            "directives[0]: you gave '-x\\n id'; gfmd allows an option of",
        ),
        ("cores: 4", 'cores: 4\nsetup: ["a\\0b"]', "setup[0]: you gave 'a\\x00b'; gfmd allows one line of shell"),
        ("cores: 4", 'cores: 4\nsetup: ["a\\x85b"]', "setup[0]: you gave 'a\\x85b'; gfmd allows one line of shell"),
        (
            "cores: 4",
            "cores: 4\ndirectives: [exclusive]",
            "directives[0]: you gave 'exclusive'; gfmd allows an option of",
        ),
        (
            "cores: 4",
            "cores: 4\ndirectives: --x",
            "directives: you gave '--x'; gfmd allows a list, each item an option of",
        ),
    ],
)
def test_a_fault_is_told_with_its_place_and_what_is_allowed(tmp_path, old, new, said):
    assert old in CLUSTER
    (tmp_path / "cluster.yaml").write_text(CLUSTER.replace(old, new))
    with pytest.raises(InputError) as told:
        load_cluster(tmp_path / "cluster.yaml")
    assert said in unfolded(str(told.value))

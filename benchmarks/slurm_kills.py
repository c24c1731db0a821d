"""Kill the jobs of a run on SLURM again and again while they hold blocks, and compare the digest with a serial run.

    python benchmarks/slurm_kills.py [KILLS]

Starts SLURM on this machine (as root, where slurm-wlm and munge are installed), runs a campaign in this process, and
the same campaign in jobs, which it kills: one by SIGKILL alone, the next by `scancel`, as the end of a walltime does.
"""

import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import gfmd_numba

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from support.one_machine_slurm import one_machine_slurm

CAMPAIGN = """\
name: killed
seed: 1
realisations: 3000
scene:
  body: {poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
reference: {eps_c: 1/16, eps_f: 1/64, eps_t: 1/4}
grid: {hurst: [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]}
"""
CLUSTER = "cores: 1\nmemory: 2 GB\nwalltime: 1 h\njobs: {max: 2}\n"


def main(kills: int) -> None:
    """Print how long both runs take, how many jobs were killed, and whether the digests agree."""
    with TemporaryDirectory() as name, TemporaryDirectory() as home:
        folder = Path(name)
        (folder / "campaign.yaml").write_text(CAMPAIGN)
        (folder / "cluster.yaml").write_text(CLUSTER)
        begun = time.monotonic()
        serial = gfmd_numba.run(folder / "campaign.yaml", folder / "serial").attrs["content_sha256"]
        print(f"serial: {time.monotonic() - begun:.0f} s, {serial[:16]}", flush=True)
        with one_machine_slurm(Path(home)) as environment:
            begun = time.monotonic()
            command = [sys.executable, "-m", "gfmd_numba", "run", "campaign.yaml", "-o", "jobs"]
            run = subprocess.Popen([*command, "--cluster", "cluster.yaml"], cwd=folder, env=environment)
            killed = kill_jobs(run, kills, folder / "jobs", environment)
            assert run.wait() == 0
        in_jobs = gfmd_numba.open_campaign(folder / "jobs").attrs["content_sha256"]
        print(f"in jobs: {time.monotonic() - begun:.0f} s, {in_jobs[:16]}, {killed} jobs killed")
        print("same digest" if in_jobs == serial else "ANOTHER DIGEST")
        assert in_jobs == serial
        assert killed == kills, "the campaign was over too soon"


def kill_jobs(run: subprocess.Popen[bytes], kills: int, output: Path, environment: dict[str, str]) -> int:
    """Number of jobs killed, each at work on a block, as long as the run lasts."""
    killed = set()
    while run.poll() is None and len(killed) < kills:
        for job in running(environment) - killed:
            log = next(output.glob(f"jobs/*-{job}.err"), None)
            if log is not None and "Registered to" in log.read_text():
                time.sleep(1.0 + len(killed) % 4)  # it has blocks by now, and may have handed some back
                how = [] if len(killed) % 2 else ["--signal=KILL", "--full"]
                if subprocess.run(["scancel", *how, job], env=environment).returncode:
                    break  # it has just ended
                killed.add(job)
                print(f"killed {len(killed)}: {len(list(output.glob('shards/*')))} files of shards", flush=True)
                break
        time.sleep(0.2)
    return len(killed)


def running(environment: dict[str, str]) -> set[str]:
    """Numbers of the jobs that run."""
    command = ["squeue", "--noheader", "--states=RUNNING", "--format=%A"]
    return set(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.split())


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)

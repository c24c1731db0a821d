"""SLURM on this machine alone: its three daemons with files of their own, on loopback, as long as a test lasts."""

import os
import shutil
import socket
import subprocess
import time
from contextlib import ExitStack, contextmanager

NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "sinfo")
_WAIT = 60.0  # s for a daemon to answer, and for jobs to end

# The times let a machine with much else to do be slow: by SLURM's own a node is drained for it, and jobs wait for ever.
_CONFIGURATION = """\
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=2
BatchStartTimeout=120
MessageTimeout=60
UnkillableStepTimeout=600
SlurmdTimeout=0
NodeName={host} NodeAddr=127.0.0.1 CPUs=8 RealMemory=32000
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def missing():
    """Why SLURM cannot be started here, empty if it can."""
    absent = [name for name in NEEDED if shutil.which(name, path=_path()) is None]
    if absent:
        return f"no {', '.join(absent)} (apt-get install slurm-wlm munge)"
    return "" if os.geteuid() == 0 else "only root may start slurmd"


@contextmanager
def one_machine_slurm(folder):
    """Run SLURM with all its files in an empty folder; yields the environment for its commands."""
    names = {"host": socket.gethostname().split(".")[0], "folder": folder}
    ports = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
    names["controller"], names["node"] = (port.getsockname()[1] for port in ports)
    for port in ports:
        port.close()
    folder.chmod(0o755)  # munged refuses a socket that others cannot reach
    for name in ("state", "spool", "munge"):
        (folder / name).mkdir(mode=0o755 if name != "munge" else 0o700)
    (folder / "slurm.conf").write_text(_CONFIGURATION.format(**names))
    (folder / "munge/key").write_bytes(os.urandom(128))
    (folder / "munge/key").chmod(0o400)
    environment = os.environ | {"SLURM_CONF": f"{folder}/slurm.conf", "PATH": _path()}
    munge = [f"--{name}-file={folder}/munge/{name}" for name in ("key", "seed", "log", "pid")]
    with ExitStack() as stack:
        for command in (
            ["munged", "--foreground", "--force", f"--socket={folder}/munge.socket", *munge],
            ["slurmctld", "-D"],
            ["slurmd", "-D"],
        ):
            daemon = subprocess.Popen(
                command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=folder
            )
            stack.callback(_end, daemon)
        deadline = time.monotonic() + _WAIT
        while "idle" not in _said(environment, "sinfo", "--noheader", "--format=%T"):
            assert time.monotonic() < deadline, f"SLURM does not answer: see {folder}/slurmctld.log and slurmd.log"
            time.sleep(0.2)
        yield environment
        _said(environment, "scancel", "--user=root")
        deadline = time.monotonic() + _WAIT
        while _said(environment, "squeue", "--noheader").strip() and time.monotonic() < deadline:
            time.sleep(0.2)


def _end(daemon):
    daemon.terminate()
    try:
        daemon.wait(10.0)
    except subprocess.TimeoutExpired:
        daemon.kill()
        daemon.wait()


def _said(environment, *command):
    return subprocess.run(command, env=environment, capture_output=True, text=True).stdout


def _path():
    return os.environ["PATH"] + ":/usr/sbin:/sbin"

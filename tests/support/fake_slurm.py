"""Commands with the names of SLURM's, which run jobs as processes of this machine."""

import os
import signal
import subprocess

_COMMANDS = {
    "sbatch": """\
if [ "$1" = --test-only ]; then
    if grep -q '^#SBATCH -p nowhere' "$2"; then echo 'sbatch: error: invalid partition: nowhere' >&2; exit 1; fi
    exit 0
fi
cp "$1" {folder}/$$.script
wait_and_run='while [ -e {folder}/full ]; do sleep 0.1; done; . "$0"'
setsid sh -c "$wait_and_run" {folder}/$$.script >{folder}/$$.log 2>&1 </dev/null &
echo $! >{folder}/$$.pid
echo "Submitted batch job $$"
""",
    "squeue": """\
state='R None'
[ -e {folder}/full ] && state='PD Resources'
for file in {folder}/*.pid; do
    [ -e "$file" ] || continue
    if grep -q '^State:[[:space:]]*[^ZX]' /proc/$(cat $file)/status 2>/dev/null; then
        echo "$(basename $file .pid) $state"
    fi
done
""",
    "scancel": "kill -KILL -$(cat {folder}/$1.pid) 2>/dev/null\n",
}


def fake_slurm(folder, monkeypatch):
    """Put the commands in front of all others; their jobs leave a .script, a .log and a .pid in the folder.

    Jobs wait as long as it holds a file named `full`.
    """
    for name, script in _COMMANDS.items():
        (folder / name).write_text("#!/bin/sh\n" + script.format(folder=folder))
        (folder / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")


def jobs_of(folder):
    """Numbers of the jobs that run."""
    printed = subprocess.run([folder / "squeue"], capture_output=True, text=True).stdout
    return {line.split()[0] for line in printed.splitlines()}


def kill_job(folder, job):
    """End a job as a power cut would."""
    os.killpg(int((folder / f"{job}.pid").read_text()), signal.SIGKILL)

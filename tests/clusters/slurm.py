"""Runs the script that `afmsweep slurm` writes on a Slurm cluster of one node, which it starts itself. Needs root, Debian's
slurm-wlm, h5py.

slurm.py PROGRAM

Truth is one run of the scene. One share is killed with SIGKILL and has to be queued again by its script; then another is
cancelled, which the merge has to name, and is made again.
"""

import contextlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from same import differing

SCENE = """
[instrument.cantilever]
stiffness = "26 N/m"
frequency = "300 kHz"
quality_factor = 450
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = POINTS, scale = "log" }
"approach.gap" = { from = "8 nm", to = "19 nm", points = 160 }
[run]
periods = 4000
[output]
observables = ["amplitude", "phase", "force_max"]
"""
SHARDS = 8
CONFIGURATION = """ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmUser=root
AuthType=auth/none
CredType=cred/none
AuthInfo=cred_expire=5
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=FOLDER/state
SlurmdSpoolDir=FOLDER/spool
SlurmctldPidFile=FOLDER/slurmctld.pid
SlurmdPidFile=FOLDER/slurmd.pid
ProctrackType=proctrack/linuxproc
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
KillWait=2
NodeName=localhost NodeAddr=127.0.0.1 CPUs=2 RealMemory=4000
PartitionName=main Nodes=localhost Default=YES
"""


def call(*words, **more):
    return subprocess.run(words, check=True, capture_output=True, text=True, **more).stdout.strip()


def wait_for(what, holds, seconds=120.0):
    """Waits until something holds."""
    end = time.monotonic() + seconds
    while not (found := holds()):
        if time.monotonic() > end:
            raise TimeoutError(f"{what}: not in {seconds} s; {call('squeue')}")
        time.sleep(0.1)
    return found


def jobs():
    return call("squeue", "-h", "-r", "-o", "%i %j %T").splitlines()


@contextlib.contextmanager
def cluster(folder):
    """A controller and a node on this machine."""
    for name in ("state", "spool"):
        (folder / name).mkdir()
    configuration = folder / "slurm.conf"
    configuration.write_text(CONFIGURATION.replace("FOLDER", str(folder)))
    os.environ["SLURM_CONF"] = str(configuration)
    for words in (["slurmctld"], ["slurmd", "-N", "localhost"]):
        subprocess.run(words, check=True)
    try:
        wait_for("an idle node", lambda: "idle" in subprocess.run(
            ["sinfo", "-h", "-o", "%T"], capture_output=True, text=True).stdout)
        yield
    finally:
        # A node that has work waits for it.
        subprocess.run(["scancel", "--user=root"], check=False)
        with contextlib.suppress(TimeoutError):
            wait_for("an empty queue", lambda: not jobs(), 30)
        for name in ("slurmd.pid", "slurmctld.pid"):
            pid = int((folder / name).read_text())
            os.kill(pid, 15)
            with contextlib.suppress(ProcessLookupError, TimeoutError):
                while True:
                    os.kill(pid, 0)
                    time.sleep(0.1)


def programs_of(share):
    """Processes that run a share."""
    found = []
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            words = (entry / "cmdline").read_bytes().split(b"\0")
            if b"run" in words and f"{share}/{SHARDS}".encode() in words and b"srun" not in words[0]:
                found.append(int(entry.name))
    return found


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    points = sys.argv[2] if len(sys.argv) > 2 else "16"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "tap.toml").write_text(SCENE.replace("POINTS", points))
        os.chdir(folder)
        options = ["--backend", "cpu"]
        call(program, "run", "tap.toml", "-q", "--no-audit", "-o", "whole.h5", *options)
        call(program, "slurm", "tap.toml", "--shards", str(SHARDS), "-o", "tap.sh", "--", "--portion", "16", *options)
        began = time.monotonic()
        with cluster(folder):
            ids = re.findall(r"\d+", call("bash", "tap.sh"))
            array, merge = ids[1], ids[2]
            killed = wait_for("share 3", lambda: programs_of(3))
            os.kill(killed[0], 9)
            wait_for("the end of the array", lambda: not [one for one in jobs() if one.startswith(f"{array}_")])
            wait_for("the merge", lambda: not [one for one in jobs() if one.startswith(merge)])
            print(f"array of {SHARDS}, one killed: {time.monotonic() - began:.1f} s")
            said = (folder / "results/slurm/tap-3.log").read_text()
            merged = (folder / "results/slurm/tap-merge.log").read_text()
            # How many instances the merge has audited is a matter of time.
            wrong = [one for one in differing("whole.h5", "results/tap.h5") if not one.startswith("audit/")]
            if wrong:
                return f"the merged file differs: {wrong}"
            if "Killed" not in said:
                return f"share 3 was not killed: {said}"

            # Once more, and one share cancelled while it runs.
            for file in folder.glob("results/tap.*"):
                file.unlink()
            ids = re.findall(r"\d+", call("bash", "tap.sh"))
            array, merge = ids[1], ids[2]
            wait_for("share 5", lambda: programs_of(5))
            call("scancel", f"{array}_5")
            wait_for("the merge", lambda: not [one for one in jobs() if one.startswith((array, merge))])
            merged = (folder / "results/slurm/tap-merge.log").read_text()
            wanted = f"share 5/{SHARDS} has no file here"
            if wanted not in merged or (folder / "results/tap.h5").exists():
                return f"the merge does not name share 5: {merged}"
            command = next(line for line in merged.splitlines() if wanted in line).split(": ", 1)[1]
            call(program, *command.split()[1:])
            call("bash", "-c", f"'{program}' merge results/tap.*-of-{SHARDS}.h5 -o results/tap.h5 --no-audit")
            if differing("whole.h5", "results/tap.h5"):
                return "the file merged after a cancelled share differs"
            print(f"with a share cancelled and made again: {time.monotonic() - began:.1f} s in all")
    return 0


if __name__ == "__main__":
    sys.exit(main())

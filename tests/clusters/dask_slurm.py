"""The shares of a run by dask-jobqueue on a Slurm cluster of one node, one of whose worker jobs is killed. Needs root, Debian's
slurm-wlm, dask-jobqueue, h5py.

dask_slurm.py PROGRAM

Truth is one run of the scene. The cluster in `main` is what docs/clusters.md shows.
"""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from dask.distributed import Client
from dask_jobqueue import SLURMCluster
from slurm import SCENE, call, cluster, jobs, programs_of, wait_for

from dask_check import SHARDS, merged, run_share

# The share at which a worker is killed: the first of the second round.
KILLED = 3


def job_of(process):
    """The Slurm job that a process belongs to."""
    for entry in pathlib.Path(f"/proc/{process}/environ").read_bytes().split(b"\0"):
        if entry.startswith(b"SLURM_JOB_ID="):
            return entry.split(b"=")[1].decode()
    raise LookupError(f"process {process} is of no job")


def shares(program, workers):
    """Runs all shares by two jobs; kills one of them while it runs one. Gives the files, and the jobs that there were."""
    with Client(workers) as client:
        workers.adapt(minimum_jobs=2, maximum_jobs=2)
        numbers = list(range(1, SHARDS + 1))
        futures = client.map(lambda k: run_share(program, "tap.toml", k, SHARDS), numbers, retries=2, pure=False)
        process = wait_for(f"share {KILLED}", lambda: programs_of(KILLED))[0]
        journal = pathlib.Path(f"results/tap.{KILLED}-of-{SHARDS}.h5.partial")
        # The journal begins with the choices; what comes after are portions.
        header = 2 * pathlib.Path("results/tap.choices.toml").stat().st_size
        wait_for("a portion in its journal", lambda: journal.exists() and journal.stat().st_size > header)
        # Stopped, so that it cannot end before it is killed.
        os.kill(process, signal.SIGSTOP)
        job = job_of(process)
        call("scancel", "--signal=KILL", "--full", job)
        wait_for(f"the end of job {job}", lambda: not [one for one in jobs() if one.split()[0] == job])
        if not journal.exists():
            raise RuntimeError(f"share {KILLED} was whole before its worker was killed: once more")
        return client.gather(futures), job


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    here = pathlib.Path(__file__).resolve().parent
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        os.chdir(folder)
        pathlib.Path("tap.toml").write_text(SCENE.replace("POINTS", "16"))
        subprocess.run([program, "run", "tap.toml", "-q", "--no-audit", "-o", "whole.h5"], check=True)
        subprocess.run([program, "prepare", "tap.toml", "-q", "--portion", "16"], check=True)
        began = time.monotonic()
        with cluster(folder), SLURMCluster(
            cores=1,
            memory="500 MB",
            job_cpu=1,
            queue="main",
            walltime="00:10:00",
            interface="lo",
            log_directory=str(folder / "logs"),
            local_directory=str(folder / "dask"),
            # The workers find this script's modules.
            job_script_prologue=[f"export PYTHONPATH={here}"],
            scheduler_options={"dashboard_address": None},
        ) as workers:
            files, job = shares(program, workers)
        told = f"{SHARDS} shares by dask-jobqueue, worker job {job} killed: {time.monotonic() - began:.1f} s"
        return merged(program, files, told)


if __name__ == "__main__":
    sys.exit(main())

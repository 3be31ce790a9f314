"""The shares of a run by Dask, one of whose workers is killed. Needs dask.distributed, h5py.

dask_check.py PROGRAM

Truth is one run of the scene. The functions `run_share` and `main` are what docs/clusters.md shows.
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

from dask.distributed import Client, LocalCluster
from same import differing
from slurm import SCENE

SHARDS = 8


def run_share(program, scene, number, shards):
    """Runs a share, or goes on with it; gives its file."""
    stem = pathlib.Path(scene).stem
    words = [program, "run", scene, "--shard", f"{number}/{shards}", "--resume"]
    words += ["--choices", f"results/{stem}.choices.toml", "--threads", "1", "--portion", "16"]
    for _ in range(600):
        done = subprocess.run(words, capture_output=True, text=True)
        # The program of a worker that died may still be at it.
        if "another run is writing" not in done.stderr:
            break
        time.sleep(0.5)
    done.check_returncode()
    return f"results/{stem}.{number}-of-{shards}.h5"


def merged(program, files, told):
    """Puts the shares together and says so; what differs from the whole, or 0."""
    subprocess.run([program, "merge", *files, "-q", "--no-audit", "-o", "merged.h5"], check=True)
    print(told)
    wrong = differing("whole.h5", "merged.h5")
    return f"the merged file differs: {wrong}" if wrong else 0


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as name:
        os.chdir(name)
        pathlib.Path("tap.toml").write_text(SCENE.replace("POINTS", "16"))
        subprocess.run([program, "run", "tap.toml", "-q", "--no-audit", "-o", "whole.h5"], check=True)
        subprocess.run([program, "prepare", "tap.toml", "-q", "--portion", "16"], check=True)
        began = time.monotonic()
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            numbers = list(range(1, SHARDS + 1))
            shares = client.map(lambda k: run_share(program, "tap.toml", k, SHARDS), numbers, retries=2, pure=False)
            pids = client.run(os.getpid)
            threading.Timer(1.0, os.kill, (next(iter(pids.values())), 9)).start()
            files = client.gather(shares)
        return merged(program, files, f"{SHARDS} shares, a worker killed: {time.monotonic() - began:.1f} s")


if __name__ == "__main__":
    sys.exit(main())

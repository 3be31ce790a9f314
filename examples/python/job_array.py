"""A job of a Slurm array: its slice of a table of samples, run into a file of its own.

    sbatch --array=1-8 --cpus-per-task=4 --wrap "python job_array.py run rows.npz results"
    python job_array.py gather results all.nc

A job that is run again goes on where it was killed. Rows drawn by index need no other row: the slices are one study.
Shares of one scene's own sweep are rather made with `afmsweep slurm`.
"""

import os
import sys
from pathlib import Path

import afmsweep as afm
import numpy as np
import xarray as xr
from lever import SCENE


def run(table, folder):
    number, jobs = int(os.environ["SLURM_ARRAY_TASK_ID"]), int(os.environ["SLURM_ARRAY_TASK_COUNT"])
    threads = int(os.environ.get("SLURM_CPUS_PER_TASK", 1))
    rows = np.load(table)
    mine = {path: rows[path][number - 1 :: jobs] for path in rows.files}
    Path(folder).mkdir(exist_ok=True)
    data = afm.run(SCENE, samples=mine, threads=threads, output=Path(folder, f"{number}-of-{jobs}.h5"), resume=True)
    print(f"job {number} of {jobs}: {data.status.size} rows")


def gather(folder, output):
    files = sorted(Path(folder).glob("*-of-*.h5"), key=lambda file: int(file.name.split("-")[0]))
    slices = [afm.open(file) for file in files]
    # Row n of the table is in slice n % jobs.
    slices = [one.assign_coords(instance=np.arange(n, len(files) * one.sizes["instance"] + n, len(files))) for n, one in enumerate(slices)]
    data = xr.concat(slices, "instance", combine_attrs="drop_conflicts").sortby("instance")
    data.to_netcdf(output, engine="h5netcdf")
    print(f"{data.sizes['instance']} rows in {output}")


if __name__ == "__main__":
    {"run": run, "gather": gather}[sys.argv[1]](*sys.argv[2:])

"""A sweep in shares by Dask, on this machine or any cluster whose machines see one folder. Needs dask.distributed."""

import sys
import tempfile

from afmsweep.dask import merge, prepare, run_shard
from dask.distributed import Client
from lever import SCENE

SWEEP = SCENE.set({"sweep": {
    "approach.gap": {"from": "10 nm", "to": "19 nm", "points": 40},
    "sample.youngs_modulus": {"from": "1 GPa", "to": "10 GPa", "points": 40, "scale": "log"},
}})


def main(folder, shards=4, **cluster):
    with Client(**cluster) as client:
        place = prepare(SWEEP, folder, portion=200)
        work = client.map(lambda k: run_shard(k, shards, place), range(1, shards + 1), retries=2, pure=False)
        data = merge(client.gather(work), f"{folder}/merged.h5")
    print(f"{data.status.size} instances of {shards} shares, {int((data.status == 0).sum())} ok")
    return data


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        main(*(sys.argv[1:2] or [folder]), n_workers=2, threads_per_worker=1, dashboard_address=None)

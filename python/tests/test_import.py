"""Import and neighbours in one process."""

import itertools
import subprocess
import sys

import pytest
from conftest import LEVER


def alone(code, *arguments):
    done = subprocess.run([sys.executable, "-c", code, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_import_brings_neither_numpy_nor_xarray():
    code = "import time; t = time.perf_counter()\nimport afmsweep, sys\nprint(time.perf_counter() - t)\n"
    told = alone(code + "print([one for one in ('numpy', 'xarray', 'pandas') if one in sys.modules])")
    assert told.splitlines()[1] == "[]"
    print(told.splitlines()[0], "s")


@pytest.mark.parametrize("order", list(itertools.permutations(["h5py", "netCDF4", "afmsweep"])))
def test_three_hdf5_libraries_live_beside_each_other(order, tmp_path):
    code = f"""
import sys, warnings
{chr(10).join(f"import {name}" for name in order)}
import xarray
warnings.simplefilter("ignore")
file = sys.argv[1]
data = afmsweep.run({LEVER!r}, output=file, audit=0)
for engine in ("h5netcdf", "netcdf4"):
    with xarray.open_dataset(file, engine=engine) as theirs:
        assert float(theirs.amplitude) == float(data.amplitude)
    data.drop_vars("instance").to_netcdf(file + engine, engine=engine)
    with xarray.open_dataset(file + engine, engine="h5netcdf" if engine == "netcdf4" else "netcdf4") as theirs:
        assert float(theirs.amplitude) == float(data.amplitude)
with h5py.File(file) as theirs:
    assert theirs["amplitude"][()] == float(data.amplitude)
assert float(afmsweep.open(file).amplitude) == float(data.amplitude)
try:
    afmsweep.open(file + "h5netcdf")
except ValueError as refused:
    print(refused)
"""
    assert "file" in alone(code, tmp_path / "results.h5")


def test_the_command_comes_along(command, tmp_path):
    assert command("--version").stdout.startswith("afmsweep ")
    assert command("run", tmp_path / "none.toml", check=False).returncode == 1
    assert command("walk", check=False).returncode == 2

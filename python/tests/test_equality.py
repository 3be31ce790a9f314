"""What runs give is what xarray reads of the command's file: values to the bit, kinds, labels, order.

The truth is another path: the command in a process of its own, its HDF5 file, and two other readers of that.
"""

import afmsweep as afm
import numpy as np
import pytest
import xarray as xr
from conftest import LEVER

# They tell of the call, or sum up others that do.
OF_THE_CALL = {"history", "command_line", "wall_time_seconds", "instance_steps_per_second", "checksums"}
# Named in a list, its rows are in a file for the one and in arrays for the other.
OF_THE_ROWS = {"scene", "scene_resolved"}

GRID = {
    "sweep": {
        "sample.youngs_modulus": {"values": ["1 GPa", "2 GPa"]},
        "approach.gap": {"from": 12e-9, "to": 18e-9, "points": 4},
    }
}
SCENES = {
    "one": {},
    "grid": {**GRID, "output.observables": ["amplitude", "phase", "harmonic_amplitude", "dissipation", "virial"]},
    "labels": {
        "sweep": {
            "material": {"label": ["PS", "PMMA"], "sample.youngs_modulus": [2e9, 2.7e9]},
            "contact.law": {"values": ["hertz", "dmt"]},
        }
    },
    "list": {"samples": {"sample.youngs_modulus": [1e9, 2e9, 3e9], "instrument.tip.radius": ["5 nm", "8 nm", "9 nm"]}},
    "design": {
        "uncertain": {
            "sample.youngs_modulus": afm.uniform("1 GPa", "3 GPa"),
            "instrument.tip.radius": afm.normal("9 nm", "10 %"),
        },
        "design": {"kind": "saltelli", "samples": 4},
    },
    "curve": {"curve": {"quantity": "approach.gap", "from": "22 nm", "to": "14 nm", "points": 9, "direction": "both"}},
    "set-point": {"approach": {"setpoint": 0.8}, "sweep": {"sample.youngs_modulus": {"values": [1e9, 3e9]}}},
    "branches": {"run.branches": "both", **GRID},
    "waveforms": {
        **GRID,
        "output.waveforms": {"instances": [0, 3], "samples_per_period": 16, "periods": 1},
        "output.spectra": {"instances": [1]},
    },
}


def apart(ours, theirs, passed_over=OF_THE_CALL):
    """How two data sets differ, in words."""
    found = []
    for what in ("dims", "variables", "attrs"):
        if list(getattr(ours, what)) != list(getattr(theirs, what)):
            found.append(f"{what}: {list(getattr(ours, what))} {list(getattr(theirs, what))}")
    if set(ours.coords) != set(theirs.coords):
        found.append(f"coordinates: {set(ours.coords) ^ set(theirs.coords)}")
    for name in set(ours.variables) & set(theirs.variables):
        a, b = ours.variables[name], theirs.variables[name]
        alike = a.dtype == b.dtype and a.dims == b.dims and a.shape == b.shape
        same = alike and (
            a.values.tobytes() == b.values.tobytes() if a.dtype.kind != "O" else list(a.values) == list(b.values)
        )
        if not same or a.encoding.get("coordinates") != b.encoding.get("coordinates"):
            found.append(f"{name}: {a.dtype} {b.dtype} {a.dims} {b.dims}")
        found += [f"{name}.{one}" for one in labels_apart(a.attrs, b.attrs)]
    return found + [one for one in labels_apart(ours.attrs, theirs.attrs) if one not in passed_over]


def labels_apart(a, b):
    def same(x, y):
        return type(x) is type(y) and np.array_equal(x, y, equal_nan=np.asarray(x).dtype.kind == "f")

    return [name for name in {**a, **b} if name not in a or name not in b or not same(a[name], b[name])]


@pytest.mark.parametrize("name", SCENES)
def test_a_run_is_what_the_commands_file_is(name, tmp_path, command):
    scene = afm.Scene(LEVER).set(SCENES[name])
    scene = scene.set({"title": name})
    file, results = tmp_path / "scene.toml", tmp_path / "scene.h5"
    file.write_text(scene.text, encoding="utf-8")
    command("run", file, "-q", "-o", results, "--audit", "2", "--precision", "f64")
    ours = afm.run_tree(file, audit=2, precision="f64")
    data = afm.run(file, audit=2, precision="f64")
    for engine in ("h5netcdf", "netcdf4"):
        with xr.open_dataset(results, engine=engine) as theirs:
            assert apart(data, theirs.load()) == []
        with xr.open_datatree(results, engine=engine) as theirs:
            assert list(ours.groups) == list(theirs.groups)
            for group in theirs.groups:
                inner = theirs[group].to_dataset(inherit=False).load()
                assert apart(ours[group].to_dataset(inherit=False), inner) == [], group
    # A file that is read back is all there, call and all.
    with xr.open_dataset(results, engine="netcdf4") as theirs:
        assert apart(afm.open(results), theirs.load(), passed_over=()) == []


def test_runs_into_files_are_the_commands(tmp_path, scene):
    results = tmp_path / "ours.h5"
    data = afm.run(scene, output=results, audit=0)
    with xr.open_dataset(results) as theirs:
        assert apart(data, theirs.load(), passed_over=()) == []
    assert apart(afm.run(scene, output=results, resume=True), data, passed_over=()) == []
    with pytest.raises(FileExistsError, match="another scene"):
        afm.run(scene.set({"approach.gap": 16e-9}), output=results)


@pytest.mark.parametrize("beside", [{}, GRID])
def test_arrays_are_lists_of_samples(beside, scene):
    rng = np.random.default_rng(1)
    arrays = {
        "sample.surface_energy": rng.uniform(0.01, 0.05, 20),
        "instrument.tip.radius": rng.uniform(5e-9, 9e-9, 20),
    }
    scene = scene.set(beside)
    given = afm.run(scene, samples=arrays, audit=0, precision="f64")
    listed = afm.run(scene.set({"samples": arrays}), audit=0, precision="f64")
    assert given.sizes["sample" if beside else "instance"] == 20
    assert apart(given, listed) == []
    # As text a number has its unit, and is the same number.
    assert np.array_equal(given.tip_radius, arrays["instrument.tip.radius"])


def test_the_journal_of_an_unfinished_run_opens(tmp_path):
    from conftest import LONG

    results = tmp_path / "long.h5"

    def stop(name, share):
        if share and share > 0.3 and name.startswith("run"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        afm.run(LONG, output=results, progress=stop)
    assert not results.exists()
    data = afm.open(f"{results}.partial")
    done = int((data.status != 5).sum())
    assert 0 < done < data.status.size and data.attrs["complete"] == 0.0
    assert int((stopped.value.partial.status != 5).sum()) == done

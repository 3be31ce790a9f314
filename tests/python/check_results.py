"""Opens results files as Python's users do and checks their labels.

    python check_results.py FILE...

Every reader must see the same names, dimensions, units and numbers: h5py and h5dump (the file as HDF5),
netCDF4, and xarray with both engines. Works on any results file of afmsweep; whatever a file has is
checked, and the exit code is 0 only if all of it holds.
"""

import re
import shutil
import subprocess
import sys

import h5py
import netCDF4
import numpy as np
import xarray as xr

UNITS = {
    "amplitude": "m",
    "phase": "degree",
    "force_max": "N",
    "force_min": "N",
    "force_mean": "N",
    "indentation_max": "m",
    "contact_time": "1",
    "dissipation": "J",
    "virial": "J",
    "contacts": "1",
    "harmonic_amplitude": "m",
    "deflection_amplitude": "m",
    "deflection_phase": "degree",
    "deflection_mean": "m",
    "free_phase": "degree",
    "frequency_shift": "Hz",
    "tip_travel": "m",
    "actuator_top": "m",
    "indentation": "m",
    "force": "N",
    "contact_radius": "m",
    "time": "s",
    "frequency": "Hz",
    "tip_amplitude": "m",
    "tip_phase": "degree",
    "force_amplitude": "N",
    "force_phase": "degree",
}
MEANINGS = ["ok", "not_steady", "sensitive", "non_finite", "out_of_range", "not_run", "accuracy_not_met", "no_setpoint"]
GROUPS = ["waveforms", "spectra", "force_curves", "audit", "other_branch", "provenance"]
ENGINES = ["h5netcdf", "netcdf4"]


def same(a, b):
    a, b = np.asarray(a), np.asarray(b)
    return a.shape == b.shape and np.array_equal(a, b, equal_nan=a.dtype.kind == "f" and b.dtype.kind == "f")


def check_flags(variable, words):
    """CF: values of the variable's own type, one blank-separated meaning for each."""
    values = np.atleast_1d(variable.attrs["flag_values"])
    meanings = variable.attrs["flag_meanings"].split(" ")
    assert values.dtype == variable.dtype == np.uint8, (values.dtype, variable.dtype)
    assert len(values) == len(meanings) == len(set(meanings)), (values, meanings)
    assert meanings[: len(words)] == words, meanings
    assert np.isin(variable.values, values).all(), variable


def check_masks(variable):
    """CF: one bit each, of the variable's own type; no bit without a meaning."""
    masks = np.atleast_1d(variable.attrs["flag_masks"])
    meanings = variable.attrs["flag_meanings"].split(" ")
    assert masks.dtype == variable.dtype == np.uint8, (masks.dtype, variable.dtype)
    assert len(masks) == len(meanings) == len(set(meanings)), (masks, meanings)
    assert same(masks, 2 ** np.arange(len(masks))), masks
    assert (variable.values < 2 ** len(masks)).all(), variable


def check_variable(name, variable):
    assert isinstance(variable.attrs.get("long_name"), str) and variable.attrs["long_name"], name
    if "flag_masks" in variable.attrs:
        check_masks(variable)
    if "flag_masks" in variable.attrs or "flag_values" in variable.attrs:
        return
    if variable.dtype.kind in "iuOTU":  # counts and names
        return
    units = variable.attrs.get("units")
    assert isinstance(units, str) and units, f"{name} has no units"
    assert UNITS.get(name, units) == units, (name, units)


def check_root(data):
    for name in ["title", "Conventions", "history"]:
        assert isinstance(data.attrs[name], str), (name, type(data.attrs[name]))
    assert data.attrs["Conventions"].startswith("CF-1."), data.attrs["Conventions"]
    for name, value in data.attrs.items():
        assert isinstance(value, (str, float, np.floating)), (name, type(value))
    check_flags(data["status"], MEANINGS)
    assert data["steps_per_period"].dtype == np.uint32
    dims = data["status"].dims
    assert data["steps_per_period"].dims == dims
    assert same(data["instance"], np.arange(data["status"].size).reshape(data["status"].shape))
    if "instance" in dims:
        assert dims == ("instance",)
        for name in set(data.coords) - {"instance", "harmonic"}:
            assert data[name].dims == ("instance",), name
    else:
        for name in dims:
            assert data[name].dims == (name,), name
            named = "flag_values" in data[name].attrs or data[name].dtype.kind in "OTU"
            assert named or data[name].dtype == np.float64, name
    for name, variable in data.variables.items():
        check_variable(name, variable)
    for name, variable in data.data_vars.items():
        if "flag_values" in variable.attrs or "flag_masks" in variable.attrs:
            assert variable.dims == dims, (name, variable.dims)
            continue
        if name in ("steps_per_period", "instance"):
            continue
        if name in UNITS:
            assert variable.attrs["error_scale"], name
            assert all(word in data for word in variable.attrs["ancillary_variables"].split()), name
        assert variable.dtype == np.float64, (name, variable.dtype)
        assert variable.dims in (dims, dims + ("harmonic",)), (name, variable.dims)
    if "harmonic" in data.dims:
        assert same(data["harmonic"], np.arange(1, data.sizes["harmonic"] + 1))
        assert data["harmonic_amplitude"].dims == dims + ("harmonic",)


def check_branch(data, root):
    """Second states: the dimensions and coordinates of the first, NaN where there is none."""
    dims = root["status"].dims
    for name in set(root.coords) - {"harmonic"}:
        assert data[name].dims == root[name].dims and same(data[name], root[name]), name
    check_flags(data["status"], MEANINGS + ["no_second_state"])
    none = data["status"].values == 255
    assert data["steps_per_period"].dtype == np.uint32
    for name, variable in data.data_vars.items():
        assert variable.dims in (dims, dims + ("harmonic",)), (name, variable.dims)
        if variable.dtype == np.float64 and variable.dims == dims:
            assert np.isnan(variable.values[none]).all(), name


def check_group(name, data, root):
    instances = root["status"].size
    for key, variable in data.variables.items():
        check_variable(key, variable)
    if name == "other_branch":
        return check_branch(data, root)
    if name == "provenance":
        return None
    assert ((data["instance"] >= 0) & (data["instance"] < instances)).all()
    if name == "waveforms":
        shared = "time" in data.dims
        dims = ("waveform", "time" if shared else "sample")
        assert data["instance"].dims == ("waveform",)
        assert data["time"].dims == (("time",) if shared else dims)
        for key in ["tip_travel", "actuator_top", "indentation", "force"]:
            assert data[key].dims == dims and data[key].dtype == np.float64, key
        assert (np.diff(data["time"].values) > 0).all(), "time runs backwards"
        assert "sample" in data.dims or "time" in data.coords
    elif name == "spectra":
        assert data["instance"].dims == ("spectrum",)
        assert same(data["order"], np.arange(1, data.sizes["order"] + 1))
        first = data["frequency"].values[:, :1]
        assert np.allclose(data["frequency"], first * data["order"].values, rtol=1e-12)
        for key in ["tip", "deflection", "force"]:
            size, lag = data[f"{key}_amplitude"], data[f"{key}_phase"]
            assert size.dims == lag.dims == ("spectrum", "order") and size.dtype == np.float64, key
            assert not (size < 0).any() and not (lag < 0).any() and not (lag >= 360).any(), key
            assert same(np.isnan(lag), np.isnan(size) | (size == 0)), key
    elif name == "force_curves":
        check_flags(data["law"], ["none", "hertz", "dmt", "jkr", "hertz-viscous", "dmt-viscous", "hertz-relaxing", "hertz-shaped", "dmt-shaped", "sum", "sum-hysteretic", "sum-jkr", "sum-viscous", "sum-relaxing"])
        check_flags(data["branch"], ["approach", "retract"])
        assert data["instance"].dims == data["points"].dims == ("curve",)
        for key in ["indentation", "force", "contact_radius"]:
            assert data[key].dims == ("curve", "point") and data[key].dtype == np.float64, key
    else:
        assert data["instance"].dims == ("audited",)
        check_flags(data["reference_status"], ["ok"])
        assert data["error"].dims == ("audited", "observable"), data["error"].dims
        assert all(name in data for name in data["observable"].values), data["observable"]


def check_h5py(path, data, group):
    """The same numbers, dimension labels and text without any netCDF library."""
    with h5py.File(path) as file:
        at = file[group] if group else file
        for name, variable in data.variables.items():
            dataset = at[name]
            assert dataset.shape == variable.shape, (name, dataset.shape, variable.shape)
            text = h5py.check_string_dtype(dataset.dtype) is not None
            assert same(dataset.asstr()[()] if text else dataset[()], variable.values), name
            assert isinstance(dataset.attrs["long_name"], str), name
            assert dataset.attrs["long_name"] == variable.attrs["long_name"], name
            if variable.dims == (name,):
                assert dataset.is_scale, name
                continue
            for dim, label in zip(dataset.dims, variable.dims, strict=True):
                assert len(dim) == 1 and dim[0].name.rsplit("/", 1)[-1] == label, (name, label)
        if not group:
            assert {k for k in file.attrs} - {"_NCProperties"} == set(data.attrs)
            for name, value in data.attrs.items():
                assert same(file.attrs[name], value), name


def check_netcdf4(path, data, group):
    with netCDF4.Dataset(path) as file:
        at = file[group] if group else file
        at.set_auto_mask(False)
        assert set(at.variables) == set(data.variables), set(at.variables) ^ set(data.variables)
        for name, variable in at.variables.items():
            assert variable.dimensions == data[name].dims, (name, variable.dimensions)
            assert same(variable[...], data[name].values), name
            assert isinstance(variable.long_name, str), name
        assert {k: len(v) for k, v in at.dimensions.items()} == dict(data.sizes) or group == "force_curves"
        if not group:
            for name, value in data.attrs.items():
                assert same(getattr(file, name), value), name


def check_tree(path):
    """All groups at once: none has a dimension of the root's name and another length."""
    for engine in ENGINES:
        with xr.open_datatree(path, engine=engine) as tree:
            assert set(tree.children) == set(GROUPS), list(tree.children)
            # What a notebook shows; a group's coordinate of a root's dimension's name would be refused here.
            assert "waveforms" in tree._repr_html_()


def check_h5dump(path):
    if shutil.which("h5dump") is None:
        print("  h5dump: SKIPPED, not installed")
        return
    head = subprocess.run(["h5dump", "-A", path], capture_output=True, text=True)
    assert head.returncode == 0 and not head.stderr, head.stderr
    for name in ["DIMENSION_SCALE", "status", "flag_meanings", "units"]:
        if name == "DIMENSION_SCALE" and not re.search(r"DIMENSION_LIST", head.stdout):
            continue
        assert name in head.stdout, name


def check_append(path):
    """A user adds a variable of their own with netCDF4; that needs the creation order tracked."""
    import os
    import tempfile

    if os.path.getsize(path) > 64 << 20:
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, "copy.h5")
        shutil.copyfile(path, copy)
        with netCDF4.Dataset(copy, "a") as file:
            dims = file["status"].dimensions
            file.createVariable("mine", "f8", dims)[...] = 1.0
            file["mine"].units = "1"
        with xr.open_dataset(copy, engine="h5netcdf") as data:
            assert data["mine"].dims == dims and float(data["mine"].mean()) == 1.0


def check(path):
    with h5py.File(path) as file:
        found = {name for name in file if isinstance(file[name], h5py.Group)}
        assert found == set(GROUPS), found
        groups = [name for name in GROUPS if len(file[name])]
        for name in set(GROUPS) - set(groups) - {"provenance"}:
            assert not file[name].attrs, name
        for name in ["scene", "hdf5_version"]:
            assert isinstance(file["provenance"].attrs[name], str), name
        assert max(len(str(value)) for value in file.attrs.values()) < 4000, "a long text at the root"
    seen = {}
    for engine in ENGINES:
        with xr.open_dataset(path, engine=engine) as data:
            data.load()
            check_root(data)
            seen.setdefault("", []).append(data)
        for group in groups:
            with xr.open_dataset(path, engine=engine, group=group) as data:
                data.load()
                check_group(group, data, seen[""][0])
                seen.setdefault(group, []).append(data)
    for group, (first, second) in seen.items():
        xr.testing.assert_identical(first, second)
        check_h5py(path, first, group)
        check_netcdf4(path, first, group)
    check_tree(path)
    check_h5dump(path)
    check_append(path)
    data = seen[""][0]
    counts = np.bincount(data["status"].values.ravel(), minlength=len(MEANINGS))
    print(f"{path}: dimensions {dict(data.sizes)}, groups {groups}, status {dict(zip(MEANINGS, counts.tolist()))}")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for name in sys.argv[1:]:
        check(name)

"""Results as xarray's, and studies of these back as what statistics take."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

Groups = list[tuple[str, dict[str, Any], list[tuple[Any, ...]]]]


def _attributes(told: dict[str, Any]) -> dict[str, Any]:
    import numpy as np

    def one(value: Any) -> Any:
        if isinstance(value, bytes):
            return np.frombuffer(value, "u1").copy()
        return np.float64(value) if isinstance(value, float) else value

    return {name: one(value) for name, value in told.items()}


def _group(attributes: dict[str, Any], arrays: list[tuple[Any, ...]]) -> xr.Dataset:
    """A group: its dimensions are coordinates, and so is what variables name as theirs."""
    import numpy as np
    import xarray as xr

    variables, coordinates = {}, set()
    for name, is_dimension, dims, shape, told, kind, values in arrays:
        if kind == "O":
            # As readers of files have them: words of a dimension have a length.
            data = np.array(values, dtype=None if is_dimension else object)
        else:
            data = np.frombuffer(values, kind)
        labels = _attributes(told)
        encoding = {}
        if (beside := labels.pop("coordinates", None)) is not None:
            encoding["coordinates"] = beside
            coordinates |= set(beside.split())
        variables[name] = xr.Variable(dims, data.reshape(shape), labels, encoding, fastpath=True)
        if is_dimension:
            coordinates.add(name)
    own = {name: one for name, one in variables.items() if name not in coordinates}
    beside_them = {name: one for name, one in variables.items() if name in coordinates}
    return xr.Dataset(own, beside_them, _attributes(attributes))


def root(groups: Groups) -> xr.Dataset:
    """The results over all instances."""
    _, attributes, arrays = groups[0]
    return _group(attributes, arrays)


def tree(groups: Groups) -> xr.DataTree:
    """All groups."""
    import xarray as xr

    return xr.DataTree.from_dict({f"/{name}": _group(attributes, arrays) for name, attributes, arrays in groups})


def _text(data: xr.Variable | xr.DataArray, name: str) -> str:
    return str(data.attrs.get(name, ""))


def _axis(data: xr.Dataset, name: str) -> dict[str, Any]:
    """A coordinate, and the quantities that vary along it."""
    import numpy as np

    one = data[name]
    if "flag_meanings" in one.attrs:
        words = _text(one, "flag_meanings").split()
    else:
        words = [str(word) for word in one.values] if one.dtype.kind in "OUST" else []
    values = np.arange(one.size, dtype="f8") if words else np.ascontiguousarray(one.values, "f8")
    columns = [column for column in _text(one, "quantities").split() if column in data]
    told = {key: _text(one, key) for key in ("units", "long_name", "scene_path")}
    return {
        "name": name,
        **told,
        "words": words,
        "values": values,
        "columns": [_axis(data, column) for column in columns],
    }


def study(data: xr.Dataset, names: Sequence[str]) -> dict[str, Any]:
    """What statistics of these observables need of a data set."""
    import numpy as np

    if "status" not in data:
        raise ValueError("the data set has no variable status: give one as afmsweep.run returns it")
    dims = [str(dim) for dim in data.status.dims]
    is_list = dims == ["instance"]
    axes = str(data.status.encoding.get("coordinates", "")).split() if is_list else dims
    if is_list and not axes:
        axes = [str(name) for name, one in data.coords.items() if one.dims == ("instance",) and name != "instance"]
    variables = []
    for name in dict.fromkeys([*names, *(["error_estimate"] if "error_estimate" in data else [])]):
        one = data[name].transpose(*dims, ...)
        told = {key: _text(one, key) for key in ("units", "long_name", "error_scale")}
        harmonics = one.sizes.get("harmonic") if "harmonic" in one.dims else None
        variables.append(
            {"name": name, **told, "harmonics": harmonics, "values": np.ascontiguousarray(one.values, "f8").ravel()}
        )
    codes = {
        name: np.ascontiguousarray(data[name].transpose(*dims).values, "u1").ravel()
        for name in ("status", "jump", "branch")
        if name in data
    }
    return {
        "title": str(data.attrs.get("title", "")),
        "list": is_list,
        "design": data.attrs.get("design"),
        "axes": [_axis(data, name) for name in axes],
        "variables": variables,
        "status": codes.pop("status"),
        "flags": list(codes.items()),
    }

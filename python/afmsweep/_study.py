"""Statistics of studies, inference and pages: by the code of the commands ``stats``, ``infer`` and ``report``."""

from __future__ import annotations

import json
import os
import tempfile
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _afmsweep, _dataset
from ._run import SceneWarning

if TYPE_CHECKING:
    import xarray as xr


def _checked(data: xr.Dataset, name: str) -> str:
    """The variable of an observable; one harmonic may be named."""
    head, _, number = name.rpartition("_")
    found = name if name in data else head if number.isdigit() and head in data else None
    if found is None:
        known = [str(one) for one in data.data_vars if "error_scale" in data[one].attrs]
        meant = _afmsweep.nearest(name, known)
        raise KeyError(f"no observable {name!r}; " + (f"did you mean {meant!r}?" if meant else f"there are {', '.join(known)}"))
    return found


def _answer(data: xr.Dataset, name: str, left_out: float, keep: Iterable[str]) -> dict[str, Any]:
    told = _dataset.study(data, [_checked(data, name)])
    answer = json.loads(_afmsweep.stats(told, [name], float(left_out), list(keep)))
    points = answer.get("points", [answer])
    for doubt in dict.fromkeys(point["observables"][name].get("S1_doubt") for point in points):
        if doubt:
            warnings.warn(f"{name}: {doubt}", SceneWarning, stacklevel=3)
    return answer


def stats(
    data: xr.Dataset, name: str, *, left_out: float = 0.05, keep: Iterable[str] = ()
) -> dict[str, Any] | list[dict[str, Any]]:
    """How an observable of a study is distributed, as the command ``stats --json`` tells it.

    ``count``, ``left_out`` by status, ``mean``, ``sd`` and ``quantiles`` with intervals of 95 %, in the observable's unit;
    of a design for it the indices too. With a sweep beside the samples there is one for each point, with its place ``at``.

    ``left_out``: the largest share of rows that may have failed. ``keep``: statuses that count beside ok.
    """
    answer = _answer(data, name, left_out, keep)
    if "observables" in answer:
        return answer["observables"][name]
    return [{"at": point["at"], **point["observables"][name]} for point in answer["points"]]


def sobol(data: xr.Dataset, name: str, *, left_out: float = 0.05, keep: Iterable[str] = ()) -> xr.Dataset:
    """Sensitivity indices of an observable over ``parameter``, shares without unit.

    ``S1`` with the half width ``S1_conf`` of its 95 % interval; ``ST`` and ``ST_conf`` of a saltelli design, ``S2`` over
    ``parameter`` and ``parameter_2`` where it was asked for; ``mu``, ``mu_star`` and ``sigma`` of a morris design, in the
    observable's unit. With a sweep beside the samples its dimensions come first.
    """
    import numpy as np
    import xarray as xr

    answer = _answer(data, name, left_out, keep)
    points = (
        [answer["observables"][name]] if "observables" in answer else [p["observables"][name] for p in answer["points"]]
    )
    places = [] if "observables" in answer else [str(dim) for dim in data.status.dims if dim != "sample"]
    shape = [data.sizes[dim] for dim in places]
    found = {}
    for key in ("S1", "S1_conf", "ST", "ST_conf", "S2", "S2_conf", "mu", "mu_star", "mu_star_conf", "sigma"):
        if key in points[0]:
            values = np.array([point[key] for point in points], dtype=float)
            dims = [*places, "parameter", *(["parameter_2"] if values.ndim == 3 else [])]
            found[key] = (dims, values.reshape([*shape, *values.shape[1:]]))
    coordinates = {dim: data[dim] for dim in places if dim in data.coords}
    names = {"parameter": answer["names"], **({"parameter_2": answer["names"]} if "S2" in found else {})}
    return xr.Dataset(found, {**coordinates, **names}, {"observable": name})


def infer(
    data: xr.Dataset,
    observed: Mapping[str, Any] | str | os.PathLike[str],
    *,
    at: Mapping[str, float | str] | None = None,
    sd: Mapping[str, str] | None = None,
    direction: str | None = None,
    offset: str | None = None,
    scale: str | None = None,
    left_out: float = 0.05,
    keep: Iterable[str] = (),
) -> dict[str, Any] | list[dict[str, Any]]:
    """What was observed tells of the parameters of a study, as the command ``infer --json`` tells it.

    ``observed``: ``{name: (value, sd)}`` in the units of the data set or with units (``"14.2 nm"``); or a measured curve,
    the path of a CSV file (``gap [nm], amplitude [nm], amplitude_sd [nm]``), or a dictionary of such columns with arrays.
    ``at``: a point of the sweep, by path. ``sd``, ``direction``, ``offset`` (``approach.gap``) and ``scale`` go with a curve.

    ``parameters``: of each ``mean``, ``sd`` and ``quantiles``; ``correlation``, ``effective_samples``, ``predicted``.
    """
    from . import _toml

    unit = {str(name): str(one.attrs.get("units", "")) for name, one in data.variables.items()}
    with tempfile.TemporaryDirectory() as folder:
        words = []
        if isinstance(observed, Mapping) and all(isinstance(one, tuple) for one in observed.values()):
            for name, (value, spread) in observed.items():
                known = unit[_checked(data, name)]
                words += ["--observed", f"{name}={_with(value, known)} +- {_with(spread, known)}"]
        else:
            curve = _sheet(observed, Path(folder, "curve.csv")) if isinstance(observed, Mapping) else Path(observed)
            words += ["--observed", os.fspath(curve)]
        for path, value in (at or {}).items():
            words += ["--at", f"{path}={_with(value, _toml.unit_of(path))}"]
        for name, value in (sd or {}).items():
            words += ["--sd", f"{name}={value}"]
        for option, value in (("direction", direction), ("offset", offset), ("scale", scale)):
            words += [] if value is None else [f"--{option}", value]
        words += ["--left-out", repr(100 * left_out), *(word for status in keep for word in ("--keep", status))]
        names = [str(name) for name, one in data.data_vars.items() if "error_scale" in one.attrs]
        points, doubts = json.loads(_afmsweep.infer(_dataset.study(data, names), words))
    for doubt in doubts:
        warnings.warn(doubt, SceneWarning, stacklevel=2)
    return points[0] if len(points) == 1 else points


def _with(value: Any, unit: str) -> str:
    """A value with its unit."""
    if isinstance(value, str):
        return value
    return f"{float(value)!r} {unit}" if unit not in ("", "1") else repr(float(value))


def _sheet(columns: Mapping[str, Any], path: Path) -> Path:
    """Writes the columns of a measured curve as a table."""
    import numpy as np

    rows = np.column_stack([np.asarray(values) for values in columns.values()])
    lines = [",".join(columns), *(",".join(repr(float(value)) for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def report(
    file: str | os.PathLike[str] | xr.Dataset | xr.DataTree,
    output: str | os.PathLike[str] | None = None,
    *,
    x: str | None = None,
    y: str | None = None,
    curves: str | None = None,
    at: Mapping[str, str] | None = None,
    below: Mapping[str, str] | None = None,
    above: Mapping[str, str] | None = None,
    branch: str | None = None,
) -> Path:
    """Writes a page with pictures (SVG) of a results file, and gives its path; as the command ``report``.

    ``file``: a results file, what `run_tree` gives (xarray then needs h5netcdf or netCDF4), or a data set that `run` wrote
    into a file (``output=``) or that `open` read. ``output``: the folder; needed where there is no file. ``x``, ``y``,
    ``curves``: paths of the axes to the right, upwards, and of curves in one picture. ``at``: an axis at one value;
    ``below`` and ``above``: limits of observables; values with units, such as ``"16 nm"``.
    """
    pairs = {key: list((told or {}).items()) for key, told in (("at", at), ("below", below), ("above", above))}
    view = {"x": x, "y": y, "curves": curves, "branch": branch, **pairs}
    with tempfile.TemporaryDirectory() as folder:
        path = _file_of(file, Path(folder), output is not None)
        return Path(_afmsweep.report(path, None if output is None else os.fspath(output), view))


def _file_of(results: str | os.PathLike[str] | xr.Dataset | xr.DataTree, folder: Path, has_output: bool) -> str:
    """The results file there is; of results in memory one written into the folder."""
    import xarray as xr

    if isinstance(results, (str, os.PathLike)):
        return os.fspath(results)
    source = results.encoding.get("source")
    if source is not None:
        return os.fspath(source)
    if not isinstance(results, xr.DataTree):
        raise ValueError(
            "the data set is of no results file, which a page is made of: take run_tree in place of run, "
            "or call run with output='results.h5'"
        )
    if not has_output:
        raise ValueError("these results are of no file: give output=, the folder of the page")
    whole = results.copy()
    # Sums of a file that the program writes: those of another writer's differ.
    whole.attrs.pop("checksums", None)
    whole.to_netcdf(folder / "results.h5")
    return str(folder / "results.h5")

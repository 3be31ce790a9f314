"""Runs of scenes."""

from __future__ import annotations

import contextlib
import logging
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from . import _afmsweep, _dataset, _toml
from ._scene import Scene, SceneLike, run_options

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from numpy.typing import ArrayLike

Progress = Callable[[str, float | None], Any]

_LOGGER = logging.getLogger("afmsweep")
_LEVELS = {"info": logging.INFO, "debug": logging.DEBUG}


class SceneWarning(UserWarning):
    """Something about a scene or its results that may not be what was meant."""


class _Bar:
    """A bar for each phase of a run that lasts."""

    def __init__(self) -> None:
        self.bar: Any = None
        self.name = ""

    def __call__(self, name: str, share: float | None) -> None:
        from tqdm.auto import tqdm

        if name != self.name:
            self.close()
            layout = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"
            self.bar, self.name = tqdm(total=1.0, desc=name, bar_format=layout, leave=False, delay=0.3), name
        self.bar.update(max(0.0, (share or 0.0) - self.bar.n))

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()


@contextlib.contextmanager
def _shown(progress: Progress | bool | None) -> Iterator[Progress | None]:
    """What is called with the progress: the caller's function, a bar where somebody looks, or nothing."""
    if callable(progress):
        yield progress
        return
    interactive = "ipykernel" in sys.modules or (sys.stderr is not None and sys.stderr.isatty())
    if progress is False or not (progress or interactive) or not _has_tqdm():
        yield None
        return
    bar = _Bar()
    try:
        yield bar
    finally:
        bar.close()


def _silence_device_select() -> None:
    """Mesa's layer that sorts GPUs by their displays complains where there is no display; nothing here draws."""
    if not any(name in os.environ for name in ("XDG_RUNTIME_DIR", "NODEVICE_SELECT", "MESA_VK_DEVICE_SELECT")):
        os.environ["NODEVICE_SELECT"] = "1"


def _numbers(path: str, values: ArrayLike) -> np.ndarray:
    """The samples of a quantity as one row of numbers."""
    import numpy as np

    told = np.asarray(values)
    if told.ndim != 1:
        raise ValueError(
            f"samples[{path!r}] has the shape {told.shape}: expected one dimension. Flatten it; what does not vary "
            "belongs in the scene, a grid in its sweep"
        )
    if told.dtype.kind in "USO":
        raise TypeError(f"samples[{path!r}]: expected numbers in SI units, angles in degrees, such as 8e-9 in place of '8 nm'")
    return np.ascontiguousarray(told, "f8")


def _has_tqdm() -> bool:
    import importlib.util

    return importlib.util.find_spec("tqdm") is not None


def _groups(
    scene: SceneLike,
    samples: Mapping[str, ArrayLike] | None,
    options: dict[str, Any],
    progress: Progress | bool | None,
    make: Callable[[_dataset.Groups], Any],
) -> Any:
    """Runs a scene, and makes something of what results hold, also of what an interrupted run has done."""
    if options["resume"] and options["output"] is None:
        raise ValueError("resume=True needs output=, the results file whose journal the run goes on with")
    _silence_device_select()
    told = Scene(scene)
    for path in samples or {}:
        _toml.check(path)
    rows = [(path, _numbers(path, values)) for path, values in (samples or {}).items()]
    if options["output"] is not None:
        options["output"] = os.fspath(options["output"])
    doubts: dict[str, None] = {}
    with _shown(progress) as show:

        def report(kind: str, value: Any) -> None:
            if kind == "progress":
                if show is not None:
                    show(*value)
            elif kind == "warning":
                doubts[value] = None
            else:
                _LOGGER.log(_LEVELS[kind], "%s: %s", told.name, value)

        try:
            groups = _afmsweep.run(told.text, told.name, rows, options, report)
        except BaseException as stop:
            partial = getattr(stop, "partial", None)
            with contextlib.suppress(AttributeError):
                setattr(stop, "partial", make(partial) if isinstance(partial, list) else None)  # noqa: B010
            if isinstance(stop, KeyboardInterrupt) and not stop.args:
                stop.args = ("the run was stopped; its exception's `partial` has what is done by then, if there is something",)
            raise
    for doubt in doubts:
        warnings.warn(doubt, SceneWarning, stacklevel=3)
    made = make(groups)
    if options["output"] is not None:
        made.encoding["source"] = os.path.abspath(options["output"])
    return made


def run(
    scene: SceneLike,
    *,
    samples: Mapping[str, ArrayLike] | None = None,
    backend: str = "auto",
    precision: str | None = None,
    threads: int | None = None,
    audit: int | None = None,
    portion: int | None = None,
    progress: Progress | bool | None = None,
    output: str | os.PathLike[str] | None = None,
    resume: bool = False,
) -> xr.Dataset:
    """Runs a scene: a path, TOML text, a dictionary with the same keys, or a `Scene`.

    Gives what ``xarray.open_dataset`` gives of the results file of the command ``run``: observables in SI units over the
    swept axes, or over ``instance`` for samples. Of two steady states each instance has the one that its search met;
    ``branch`` tells which, and `run_tree` has the others in ``other_branch``.

    ``samples``: arrays of shape ``(n,)`` in SI units (angles in degrees) by the paths of their quantities, one instance for
    each place; with a sweep in the scene each of its points has every sample.
    ``backend``: auto, cpu, gpu or reference. ``precision``: f32 or f64; None tries both.
    ``threads``: None takes all cores. ``audit``: instances that the reference engine redoes; None
    redoes one, however long it takes, and more while time is left; 0 redoes none.
    ``portion``: instances that are run and kept together; None takes some ten seconds of work. No result depends on it.
    ``progress``: called with the name of the phase and its share from 0 to 1, or None; True and False show a bar or none.
    ``output``: a results file, whose journal ``resume=True`` goes on with.

    Raises `SceneError` where the scene cannot be run. An interrupted run raises KeyboardInterrupt; what is done by then is
    its attribute ``partial``, a Dataset or None; take what has ``status`` 0 of it.
    """
    options = {**run_options(backend, precision, threads, audit, output, resume), "portion": portion}
    return _groups(scene, samples, options, progress, _dataset.root)


def run_tree(
    scene: SceneLike,
    *,
    samples: Mapping[str, ArrayLike] | None = None,
    backend: str = "auto",
    precision: str | None = None,
    threads: int | None = None,
    audit: int | None = None,
    portion: int | None = None,
    progress: Progress | bool | None = None,
    output: str | os.PathLike[str] | None = None,
    resume: bool = False,
) -> xr.DataTree:
    """Runs a scene like `run`, and gives all groups: also waveforms, spectra, force curves, audit and second states."""
    options = {**run_options(backend, precision, threads, audit, output, resume), "portion": portion}
    return _groups(scene, samples, options, progress, _dataset.tree)


def open(file: str | os.PathLike[str]) -> xr.Dataset:
    """Reads a results file, or the journal of a run that is not whole (``FILE.partial``): ``status`` is then 5 where an
    instance was not run.

    The whole file is read and held against its checksums.
    """
    data = _dataset.root(_afmsweep.opened(os.fspath(file)))
    data.encoding["source"] = os.path.abspath(os.fspath(file))
    return data

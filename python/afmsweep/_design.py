"""Designs of uncertain quantities: which vary, how, and at which points a scene is simulated."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from . import _afmsweep, _toml

if TYPE_CHECKING:
    import numpy as np

Distribution = dict[str, Any]
Value = float | str


def _distribution(kind: str, **values: Any) -> Distribution:
    return {"distribution": kind, **{key: value for key, value in values.items() if value is not None}}


def normal(mean: Value, sd: Value, *, low: Value | None = None, high: Value | None = None) -> Distribution:
    """Normal; ``sd`` with a unit, in SI, or a share of the mean such as ``"10 %"``. ``low`` and ``high`` cut it.

    >>> normal("40 N/m", "10 %")
    {'distribution': 'normal', 'mean': '40 N/m', 'sd': '10 %'}
    """
    return _distribution("normal", mean=mean, sd=sd, **{"from": low, "to": high})


def lognormal(median: Value, sigma: float, *, low: Value | None = None, high: Value | None = None) -> Distribution:
    """Lognormal; ``sigma`` is of the natural logarithm, and has no unit."""
    return _distribution("lognormal", median=median, sigma=sigma, **{"from": low, "to": high})


def uniform(low: Value, high: Value) -> Distribution:
    """Equally likely between two values."""
    return _distribution("uniform", **{"from": low, "to": high})


def loguniform(low: Value, high: Value) -> Distribution:
    """The logarithm is equally likely between those of two values."""
    return _distribution("loguniform", **{"from": low, "to": high})


def triangular(low: Value, mode: Value, high: Value) -> Distribution:
    """Triangular between two values, with its top at the mode."""
    return _distribution("triangular", mode=mode, **{"from": low, "to": high})


class Design:
    """Uncertain quantities, by their paths, and the points at which a scene is simulated.

    ``kind``: monte-carlo, latin-hypercube, sobol, saltelli or morris. ``settings`` as in a scene's ``[design]``:
    ``replicates``, ``seed``, ``second_order``, ``levels``, ``scramble``.

    >>> study = Design("sobol", samples=4, parameters={"instrument.tip.radius": uniform("5 nm", "15 nm")})
    >>> study.points()["instrument.tip.radius"].shape
    (4,)
    """

    def __init__(
        self,
        kind: str,
        *,
        samples: int,
        parameters: Mapping[str, Distribution],
        correlation: Iterable[tuple[str, str, float]] = (),
        groups: Iterable[Iterable[str]] = (),
        **settings: Any,
    ) -> None:
        for path in parameters:
            _toml.check(path)
        self.parameters = dict(parameters)
        self.settings: dict[str, Any] = {"kind": kind, "samples": samples, **settings}
        if pairs := [list(pair) for pair in correlation]:
            self.settings["correlation"] = pairs
        if together := [list(group) for group in groups]:
            self.settings["groups"] = together
        # A design that cannot be is refused here.
        self._described()

    def __repr__(self) -> str:
        return f"Design({self.settings['kind']!r}, samples={self.settings['samples']}, {list(self.parameters)})"

    def to_dict(self) -> dict[str, Any]:
        """The sections ``uncertain`` and ``design`` of a scene."""
        return {"uncertain": self.parameters, "design": self.settings}

    def _described(self) -> dict[str, Any]:
        return json.loads(_afmsweep.problem(_toml.dumps(self.to_dict())))

    def salib(self) -> dict[str, Any]:
        """The problem as SALib takes it: ``num_vars``, ``names``, ``bounds``, ``dists`` (SI), and ``paths`` of the names."""
        problem = self._described()["problem"]
        if problem.get("groups") is None:
            problem.pop("groups", None)
        return {**problem, "paths": list(self.parameters)}

    def points(self) -> dict[str, np.ndarray]:
        """The points: of each quantity its values over the rows, f64 in SI. `afmsweep.run` takes them as ``samples``."""
        import numpy as np

        text = _toml.dumps(self.to_dict())
        return {path: np.frombuffer(values) for path, values in _afmsweep.points(text)}

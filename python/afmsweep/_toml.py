"""Scenes as dictionaries and as TOML, numbers with the SI units of their quantities."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from typing import Any

from . import _afmsweep

# Keys of an axis or a distribution whose values have the quantity's unit.
_OF_QUANTITY = {"from", "to", "values", "mean", "sd", "median", "mode"}
# Sections whose keys are paths of quantities.
_OF_PATHS = {"sweep", "samples", "uncertain"}


@functools.cache
def units() -> dict[str, str]:
    """The SI unit of each quantity, by its path; an index in a path is ``#``."""
    return _afmsweep.units()


def unit_of(path: str) -> str:
    """The SI unit of a quantity; empty for what is none or has none."""
    unit = units().get(re.sub(r"\.\d+(?=\.|$)", ".#", path), "")
    return "" if unit == "1" else unit


def check(path: str) -> None:
    """Raises KeyError where the path is no quantity, with the one that may be meant."""
    known = units()
    if re.sub(r"\.\d+(?=\.|$)", ".#", path) not in known:
        meant = _afmsweep.nearest(path, list(known))
        hint = f"; did you mean {meant!r}?" if meant else ""
        raise KeyError(f"no quantity {path!r}{hint}")


def _plain(value: Any) -> Any:
    """A value of NumPy as one of Python."""
    return value.tolist() if hasattr(value, "tolist") else value


def _quantity(value: Any, unit: str) -> Any:
    """A value whose bare numbers have this unit."""
    value = _plain(value)
    if isinstance(value, Mapping):
        return {key: _quantity(one, unit) if key in _OF_QUANTITY else _plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_quantity(one, unit) for one in value]
    if unit and isinstance(value, (int, float)) and not isinstance(value, bool):
        return f"{float(value)!r} {unit}"
    return value


def _axis(key: str, value: Any) -> Any:
    """An entry of a section of paths: a quantity, or several that vary together."""
    if "." in key or not isinstance(value, Mapping):
        return _quantity(value, unit_of(key))
    return {name: _quantity(one, unit_of(name)) for name, one in value.items()}


def with_units(table: Mapping[str, Any], path: str = "") -> dict[str, Any]:
    """A scene, or a part of it at a path, whose numbers have units where quantities need them."""
    told: dict[str, Any] = {}
    for key, value in table.items():
        place = f"{path}.{key}" if path else key
        value = _plain(value)
        if not path and key in _OF_PATHS and isinstance(value, Mapping):
            told[key] = {name: _axis(name, one) for name, one in value.items()}
        elif not path and key == "curve" and isinstance(value, Mapping):
            told[key] = _quantity(value, unit_of(str(value.get("quantity"))))
        elif isinstance(value, Mapping):
            told[key] = with_units(value, place)
        elif isinstance(value, (list, tuple)) and any(isinstance(one, Mapping) for one in value):
            told[key] = [with_units(one, f"{place}.0") for one in value]
        else:
            told[key] = _quantity(value, unit_of(place))
    return told


def _written(value: Any) -> str:
    """A value as TOML, on one line."""
    value = _plain(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        # Control characters stand as their numbers.
        return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped) + '"'
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(name)} = {_written(one)}" for name, one in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_written(one) for one in value) + "]"
    raise TypeError(f"a scene has no {type(value).__name__}: {value!r}")


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _written(key)


def dumps(scene: Mapping[str, Any]) -> str:
    """A scene as TOML, its numbers with units."""
    lines: list[str] = []
    _section(lines, "", with_units(scene))
    return "\n".join(lines).strip() + "\n"


def _section(lines: list[str], name: str, table: Mapping[str, Any]) -> None:
    # Parts of the instrument are sections of their own, everything deeper stands on one line.
    parts = {key: one for key, one in table.items() if isinstance(one, Mapping) and name in ("", "instrument")}
    if name:
        lines += ["", f"[{name}]"]
    lines += [f"{_key(key)} = {_written(one)}" for key, one in table.items() if key not in parts]
    for key, one in parts.items():
        _section(lines, f"{name}.{_key(key)}" if name else _key(key), one)

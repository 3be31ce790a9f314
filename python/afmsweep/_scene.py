"""Scenes: what is simulated, and what is known of it before it runs."""

from __future__ import annotations

import functools
import json
import os
import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

from . import _afmsweep, _toml

if TYPE_CHECKING:
    from ._design import Design

SceneLike = Union["Scene", str, "os.PathLike[str]", Mapping[str, Any]]


class Scene:
    """A scene: a path, TOML text, or a dictionary with the same keys.

    In a dictionary a quantity may be a text with its unit, or a number in SI units. A scene never changes: `set` gives
    another one.

    >>> scene = Scene({"sample": {"youngs_modulus": 2e9}})
    >>> print(scene.text)
    [sample]
    youngs_modulus = "2000000000.0 Pa"
    <BLANKLINE>
    """

    __slots__ = ("name", "text")

    #: The TOML text.
    text: str
    #: What messages call it; a scene from a file has the file's path, and looks for its tables in the file's folder.
    name: str

    def __init__(self, scene: SceneLike) -> None:
        if isinstance(scene, Scene):
            self.text, self.name = scene.text, scene.name
        elif isinstance(scene, Mapping):
            self.text, self.name = _toml.dumps(scene), "scene"
        elif isinstance(scene, str) and ("\n" in scene or "=" in scene) and not scene.endswith(".toml"):
            self.text, self.name = scene, "text"
        else:
            self.text, self.name = Path(scene).read_text(encoding="utf-8"), os.fspath(scene)

    def __repr__(self) -> str:
        return f"Scene({self.name!r})"

    def _repr_html_(self) -> str:
        import html

        return f"<pre>{html.escape(self.text)}</pre>"

    def to_dict(self) -> dict[str, Any]:
        """The scene as a dictionary, quantities as they are written."""
        try:
            return tomllib.loads(self.text)
        except tomllib.TOMLDecodeError:
            # Told in full, with the place marked.
            _afmsweep.modes(self.text, self.name)
            raise

    def set(self, values: Mapping[str, Any]) -> Scene:
        """A scene with other values, by their paths; None removes one. Numbers are in SI units.

        >>> scene = Scene({"sample": {"youngs_modulus": "2 GPa"}})
        >>> scene.set({"sample.youngs_modulus": 3e9, "contact.law": "hertz"}).to_dict()
        {'sample': {'youngs_modulus': '3000000000.0 Pa'}, 'contact': {'law': 'hertz'}}
        """
        scene = self.to_dict()
        for path, value in values.items():
            _put(scene, path, value)
        changed = Scene(scene)
        changed.name = self.name
        return changed

    def with_design(self, design: Design) -> Scene:
        """The scene with a design in place of its samples; see `Design`."""
        parts = design.to_dict()
        return self.set({"samples": None, **parts})

    def modes(self) -> dict[str, Any]:
        """Natural frequencies of the first instance, as the command ``modes --json`` tells them.

        ``modes``: one entry for each, in rising frequency (``frequency_hz``, ``quality_factor``, ``tip_share``,
        ``drive_share``; the shares have no unit).
        """
        return json.loads(_afmsweep.modes(self.text, self.name))

    def force(
        self,
        indentation: float | str | Iterable[float | str] | None = None,
        *,
        lever: bool = False,
        instance: int = 0,
    ) -> dict[str, Any]:
        """Static force over indentation of an instance's contact, both ways, as ``force --json`` tells it.

        ``indentation``: one in m, or several, in place of the whole curve. ``lever``: over the base, as the lever bends,
        with snap-in and pull-off. ``curves``: for each ``branch`` the lists ``indentation_m``, ``force_n``,
        ``contact_radius_m``.
        """
        alone = indentation is None or isinstance(indentation, str) or not hasattr(indentation, "__iter__")
        some = [] if indentation is None else [indentation] if alone else indentation
        metres = [_metres(one) for one in some]
        return json.loads(_afmsweep.force(self.text, self.name, instance, metres, lever))

    def plan(self, *, forecast: bool = False, backend: str = "auto", threads: int | None = None) -> dict[str, Any]:
        """What a run would do, as ``plan --json`` tells it; nothing is run.

        ``forecast`` runs some instances, for ``expected_time_s`` (s).
        """
        options = run_options(backend, threads=threads)
        return json.loads(_afmsweep.plan(self.text, self.name, [], options, forecast))


def run_options(
    backend: str,
    precision: str | None = None,
    threads: int | None = None,
    audit: int | None = None,
    output: str | os.PathLike[str] | None = None,
    resume: bool = False,
) -> dict[str, Any]:
    """How a scene is run, see `run`."""
    for name, count, least in (("threads", threads, 1), ("audit", audit, 0)):
        if count is not None and count < least:
            raise ValueError(f"{name} is {count}: give None, or a whole number of at least {least}")
    return {
        "backend": backend,
        "precision": precision,
        "threads": threads,
        "audit": audit,
        "portion": None,
        "output": output,
        "resume": resume,
    }


def _metres(length: float | str) -> float:
    """A length in m. A text has a unit of metres."""
    if not isinstance(length, str):
        return float(length)
    return _afmsweep.length(length)


_OF_QUANTITIES = ("instrument", "sample", "contact", "drive", "approach")


def _put(scene: dict[str, Any], path: str, value: Any) -> None:
    """Puts a value where its path leads; paths of quantities are checked."""
    *parents, last = path.split(".")
    if path.split(".")[0] not in _sections() or parents and parents[0] in _OF_QUANTITIES:
        _known(path)
    place: Any = scene
    for word in parents:
        if isinstance(place, list):
            place = place[int(word)]
        else:
            place = place.setdefault(word, {})
    if isinstance(place, list):
        place[int(last)] = value
    elif value is None:
        place.pop(last, None)
    else:
        place[last] = value


@functools.cache
def _sections() -> frozenset[str]:
    return frozenset(key for key in _afmsweep.keys() if "." not in key)


@functools.cache
def _keys() -> frozenset[str]:
    return frozenset(key for key in _afmsweep.keys() if "." in key)


def _known(path: str) -> None:
    """Raises KeyError where a scene has no such key."""
    plain = re.sub(r"\.\d+(?=\.|$)", "", path)
    if plain not in _keys():
        meant = _afmsweep.nearest(plain, sorted(_keys()))
        raise KeyError(f"no key {path!r}" + (f"; did you mean {meant!r}?" if meant else ""))

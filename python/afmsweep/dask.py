"""Shares of one run on many machines, for ``client.map`` of Dask or any other that calls a function by its arguments.

>>> from afmsweep.dask import merge, prepare, run_shard
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from ._run import open as _open
from ._scene import Scene, SceneLike

if TYPE_CHECKING:
    import xarray as xr

# What the command says of a file that a process still writes to, and seconds until it is asked again.
_BUSY, _AGAIN = "another run is writing", 5.0


def _command(*words: str | os.PathLike[str]) -> None:
    """Runs the command in a process of its own; a worker that is stopped takes it along."""
    call = [sys.executable, "-m", "afmsweep", *(os.fspath(word) for word in words)]
    # The process of a worker that died may still be at its share.
    while (done := subprocess.run(call, capture_output=True, text=True)).returncode and _BUSY in done.stderr:
        time.sleep(_AGAIN)
    if done.returncode:
        raise RuntimeError(done.stderr.strip())


def _file(folder: str | os.PathLike[str], name: str) -> Path:
    return Path(folder, name)


def prepare(scene: SceneLike, folder: str | os.PathLike[str], *, portion: int | None = None) -> Path:
    """Makes the choices of a run that its shares have in common, and gives the folder, which all machines must see.

    ``portion``: instances that are run and written down together; None takes some ten seconds of work.
    """
    given = Scene(scene)
    Path(folder).mkdir(parents=True, exist_ok=True)
    file = _file(folder, "scene.toml")
    # The scene's own folder, where it looks for tables, is the one of this file now.
    file.write_text(given.text, encoding="utf-8")
    portions = [] if portion is None else ["--portion", str(portion)]
    _command("prepare", file, "-q", "-o", _file(folder, "choices.toml"), *portions)
    return Path(folder)


def run_shard(number: int, shards: int, folder: str | os.PathLike[str], *, threads: int = 1) -> Path:
    """Runs share ``number`` (from 1) of a run that `prepare` has made a folder for, or goes on with it; gives its file."""
    file = _file(folder, f"{number}-of-{shards}.h5")
    share: list[str | Path] = ["--shard", f"{number}/{shards}", "--choices", _file(folder, "choices.toml"), "-o", file]
    _command("run", _file(folder, "scene.toml"), "-q", "--resume", "--threads", str(threads), *share)
    return file


def merge(files: Iterable[str | os.PathLike[str]], output: str | os.PathLike[str]) -> xr.Dataset:
    """Makes the results of a run of all its shares; they are to the bit those of one run."""
    _command("merge", *files, "-q", "-o", output)
    return _open(output)

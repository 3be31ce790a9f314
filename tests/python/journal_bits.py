"""Turns bits over in the journal of a run and goes on with it. Needs h5py.

journal_bits.py PROGRAM [--flips 2000] [--seed 1]

One journal is of a run that was killed among its portions, another of one that was killed in its audit, after its second branches.
Truth is the run that nobody disturbs. After each flip the run is refused, or it says what it leaves out and its file is that
of the undisturbed run, to the bit: no flip goes unnoticed.
"""

import argparse
import collections
import os
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "clusters"))
from same import differing  # noqa: E402

SCENE = """
[instrument.cantilever]
modes = [{ stiffness = "26 N/m", frequency = "300 kHz", quality_factor = 100 }]
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 8 }
"approach.gap" = { from = "15 nm", to = "19 nm", points = 4 }
[run]
steady = "search"
"""


BRANCHES = SCENE.replace('law = "hertz"', 'law = "dmt"').replace("quality_factor = 100", "quality_factor = 400")
BRANCHES += 'branches = "both"\n'
# A scene, and the audit of its runs.
KINDS = {"portions": (SCENE, ["--no-audit"]), "audit": (BRANCHES, ["--audit", "12"])}


def records(bytes_):
    """The kinds of a journal's records."""
    at, found = len(b"afmjournal 2\n"), []
    while at + 13 <= len(bytes_):
        found.append(bytes_[at + 4])
        at += 13 + int.from_bytes(bytes_[at : at + 4], "little")
    return found[:-1] if at > len(bytes_) else found


def is_wanted(name, bytes_):
    """Whether a journal holds enough."""
    if name == "portions":
        return len(bytes_) > 8_000
    return records(bytes_).count(3) > 4


def journal(program, name, audit):
    """The bytes of the journal of a run that was killed when it held enough."""
    for wait in range(1, 1000):
        child = subprocess.Popen([program, "run", "scene.toml", "-q", *audit, "--portion", "2", "-o", "a.h5"])
        try:
            child.wait(0.002 * wait)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
        partial = pathlib.Path("a.h5.partial")
        if partial.exists() and is_wanted(name, partial.read_bytes()):
            return partial.read_bytes()
        partial.unlink(missing_ok=True)
        pathlib.Path("a.h5").unlink(missing_ok=True)
    raise RuntimeError("no run was met at the right moment")


def turned(program, name, flips, draw):
    """Turns bits over in a journal and goes on with it; what is wrong."""
    text, audit = KINDS[name]
    table, wrong = collections.Counter(), []
    pathlib.Path("scene.toml").write_text(text)
    subprocess.run([program, "run", "scene.toml", "-q", *audit, "-o", "whole.h5"], check=True)
    bytes_ = journal(program, name, audit)
    for _ in range(flips):
        damaged = bytearray(bytes_)
        bit = draw.randrange(8 * len(damaged))
        damaged[bit // 8] ^= 1 << bit % 8
        pathlib.Path("a.h5.partial").write_bytes(damaged)
        pathlib.Path("a.h5").unlink(missing_ok=True)
        words = [program, "run", "scene.toml", *audit, "-o", "a.h5", "--resume"]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode == 0:
            said = "left out" in done.stderr
            table["said and run again" if said else "unnoticed"] += 1
            wrong += [f"bit {bit}: {name} differs" for name in differing("whole.h5", "a.h5")]
            wrong += [] if said else [f"bit {bit}: nothing was said"]
        elif done.returncode == 1 and "error: " in done.stderr:
            table["refused"] += 1
        else:
            wrong.append(f"bit {bit}: exit code {done.returncode}: {done.stderr}")
    print(f"{name}: {flips} bits of {len(bytes_)} bytes: {dict(table)}; {len(wrong)} wrong", flush=True)
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--flips", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    told = parser.parse_args()
    program = str(told.program.resolve())
    draw = random.Random(told.seed)
    wrong = []
    for name in KINDS:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            wrong += turned(program, name, told.flips // len(KINDS), draw)
            os.chdir("/")
    print("\n".join(wrong[:20]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

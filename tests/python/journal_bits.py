"""Turns bits over in the journal of a run and goes on with it. Needs h5py.

journal_bits.py PROGRAM [--flips 2000] [--seed 1]

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


def journal(program):
    """The bytes of a journal that holds some portions: one that was killed."""
    for wait in range(1, 1000):
        child = subprocess.Popen([program, "run", "scene.toml", "-q", "--no-audit", "--portion", "2", "-o", "a.h5"])
        try:
            child.wait(0.002 * wait)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
        partial = pathlib.Path("a.h5.partial")
        if partial.exists() and partial.stat().st_size > 8_000:
            return partial.read_bytes()
        partial.unlink(missing_ok=True)
        pathlib.Path("a.h5").unlink(missing_ok=True)
    raise RuntimeError("no run was met at the right moment")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--flips", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    told = parser.parse_args()
    program = str(told.program.resolve())
    draw = random.Random(told.seed)
    table, wrong = collections.Counter(), []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pathlib.Path("scene.toml").write_text(SCENE)
        subprocess.run([program, "run", "scene.toml", "-q", "--no-audit", "-o", "whole.h5"], check=True)
        bytes_ = journal(program)
        for _ in range(told.flips):
            damaged = bytearray(bytes_)
            bit = draw.randrange(8 * len(damaged))
            damaged[bit // 8] ^= 1 << bit % 8
            pathlib.Path("a.h5.partial").write_bytes(damaged)
            pathlib.Path("a.h5").unlink(missing_ok=True)
            words = [program, "run", "scene.toml", "--no-audit", "-o", "a.h5", "--resume"]
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
        os.chdir("/")
    print(f"{told.flips} bits of {len(bytes_)} bytes: {dict(table)}; {len(wrong)} wrong")
    print("\n".join(wrong[:20]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

"""Memory and time of a run of very many instances, and of opening what it has written. Needs xarray, h5netcdf and netCDF4.

many.py PROGRAM [--kind grid|searched|samples] [--instances 100000 1000000 10000000]

A row for each: peak memory of the run, its wall time, the file's size beside that of its numbers, and what xarray takes to
open it and to read one variable. Ends with 1 where `open_datatree` refuses a file, a notebook would show more than 100 kB of
it, or it is larger than 1.2 times its numbers.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import xarray

LEVER = """
[instrument.cantilever]
modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 30 }]
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "300 kHz"
force = "20 nN"
[sample]
surface_energy = "0 J/m^2"
[output]
observables = ["amplitude"]
"""
GRID = """
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = ROWS }
"approach.gap" = { from = "12 nm", to = "14 nm", points = COLUMNS }
"""
SAMPLES = """
[approach]
gap = "13 nm"
[uncertain]
"sample.youngs_modulus" = { distribution = "loguniform", from = "0.5 GPa", to = "5 GPa" }
"instrument.tip.radius" = { distribution = "lognormal", median = "10 nm", sigma = 0.3 }
"approach.gap" = { distribution = "uniform", from = "12 nm", to = "14 nm" }
[design]
kind = "latin-hypercube"
samples = COUNT
"""
SEARCH = '[run]\nsteady = "search"\n'
KINDS = {"grid": LEVER + GRID, "searched": LEVER + GRID + SEARCH, "samples": LEVER + SAMPLES + SEARCH}


def scene(kind, count):
    """Its text, of so many instances."""
    columns = max(n for n in range(1, int(count**0.5) + 1) if count % n == 0)
    numbers = {"ROWS": count // columns, "COLUMNS": columns, "COUNT": count}
    text = KINDS[kind]
    for word, number in numbers.items():
        text = text.replace(word, str(number))
    return text


def run(program):
    """Peak memory in bytes and wall time in s."""
    began = time.monotonic()
    words = [program, "run", "scene.toml", "-q", "--backend", "cpu", "--no-audit", "-o", "many.h5", "--overwrite"]
    child = subprocess.Popen(words)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise RuntimeError(f"the run ends with {child.returncode}")
    return usage.ru_maxrss * 1024, time.monotonic() - began


def opened():
    """Bytes of the numbers in the file, what a notebook shows of it, and the seconds to open it and to read a variable."""
    began = time.monotonic()
    with xarray.open_datatree("many.h5") as tree:
        shown = len(tree._repr_html_())
        numbers = sum(one.nbytes for node in tree.subtree for one in node.to_dataset(inherit=False).variables.values())
    with xarray.open_dataset("many.h5") as data:
        first = time.monotonic() - began
        began = time.monotonic()
        data["amplitude"].mean().item()
        return numbers, shown, first, time.monotonic() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--kind", choices=KINDS, default="grid")
    parser.add_argument("--instances", type=int, nargs="+", default=[100_000, 1_000_000, 10_000_000])
    told = parser.parse_args()
    program, wrong = str(told.program.resolve()), []
    print("| instances | peak memory, MB | wall, s | file, MB | its numbers, MB | shown, kB | opened, s | one variable read, s |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for count in told.instances:
            pathlib.Path("scene.toml").write_text(scene(told.kind, count))
            peak, wall = run(program)
            size = pathlib.Path("many.h5").stat().st_size
            numbers, shown, first, read = opened()
            cells = [f"{peak / 1e6:.0f}", f"{wall:.1f}", f"{size / 1e6:.1f}", f"{numbers / 1e6:.1f}"]
            cells += [f"{shown / 1e3:.0f}", f"{first:.2f}", f"{read:.2f}"]
            print(f"| {count:,} | {' | '.join(cells)} |", flush=True)
            if shown > 100_000 or size > 1.2 * numbers:
                wrong.append(f"{count}: the file has {size} bytes and is shown in {shown}")
        os.chdir("/")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

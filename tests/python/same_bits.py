"""Do two versions of the program give the same numbers, for the same work and in the same time?

same_bits.py PROGRAM OTHER [--only TEXT] [--times N]

Runs every scene of tests/hard and scenes/ and one sweep of each kind with both programs on the CPU, compares the
results files variable by variable, bit by bit, and the instance-steps taken; prints a row for each difference. With
--times N it runs the large sweeps only, N times in turns, and prints the processor seconds of both. Exits with 1 if
anything differs. It serves those who change the structure and nothing else.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy

ROOT = Path(__file__).resolve().parents[2]
LEVER = """[instrument.cantilever]
stiffness = "40 N/m"
frequency = "320 kHz"
quality_factor = {quality}
[instrument.tip]
radius = "7 nm"
[sample]
surface_energy = "60 mJ/m^2"
[contact]
law = "{law}"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[output]
observables = ["amplitude", "phase", "force_max", "contacts", "contact_time", "dissipation"]
{output}
"""
MODULI = '"sample.youngs_modulus" = {{ from = "1 GPa", to = "5 GPa", points = {0}, scale = "log" }}\n'
GAPS = '"approach.gap" = {{ from = "15 nm", to = "24.9 nm", points = {1} }}\n'
SEARCH = '[run]\nsteady = "search"\n'
CURVE = '[curve]\nquantity = "approach.gap"\nfrom = "25 nm"\nto = "15 nm"\npoints = 25\ndirection = "both"\n'
# What a kind of sweep adds to the lever, with counts for one and the other axis.
KINDS = {
    "grid": "[sweep]\n" + MODULI + GAPS + SEARCH,
    "waited": "[sweep]\n" + MODULI + GAPS + "[run]\nperiods = 300\n",
    "set-point": "[sweep]\n" + MODULI + '"approach.setpoint" = {{ from = 0.5, to = 0.99, points = {1} }}\n',
    "force set-point": "[sweep]\n" + MODULI
    + '"approach.setpoint_force" = {{ from = "1 nN", to = "8 nN", points = {1} }}\n',
    "both branches": "[sweep]\n" + MODULI + GAPS + SEARCH + 'branches = "both"\n',
    "curve": "[sweep]\n" + MODULI + CURVE,
    "design": '[uncertain]\n"sample.youngs_modulus" = {{ distribution = "loguniform", from = "1 GPa", to = "5 GPa" }}\n'
    '"approach.gap" = {{ distribution = "uniform", from = "15 nm", to = "25 nm" }}\n'
    '"instrument.cantilever.stiffness" = {{ distribution = "normal", mean = "40 N/m", sd = "2 %" }}\n'
    '[design]\nkind = "monte-carlo"\nsamples = {2}\n' + SEARCH,
}


def sweep(kind, law, first, second, quality=300, output=""):
    """The text of a sweep of that kind."""
    lever = LEVER.format(law=law, quality=quality, output=output)
    return lever + KINDS[kind].format(first, second, first * second)


def small():
    """Names and texts, or paths, of what is compared bit by bit."""
    for folder in ("tests/hard", "scenes", "scenes/paper"):
        for path in sorted((ROOT / folder).glob("*.toml")):
            yield f"{folder}/{path.stem}", path
    for law in ("hertz", "dmt", "jkr"):
        for kind in KINDS:
            few = kind in ("waited", "curve", "both branches")
            yield f"{kind}, {law}", sweep(kind, law, *((6, 10) if few else (30, 40)))
        yield f"spectra, {law}", sweep("grid", law, 2, 5, output='spectra = { instances = "all" }')


def large():
    """The same of what takes long enough for its time to be measured."""
    for law in ("hertz", "dmt", "jkr"):
        yield f"grid of 90,000, {law}", sweep("grid", law, 300, 300)
    yield "grid of 40,000, dmt, quality factor 2000", sweep("grid", "dmt", 200, 200, quality=2000)
    yield "design of 4,000, dmt", sweep("design", "dmt", 40, 100)
    yield "design of 4,000, jkr", sweep("design", "jkr", 40, 100)
    yield "20 curves, dmt", sweep("curve", "dmt", 20, 1)
    yield "900 set-points, dmt", sweep("set-point", "dmt", 30, 30)
    yield "400 of both branches, dmt", sweep("both branches", "dmt", 20, 20)


def carried_out(program, scene, folder, extra=()):
    """What the program tells of a run (None if it refuses the scene), and its file."""
    path, file = scene, Path(folder) / f"{Path(program).name}.h5"
    if isinstance(scene, str):
        path = Path(folder) / "scene.toml"
        path.write_text(scene)
    command = [program, "run", str(path), "-o", str(file), "--overwrite", "--json", "--backend", "cpu", *extra]
    done = subprocess.run(command, capture_output=True, text=True)
    if not done.stdout.strip():
        return done.stderr.strip(), None
    return json.loads(done.stdout), file


def differences(one, other):
    """Variables that differ, with how many of their values."""
    found = []

    def compare(name, mine):
        if not isinstance(mine, h5py.Dataset):
            return
        if name not in other:
            found.append(f"{name}: only in one")
            return
        mine, its = mine[()], other[name][()]
        if mine.dtype != its.dtype or numpy.shape(mine) != numpy.shape(its):
            found.append(f"{name}: {mine.dtype}{numpy.shape(mine)}, {its.dtype}{numpy.shape(its)}")
        elif numpy.asarray(mine).tobytes() != numpy.asarray(its).tobytes() or mine.dtype.hasobject:
            same = numpy.asarray(mine == its)
            if mine.dtype.kind == "f":
                same = same | (numpy.isnan(mine) & numpy.isnan(its))
            if not same.all():
                found.append(f"{name}: {int((~same).sum())} of {same.size} values")

    one.visititems(compare)
    return found


def compared(program, other, only):
    """Rows of differences over all small sweeps."""
    bad = count = 0
    for name, scene in small():
        if only and only not in name:
            continue
        count += 1
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as beside:
            # How many an audit takes hangs on its time.
            told, file = carried_out(program, scene, folder, ["--no-audit"])
            its, its_file = carried_out(other, scene, beside, ["--no-audit"])
            rows = []
            if file is None or its_file is None:
                rows = [] if file is its_file else [f"refused by one: {told if file is None else its}"]
            else:
                with h5py.File(file) as mine, h5py.File(its_file) as theirs:
                    rows = differences(mine, theirs)
                steps = [one["instance_steps_taken"] for one in (told, its)]
                if steps[0] != steps[1]:
                    rows.append(f"instance-steps: {steps[0]} | {steps[1]}")
            for row in rows:
                print(f"{name}: {row}", flush=True)
            bad += bool(rows)
    print(f"{count} sweeps, {bad} of them differ")
    assert count, f"no sweep is called {only}"
    return bad


def timed(program, other, only, times):
    """A table of processor seconds, medians of runs in turns."""
    print(f"{'sweep':<45}{'s':>8}{'other':>8}{'ratio':>7}{'steps':>7}")
    for name, scene in large():
        if only and only not in name:
            continue
        seconds, steps = ([], []), [0, 0]
        for turn in range(times):
            for which in (0, 1) if turn % 2 == 0 else (1, 0):
                with tempfile.TemporaryDirectory() as folder:
                    told, _ = carried_out((program, other)[which], scene, folder, ["--no-audit"])
                seconds[which].append(told["processor_time_s"])
                steps[which] = told["instance_steps_taken"]
        mine, its = (statistics.median(row) for row in seconds)
        print(f"{name:<45}{mine:>8.2f}{its:>8.2f}{mine / its:>7.3f}{steps[0] / steps[1]:>7.3f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("other")
    parser.add_argument("--only", default="")
    parser.add_argument("--times", type=int, default=0)
    options = parser.parse_args()
    if options.times:
        timed(options.program, options.other, options.only, options.times)
    elif compared(options.program, options.other, options.only):
        sys.exit(1)


if __name__ == "__main__":
    main()

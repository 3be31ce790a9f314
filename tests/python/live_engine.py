"""The web page's engine against the program: the same scenes under Node and by the command.

    python live_engine.py PROGRAM target/web/engine.wasm [--rows N]

Lists of random levers, samples, drives and gaps under each law, a followed curve both ways, set-points, second states, a map.
The truth is the program's results file. With AFMSWEEP_ROUNDING=twice all statuses and numbers must be equal to the bit. As the
program runs by itself, statuses must be equal and numbers agree to rounding: WebAssembly has no fused products.
"""

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

# Relative: a tenth of the accuracy that the scenes ask for, to which a search ends; and what nearly all cases meet.
WORST, MOST = 1e-4, 1e-6
MOST_SHARE = 0.95
VARIABLES = ["amplitude", "phase", "force_max", "indentation_max", "dissipation", "gap"]

HEAD = """
[instrument.actuator]
model = "rigid"
[instrument.tip]
youngs_modulus = "130 GPa"
poisson_ratio = 0.28
[contact]
law = "{law}"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[run]
steady = "search"
{run}
[output]
observables = ["amplitude", "phase", "force_max", "indentation_max", "dissipation"{more}]
"""
LEVER = """
[instrument.cantilever]
stiffness = "26 N/m"
frequency = "300 kHz"
quality_factor = 400
[sample]
youngs_modulus = "2 GPa"
surface_energy = "60 mJ/m^2"
"""


def rows(law, count, rng):
    """A list of random cases."""
    factor = lambda low, high: low * (high / low) ** rng.random()
    text = lambda low, high, unit: [f'"{factor(low, high):.5g} {unit}"' for _ in range(count)]
    lists = {
        "instrument.cantilever.stiffness": text(0.5, 100, "N/m"),
        "instrument.cantilever.frequency": text(20, 500, "kHz"),
        "instrument.cantilever.quality_factor": [f"{factor(3, 800):.5g}" for _ in range(count)],
        "instrument.tip.radius": text(2, 100, "nm"),
        "sample.youngs_modulus": text(0.01, 130, "GPa"),
        "sample.surface_energy": text(1, 200, "mJ/m^2"),
    }
    amplitudes = [factor(2, 80) for _ in range(count)]
    lists["drive.free_amplitude"] = [f'"{one:.5g} nm"' for one in amplitudes]
    lists["approach.gap"] = [f'"{one * rng.uniform(0.3, 1.05):.5g} nm"' for one in amplitudes]
    told = "".join(f'"{path}" = [{", ".join(values)}]\n' for path, values in lists.items())
    lever = LEVER.replace('surface_energy = "60 mJ/m^2"', "") if law == "hertz" else LEVER
    if law == "hertz":
        told = "".join(line for line in told.splitlines(True) if "surface_energy" not in line)
    return lever + HEAD.format(law=law, run="", more="") + "[samples]\n" + told


def scenes(count, rng):
    for law in ["hertz", "dmt", "jkr"]:
        yield f"{law}, random rows", rows(law, count, rng)
    curve = '[curve]\nquantity = "approach.gap"\nfrom = "22 nm"\nto = "4 nm"\npoints = 49\ndirection = "both"\n'
    for law in ["dmt", "jkr"]:
        yield f"{law}, curve both ways", LEVER + HEAD.format(law=law, run="", more="") + curve
    setpoint = '[approach]\nsetpoint = 0.8\n[sweep]\n"sample.youngs_modulus" = { from = "100 MPa", to = "10 GPa", points = 20, scale = "log" }\n'
    yield "dmt, set-points", LEVER + HEAD.format(law="dmt", run="", more=', "gap"') + setpoint
    both = '[sweep]\n"approach.gap" = { from = "21 nm", to = "15 nm", points = 25 }\n'
    yield "dmt, both branches", LEVER + HEAD.format(law="dmt", run='branches = "both"', more="") + both
    grid = '[sweep]\n"approach.gap" = { from = "5 nm", to = "21 nm", points = 32 }\n"sample.youngs_modulus" = { from = "50 MPa", to = "50 GPa", points = 24, scale = "log" }\n'
    # A layer, a cone, losses, charges, a neck, a liquid.
    for name in ["gel_layer", "gel_cone", "polymer_phase", "bias", "liquid_neck", "liquid"]:
        yield f"{name}.toml", (Path(__file__).parents[2] / "scenes" / f"{name}.toml").read_text()
    yield "dmt, map", LEVER + HEAD.format(law="dmt", run="", more="") + grid


def scale(name, values):
    """What an error counts on: radians for phases, else the largest number."""
    return np.degrees(1) if name == "phase" else np.nanmax(np.abs(values), initial=1e-300)


def by_program(program, scene, rounding, names):
    """These variables of the results file, by name; without an audit, which a page has none of either."""
    file = scene.with_suffix(".h5")
    command = [program, "run", scene, "-q", "--backend", "cpu", "--precision", "f64", "--no-audit", "--overwrite", "-o", file]
    subprocess.run(command, check=True, env={**os.environ, "AFMSWEEP_ROUNDING": rounding})
    with h5py.File(file) as results:
        return {name: results[name][...].ravel() for name in names}


def of_page(page, variable):
    return np.array(page["variables"][variable]["data"], dtype=float)


def to_the_bit(name, results, page, wrong):
    status = results["status"]
    equal = np.ones(status.size, dtype=bool)
    for variable in sorted(set(results) - {"status"}):
        truth, found = results[variable], of_page(page, variable)
        same = (truth == found) | (np.isnan(truth) & np.isnan(found))
        equal &= same
        if not same.all():
            wrong.append(f"{name}: {variable} has other bits at {np.flatnonzero(~same)[:5]}")
    print(f"{name}: {np.count_nonzero(equal)} of {status.size} instances equal to the bit; {np.count_nonzero(status)} not ok")


def to_rounding(name, results, page, wrong):
    status, told = results["status"], []
    # Without hysteresis what is lost is rounding alone.
    lost = set() if name.startswith("jkr") else {"dissipation"}
    for variable in sorted(set(results) - lost - {"gap", "status"}):
        ok = status == 0
        truth, found = results[variable][ok], of_page(page, variable)[ok]
        if not np.array_equal(np.isnan(truth), np.isnan(found)):
            wrong.append(f"{name}: {variable} is no number in one alone")
        # Each on its own size, but what is next to nothing on the scene's.
        size = np.maximum(np.abs(truth), 1e-3 * scale(variable, truth))
        off = np.nan_to_num(np.abs(found - truth) / size)
        most, worst = np.quantile(off, MOST_SHARE), off.max()
        told.append(f"{variable} {np.median(off):.0e} {most:.0e} {worst:.0e}")
        if worst > WORST or most > MOST and status.size > 50:
            wrong.append(f"{name}: {variable} is off by {worst:.1e}, 5 % by more than {most:.1e}")
    print(f"{name}: {status.size}; median, 95th percentile, largest difference: {', '.join(told)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("engine")
    parser.add_argument("--rows", type=int, default=170, help="random cases for each law")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    kept = tempfile.TemporaryDirectory()
    folder = Path(kept.name)
    cases = list(scenes(args.rows, random.Random(args.seed)))
    files = []
    for number, (_, text) in enumerate(cases):
        files.append(folder / f"{number}.toml")
        files[-1].write_text(text)
    node = Path(__file__).parents[2] / "crates/web/test/answers.mjs"
    told = subprocess.run(["node", node, args.engine, *files], check=True, capture_output=True, text=True)
    answers = [json.loads(line) for line in told.stdout.splitlines()]
    wrong, seen = [], 0
    for rounding, held in [("twice", to_the_bit), ("once", to_rounding)]:
        print(f"the program rounds sums of products {rounding}")
        for (name, text), file, page in zip(cases, files, answers, strict=True):
            if "error" in page:
                wrong.append(f"{name}: {page['error']}")
                continue
            results = by_program(args.program, file, rounding, ["status", *(one for one in VARIABLES if f'"{one}"' in text)])
            status, ours = results["status"], np.array(page["status"])
            seen += status.size
            if not np.array_equal(status, ours):
                wrong.append(f"{name}: statuses differ at {np.flatnonzero(status != ours)[:5]}")
            held(name, results, page, wrong)
    print(f"{seen} instances")
    for line in wrong:
        print("WRONG:", line)
    sys.exit(bool(wrong) or seen < 6 * args.rows)


if __name__ == "__main__":
    main()

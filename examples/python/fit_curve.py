"""Fits the modulus and the unknown offset of the gap to a measured curve of amplitude and phase. Needs scipy.

    fit_curve.py [FILE]

The file is a text of columns as instruments export them: height in nm, amplitude in nm, phase in degree. Without one a
curve is made up, with noise.
"""

import sys
from pathlib import Path

import afmsweep as afm
import numpy as np
from lever import SCENE
from scipy.optimize import least_squares

AMPLITUDE, PHASE = 0.1e-9, 0.5   # noise: m, degree


def curve(modulus, points=141):
    scene = SCENE.set({
        "approach.gap": None,
        "sample.youngs_modulus": modulus,
        "curve": {"quantity": "approach.gap", "from": "24 nm", "to": "10 nm", "points": points},
    })
    return afm.run(scene, audit=0, progress=False)


def made_up():
    rng = np.random.default_rng(1)
    truth = curve(2.2e9, 60)
    amplitude = truth.amplitude + rng.normal(0, AMPLITUDE, 60)
    phase = truth.phase + rng.normal(0, PHASE, 60)
    # The instrument does not know where the surface is: 100 nm here.
    return np.column_stack([truth.approach_gap.values / 1e-9 + 100.0, amplitude / 1e-9, phase])


def main(file=None):
    height, amplitude, phase = (made_up() if file is None else np.loadtxt(Path(file), comments="#")).T
    height, amplitude = height * 1e-9, amplitude * 1e-9
    runs = {}

    def misfit(place):
        modulus, offset = place[0] * 1e9, place[1] * 1e-9
        # Moving the offset alone needs no other run.
        if modulus not in runs:
            runs[modulus] = curve(modulus)
        data = runs[modulus]
        there = data.interp(approach_gap=np.clip(height - offset, 10e-9, 24e-9))
        return np.concatenate([(there.amplitude.values - amplitude) / AMPLITUDE, (there.phase.values - phase) / PHASE])

    start = [1.0, (height.min() - 10e-9) / 1e-9]
    found = least_squares(misfit, start, diff_step=[1e-2, 1e-5], x_scale=[1.0, 1.0], loss="soft_l1")
    spread = np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)))
    print(f"modulus {found.x[0]:.2f} +- {spread[0]:.2f} GPa, surface at {found.x[1]:.2f} +- {spread[1]:.2f} nm, {len(runs)} runs")
    return found.x, spread


if __name__ == "__main__":
    main(*sys.argv[1:])

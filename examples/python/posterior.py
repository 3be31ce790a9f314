"""Modulus and tip radius from a measured amplitude and phase, by emcee on an interpolated grid. Needs emcee, scipy."""

import afmsweep as afm
import emcee
import numpy as np
from lever import SCENE
from scipy.interpolate import RegularGridInterpolator

SEEN = {"amplitude": (16.14e-9, 0.02e-9), "phase": (53.8, 0.5)}   # m, degree
LOW, HIGH = np.array([1e9, 5e-9]), np.array([5e9, 15e-9])         # Pa, m


def main(steps=1000):
    grid = afm.run(SCENE.set({"sweep": {
        "sample.youngs_modulus": {"from": LOW[0], "to": HIGH[0], "points": 41},
        "instrument.tip.radius": {"from": LOW[1], "to": HIGH[1], "points": 41},
    }}), audit=0)
    # What is not ok is NaN, and so is what lies beside it.
    places = (grid.sample_youngs_modulus.values, grid.tip_radius.values)
    seen = grid[list(SEEN)].where(grid.status == 0).to_dataarray().transpose(..., "variable").values
    between = RegularGridInterpolator(places, seen, bounds_error=False)
    value, sd = np.array(list(SEEN.values())).T

    def log_probability(walkers):
        squares = np.sum(((between(walkers) - value) / sd) ** 2, axis=1)
        return np.where(np.isfinite(squares), -0.5 * squares, -np.inf)

    np.random.seed(1)   # emcee draws from it
    sampler = emcee.EnsembleSampler(32, 2, log_probability, vectorize=True)
    sampler.run_mcmc(np.random.uniform(LOW, HIGH, (32, 2)), steps)
    chain = sampler.get_chain(discard=steps // 3, flat=True)
    mean, sd = chain.mean(axis=0), chain.std(axis=0)
    print(f"modulus {mean[0] / 1e9:.2f} +- {sd[0] / 1e9:.2f} GPa, tip radius {mean[1] / 1e-9:.1f} +- {sd[1] / 1e-9:.1f} nm, "
          f"correlation {np.corrcoef(chain.T)[0, 1]:.2f}")
    return mean, sd


if __name__ == "__main__":
    main()

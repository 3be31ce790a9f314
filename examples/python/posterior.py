"""Modulus and tip radius from a measured amplitude and phase, by emcee on an interpolated grid. Needs emcee, scipy."""

import emcee
import numpy as np
import xarray as xr
from lever import SCENE

import afmsweep as afm

SEEN = {"amplitude": (16.14e-9, 0.02e-9), "phase": (53.8, 0.5)}   # m, degree
LOW, HIGH = np.array([1e9, 5e-9]), np.array([5e9, 15e-9])        # Pa, m


def main(steps=600):
    grid = afm.run(SCENE.set({"sweep": {
        "sample.youngs_modulus": {"from": LOW[0], "to": HIGH[0], "points": 41},
        "instrument.tip.radius": {"from": LOW[1], "to": HIGH[1], "points": 41},
    }}), audit=0)
    grid = grid.where(grid.status == 0)

    def log_probability(places):
        inside = np.all((places > LOW) & (places < HIGH), axis=1)
        at = {name: xr.DataArray(places[:, n], dims="walker") for n, name in enumerate(("sample_youngs_modulus", "tip_radius"))}
        found = grid.interp(at)
        squares = sum(((found[name].values - value) / sd) ** 2 for name, (value, sd) in SEEN.items())
        return np.where(inside & np.isfinite(squares), -0.5 * squares, -np.inf)

    rng = np.random.default_rng(1)
    start = rng.uniform(LOW, HIGH, (32, 2))
    np.random.seed(1)
    sampler = emcee.EnsembleSampler(32, 2, log_probability, vectorize=True)
    sampler.run_mcmc(start, steps)
    chain = sampler.get_chain(discard=steps // 3, flat=True)
    mean, sd = chain.mean(axis=0), chain.std(axis=0)
    print(f"modulus {mean[0] / 1e9:.2f} +- {sd[0] / 1e9:.2f} GPa, tip radius {mean[1] / 1e-9:.1f} +- {sd[1] / 1e-9:.1f} nm, "
          f"correlation {np.corrcoef(chain.T)[0, 1]:.2f}")
    return mean, sd


if __name__ == "__main__":
    main()

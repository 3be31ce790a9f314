"""Sobol' indices of the largest force: rows and indices by SALib, then both by the program. Needs SALib."""

import sys
import time

import afmsweep as afm
import numpy as np
from lever import SCENE
from SALib.analyze import sobol as analysis
from SALib.sample import sobol as sampling

STUDY = afm.Design("saltelli", samples=2048, replicates=16, parameters={
    "instrument.cantilever.stiffness": afm.normal("42 N/m", "10 %"),
    "instrument.cantilever.quality_factor": afm.uniform(380, 420),
    "instrument.tip.radius": afm.uniform("7 nm", "9 nm"),
    "sample.youngs_modulus": afm.uniform("2 GPa", "3 GPa"),
    "sample.surface_energy": afm.uniform("40 mJ/m^2", "60 mJ/m^2"),
})


def main(base=2048):
    problem = STUDY.salib()
    start = time.perf_counter()
    drawn = sampling.sample(problem, base, calc_second_order=False, seed=1)
    began = time.perf_counter()
    data = afm.run(SCENE, samples=dict(zip(problem["paths"], drawn.T)), audit=0)
    ran = time.perf_counter()
    lost = int((data.status != 0).sum())
    if lost > 0.01 * data.status.size:
        sys.exit(f"{lost} of {data.status.size} rows failed")
    theirs = analysis.analyze(problem, data.force_max.values, calc_second_order=False, seed=1)
    ended = time.perf_counter()
    print(f"SALib: {data.status.size} rows, {lost} lost; {began - start:.1f} s to draw, {ran - began:.1f} s to run, "
          f"{ended - ran:.1f} s for indices")
    ours = afm.sobol(afm.run(SCENE.with_design(STUDY), audit=0), "force_max", left_out=0.01)
    print(f"afmsweep: {time.perf_counter() - ended:.1f} s in all")
    for n, name in enumerate(problem["names"]):
        one = ours.sel(parameter=name)
        print(f"{name:28} ST {theirs['ST'][n]:.3f} +- {theirs['ST_conf'][n]:.3f} | {one.ST:.3f} +- {one.ST_conf:.3f}")
    return float(np.max(np.abs(theirs["ST"] - ours.ST.values)))


if __name__ == "__main__":
    main()

"""Ensemble sweeps of atomic force microscope dynamics.

>>> import afmsweep as afm
>>> scene = afm.Scene({
...     "instrument": {"cantilever": {"stiffness": "42 N/m", "frequency": "300 kHz", "quality_factor": 30},
...                    "tip": {"radius": "8 nm"}},
...     "sample": {"youngs_modulus": "2 GPa", "surface_energy": "30 mJ/m^2"},
...     "contact": {"law": "dmt"},
...     "drive": {"on": "tip", "frequency": "resonance", "free_amplitude": "20 nm"},
...     "sweep": {"approach.gap": {"from": "8 nm", "to": "20 nm", "points": 5}},
...     "run": {"steady": "search"},
...     "output": {"observables": ["amplitude", "phase"]}})
>>> data = afm.run(scene)
>>> dict(data.amplitude.sizes), data.amplitude.units
({'approach_gap': 5}, 'm')

Messages go to the logger ``afmsweep``, doubts to ``warnings`` as `SceneWarning`.
"""

from ._afmsweep import SceneError
from ._design import Design, lognormal, loguniform, normal, triangular, uniform
from ._run import SceneWarning, open, run, run_tree
from ._scene import Scene
from ._study import infer, report, sobol, stats

__all__ = [
    "Design",
    "Scene",
    "SceneError",
    "SceneWarning",
    "infer",
    "loguniform",
    "lognormal",
    "normal",
    "open",
    "report",
    "run",
    "run_tree",
    "sobol",
    "stats",
    "triangular",
    "uniform",
]

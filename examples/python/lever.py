"""The lever of the examples beside this file."""

import afmsweep as afm

SCENE = afm.Scene({
    "instrument": {
        "cantilever": {"stiffness": "42 N/m", "frequency": "300 kHz", "quality_factor": 400},
        "tip": {"radius": "8 nm", "youngs_modulus": "130 GPa", "poisson_ratio": 0.28},
    },
    "sample": {"youngs_modulus": "2.7 GPa", "poisson_ratio": 0.34, "surface_energy": "50 mJ/m^2"},
    "contact": {"law": "dmt"},
    "drive": {"on": "tip", "frequency": "resonance", "free_amplitude": "20 nm"},
    "approach": {"gap": "15 nm"},
    "run": {"steady": "search"},
    "output": {"observables": ["amplitude", "phase", "force_max"]},
})

"""Scenes that run in a blink, and the command beside the package."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import afmsweep as afm
import pytest

# A shell lets what it starts in its background ignore Ctrl-C, and Python then leaves it so. Tests press it.
signal.signal(signal.SIGINT, signal.default_int_handler)

ROOT = Path(__file__).resolve().parents[2]

LEVER = {
    "title": "lever",
    "instrument": {
        "cantilever": {"stiffness": "10 N/m", "frequency": "75 kHz", "quality_factor": 30},
        "tip": {"radius": "10 nm", "youngs_modulus": "130 GPa"},
    },
    "sample": {"youngs_modulus": "2 GPa", "surface_energy": "20 mJ/m^2"},
    "contact": {"law": "dmt"},
    "drive": {"on": "tip", "frequency": "resonance", "free_amplitude": "20 nm"},
    "approach": {"gap": "15 nm"},
    "run": {"steady": "search"},
    "output": {"observables": ["amplitude", "phase", "force_max", "contact_time"]},
}


@pytest.fixture
def scene():
    return afm.Scene(LEVER)


@pytest.fixture(scope="session")
def command():
    """Runs the command that the package brings, in a process of its own."""

    def call(*arguments, check=True, **settings):
        words = [sys.executable, "-m", "afmsweep", *map(os.fspath, arguments)]
        return subprocess.run(words, check=check, capture_output=True, text=True, **settings)

    return call


#: A run of some seconds on any machine, which can be stopped.
LONG = afm.Scene(LEVER).set(
    {
        "run": {"steady": "wait", "periods": 400},
        "sweep": {
            "approach.gap": {"from": "10 nm", "to": "19 nm", "points": 800},
            "sample.youngs_modulus": {"from": "1 GPa", "to": "9 GPa", "points": 80},
        },
    }
)

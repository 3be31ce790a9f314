"""A tip on a thin layer on a rigid ground by the integral equation of Lebedev and Ufliand (1958).

    python layer_contact.py            the rows that the unit test of crates/model/src/contact/layer.rs has
    python layer_contact.py PROGRAM    and the largest difference of `afmsweep force` from them

phi(t) - (1/pi) int_0^a (k(t - s) + k(t + s)) phi(s) ds = depth - profile(t), k(x) = int_0^inf (1 - L(u)) cos(ux) du, phi(a) = 0,
force = 2 E* int phi, in thicknesses of the layer. The program fits series to it; here nothing is fitted.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

GAUSS = np.polynomial.legendre.leggauss
PLACES, WEIGHTS = (0.5 * 40.0 * part for part in (GAUSS(400)[0] + 1.0, GAUSS(400)[1]))
CASES = [(0.5, True), (0.3, True), (0.0, True), (0.3, False)]
RADII = [0.1, 0.4, 1.0, 2.0]


def lacking(poisson, bonded):
    """1 - L at the places of the integral k."""
    fall = np.exp(-2.0 * PLACES)
    if bonded:
        kappa = 3.0 - 4.0 * poisson
        above = kappa * (1.0 - fall**2) - 4.0 * PLACES * fall
        below = kappa * (1.0 + fall**2) + (1.0 + kappa**2 + 4.0 * PLACES**2) * fall
    else:
        above = (1.0 - fall) ** 2
        below = 1.0 - fall**2 + 4.0 * PLACES * fall
    return 1.0 - above / below


def pressed(radius, profile, poisson, bonded, count=80):
    """Depth, and force over E*, at a contact radius."""
    nodes, weights = (0.5 * radius * part for part in (GAUSS(count)[0] + 1.0, GAUSS(count)[1]))
    density = WEIGHTS * lacking(poisson, bonded)
    at = np.append(nodes, radius)[:, None]

    def kernel(x):
        return np.cos(x[..., None] * PLACES) @ density

    matrix = (kernel(at - nodes) + kernel(at + nodes)) * weights / np.pi
    sides = np.stack([np.ones(count), profile(nodes)], axis=1)
    unit, shape = np.linalg.solve(np.eye(count) - matrix[:-1], sides).T
    depth = (profile(radius) + matrix[-1] @ shape) / (1.0 + matrix[-1] @ unit)
    return depth, 2.0 * weights @ (depth * unit - shape)


TIPS = {
    "paraboloid": (lambda t: t * t, lambda depth: 4.0 / 3.0 * depth**1.5),
    "cone": (lambda t: 0.5 * np.pi * t, lambda depth: 2.0 / np.pi * depth**2),
}


def asked(program, tip, poisson, bonded, depths):
    """Force over E* and contact radius that the program tells, for a layer of 1 um, R = 1 um or tan(half-angle) = 1."""
    shape = 'shape = "cone"\nhalf_angle = "45 deg"' if tip == "cone" else 'radius = "1 um"'
    scene = f"""
[instrument.tip]
{shape}
[sample]
youngs_modulus = "{1e5 * (1 - poisson**2)} Pa"
poisson_ratio = {poisson}
thickness = "1 um"
bonded = {str(bonded).lower()}
[contact]
law = "hertz"
"""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "layer.toml"
        file.write_text(scene)
        depths = [f"--indentation={1e-6 * float(depth)!r} m" for depth in depths]
        told = subprocess.run(
            [program, "force", file, "--json", *depths], check=True, capture_output=True, text=True
        )
    curve = json.loads(told.stdout)["curves"][0]
    return np.array(curve["force_n"]) / (1e5 * 1e-12), np.array(curve["contact_radius_m"]) / 1e-6


def main():
    largest = {}
    for tip, (profile, thick) in TIPS.items():
        for poisson, bonded in CASES:
            found = [pressed(radius, profile, poisson, bonded) for radius in RADII]
            for radius, (depth, force) in zip(RADII, found):
                print(f"({poisson}, {str(bonded).lower()}, {radius}, {depth:.9f}, {force / thick(depth):.9f}),", tip)
            if len(sys.argv) > 1:
                depth, force = np.array(found).T
                told, radii = asked(sys.argv[1], tip, poisson, bonded, depth)
                off = np.abs(told / force - 1).max(), np.abs(radii / RADII - 1).max()
                largest[tip] = np.maximum(off, largest.get(tip, (0.0, 0.0)))
    for tip, (force, radius) in largest.items():
        print(f"{tip}: the program's force is off by up to {force:.1e}, its contact radius by {radius:.1e}")
        assert force < (6e-5 if tip == "paraboloid" else 9e-4), tip


if __name__ == "__main__":
    main()

"""A four-sided pyramid on an elastic half-space by boundary elements, beside the factor of Bilodeau (1992).

    python pyramid_half_space.py

The pressure of each element of a grid presses the surface as Love (1929) says; conjugate gradients find the pressures that are
nowhere negative (Polonsky & Keer 1999). A cone, whose factor is known exactly, 2/pi, shows what the grid is worth.
"""

import numpy as np


def factor(profile, count):
    """Force over E* tan(half-angle) depth^2 on a grid of count x count elements."""
    step, depth = 2.0 / count, 0.8
    place = (np.arange(count) - count / 2 + 0.5) * step
    x, y = np.meshgrid(place, place, indexing="ij")
    away = np.arange(2 * count)
    away = np.where(away < count, away, away - 2 * count) * step
    dx, dy = np.meshgrid(away, away, indexing="ij")

    def corner(a, b):
        return a * np.log(b + np.hypot(a, b)) + b * np.log(a + np.hypot(a, b))

    ends = [(sx * sy, dx + sx * step / 2, dy + sy * step / 2) for sx in (1, -1) for sy in (1, -1)]
    response = np.fft.rfft2(sum(sign * corner(a, b) for sign, a, b in ends) / np.pi)

    def pressed(pressure):
        whole = np.fft.rfft2(pressure, (2 * count, 2 * count)) * response
        return np.fft.irfft2(whole, (2 * count, 2 * count))[:count, :count]

    target = depth - profile(x, y)
    pressure = np.maximum(target, 0.0)
    last, keep, way = 1.0, 0.0, np.zeros_like(pressure)
    for _ in range(1000):
        off = pressed(pressure) - target
        inside = pressure > 0.0
        size = (off[inside] ** 2).sum()
        way = np.where(inside, off + keep * size / last * way, 0.0)
        last = size
        length = (off[inside] * way[inside]).sum() / (pressed(way)[inside] * way[inside]).sum()
        pressure = np.maximum(pressure - length * way, 0.0)
        sunk = (pressure <= 0.0) & (off < 0.0)
        pressure[sunk] -= length * off[sunk]
        keep = 0.0 if sunk.any() else 1.0
        if np.sqrt(size / inside.sum()) < 1e-9:
            return pressure.sum() * step**2 / depth**2
    raise SystemExit("the pressures were not found")


cone = factor(np.hypot, 128)
pyramid = factor(lambda x, y: np.maximum(abs(x), abs(y)), 128)
print(f"cone {cone:.5f}, exactly {2 / np.pi:.5f}; pyramid {pyramid:.4f}, by Bilodeau 0.7453")
assert abs(cone * np.pi / 2 - 1.0) < 1e-4
assert abs(0.7453 / pyramid - 1.0) < 0.015, "Bilodeau's factor is no more than an approximation, but a better one"

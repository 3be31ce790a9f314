"""The reference engine against SciPy's integrators.

    python reference_scipy.py PROGRAM SCENE...

Each scene is a rigid base with modes listed one by one and a force on the tip. It is run with
`PROGRAM run SCENE --backend reference`, and once more here: equations of motion and contact laws are written
down anew and integrated with DOP853 and Radau, and every touch, release and turning point is located. Prints
the largest difference of each observable and fails above 1e-8 on its scale.
"""

import math
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import h5py
import numpy as np
from scipy.integrate import solve_ivp

BOUND = 1e-8
# Relative error per step; Radau is of order 5, and what it is given limits what it can reach.
METHODS = {"DOP853": 1e-13, "Radau": 1e-12}
HARMONICS = 10
TAU = 2 * math.pi
UNITS = {"N/m": 1.0, "kHz": 1e3, "nm": 1e-9, "GPa": 1e9, "mJ/m^2": 1e-3}


def si(text):
    number, unit = text.split()
    return float(number) * UNITS[unit]


class Law:
    """Force (N) at indentation d (m) on the branch in contact or out of it, and where the branches end."""

    def __init__(self, scene):
        tip, sample, contact = scene["instrument"]["tip"], scene["sample"], scene["contact"]
        compliance = sum(
            (1 - body["poisson_ratio"] ** 2) / si(body["youngs_modulus"]) for body in (tip, sample)
        )
        self.name = contact["law"]
        self.k = 4 / (3 * compliance)
        self.r = si(tip["radius"])
        self.w = si(sample["surface_energy"])
        self.d0 = si(contact["decay_length"])

    def radius(self, d):
        """JKR's contact radius above the fold, by bisection and Newton's method."""
        k, r, w = self.k, self.r, self.w
        fold = (math.pi * w * r * r / (6 * k)) ** (1 / 3)
        pull = 2 / 3 * math.sqrt(6 * math.pi * w / k)
        if d <= fold**2 / r - pull * math.sqrt(fold):
            return fold
        # delta(a) is convex from the fold on: from above Newton's method only falls.
        a = max(4 * fold, 4 * math.sqrt(r * max(d, 0)))
        for _ in range(100):
            step = (a * a / r - pull * math.sqrt(a) - d) / (2 * a / r - pull / (2 * math.sqrt(a)))
            a -= step
            if abs(step) <= 4e-16 * a:
                break
        return a

    def force(self, d, touching):
        k, r, w, d0 = self.k, self.r, self.w, self.d0
        if self.name == "jkr":
            if not touching:
                return 0.0
            a = self.radius(d)
            return k * a**3 / r - math.sqrt(6 * math.pi * w * k * a**3)
        hertz = k * math.sqrt(r) * max(d, 0) ** 1.5 if touching else 0.0
        if self.name == "hertz":
            return hertz
        pull = 2 * math.pi * w * r
        if touching:
            return hertz - pull
        # Past the surface a tangent, so that a step may overshoot before it is cut.
        return -pull * (d0 / (d0 - d)) ** 2 if d < 0 else -pull * (1 + 2 * d / d0)

    def level(self, touching):
        """Indentation at which the branch ends."""
        if self.name == "jkr" and touching:
            fold = (math.pi * self.w * self.r**2 / (6 * self.k)) ** (1 / 3)
            return -3 * fold**2 / self.r
        return 0.0

    def pull(self):
        """Indentation of JKR's largest pull, -(3/2) pi w R, where a^3 = 3 pi w R^2/(2K)."""
        if self.name != "jkr":
            return None
        a = (1.5 * math.pi * self.w * self.r**2 / self.k) ** (1 / 3)
        return a * a / self.r - 2 / 3 * math.sqrt(6 * math.pi * self.w * a / self.k)


class Instance:
    """Unknowns: each mode's travel over the free amplitude and its rate per radian of the drive's phase; then,
    while measuring, the integrals of what is measured."""

    def __init__(self, scene, method):
        modes = scene["instrument"]["cantilever"]["modes"]
        stiffness = np.array([si(mode["stiffness"]) for mode in modes])
        omega = TAU * np.array([si(mode["frequency"]) for mode in modes])
        quality = np.array([mode["quality_factor"] for mode in modes])
        self.count = len(modes)
        drive = TAU * si(scene["drive"]["frequency"])
        self.length = si(scene["drive"]["free_amplitude"])
        self.gap = si(scene["approach"]["gap"])
        self.law = Law(scene)
        self.method, self.tolerance = method, METHODS[method]
        mobility = omega**2 / stiffness
        each = mobility / (omega**2 - drive**2 + 1j * drive * omega / quality)
        self.level = self.length / abs(each.sum())
        # x'' = a (f + F sin) - b x' - c x, per radian
        self.a = mobility / drive**2 / self.length
        self.b = omega / quality / drive
        self.c = (omega / drive) ** 2
        run = scene["run"]
        self.periods, self.measure = run["periods"], run["measure"]
        self.y = np.zeros(2 * self.count)
        self.start = 0.0
        if run["start"] == "steady":
            free = each * self.level / self.length
            self.start = math.pi / 2 - np.angle(free.sum())
            turned = free * np.exp(1j * self.start)
            self.y = np.concatenate([turned.imag, turned.real])
        self.touching = self.law.name != "none" and self.depth(self.y) > 0

    def depth(self, y):
        return -(self.gap + self.length * y[: self.count].sum())

    def speed(self, y):
        """Rate of the indentation, m per radian."""
        return -self.length * y[self.count : 2 * self.count].sum()

    def rates(self, phase, y):
        n = self.count
        x, v = y[:n], y[n : 2 * n]
        force = self.law.force(self.depth(y), self.touching)
        out = np.zeros_like(y)
        out[:n] = v
        out[n : 2 * n] = self.a * (force + self.level * math.sin(phase)) - self.b * v - self.c * x
        if len(y) > 2 * n:
            z, unit = x.sum(), force / self.level
            order = np.arange(1, HARMONICS + 1) * phase
            out[2 * n : 2 * n + 3] = unit, unit * v.sum(), unit * z
            out[2 * n + 3 :: 2], out[2 * n + 4 :: 2] = z * np.sin(order), z * np.cos(order)
        return out

    def solve(self, span, y, **options):
        return solve_ivp(
            self.rates, span, y, self.method, rtol=self.tolerance, atol=self.tolerance, max_step=0.3, **options
        )

    def land(self, begin, y, guess, value, slope):
        """State where `value` is zero near the phase `guess`: integrated anew up to there, with no
        interpolation, and corrected by Newton's method."""
        phase, y = guess, self.solve((begin, guess), y).y[:, -1]
        for _ in range(4):
            step = -value(y) / slope(phase, y)
            if not abs(step) > 1e-15 * abs(phase):
                break
            y = self.solve((phase, phase + step), y).y[:, -1]
            phase += step
        return phase, y

    def advance(self, begin, end, seen=None):
        """Goes on from one phase to another; notes depths, forces and contacts in `seen`."""
        n = self.count
        while begin < end:
            level, sign = self.law.level(self.touching), -1 if self.touching else 1
            room = lambda y: self.depth(y) - level
            at_end = lambda phase, y: room(y)
            at_end.terminal, at_end.direction = True, sign
            turning = lambda phase, y: self.speed(y)
            path = self.solve((begin, end), self.y, events=[at_end, turning])
            crossed = path.status == 1
            phase, y = end, path.y[:, -1]
            if crossed:
                phase, y = self.land(
                    begin, self.y, path.t_events[0][0], room, lambda _, y: self.speed(y)
                )
            if seen is not None:
                # Where the step ends the branch is on its end exactly.
                depths = [self.depth(self.y), level if crossed else self.depth(y)]
                for turn in path.t_events[1]:
                    if begin < turn < phase:
                        acceleration = lambda t, y: -self.length * self.rates(t, y)[n : 2 * n].sum()
                        depths.append(self.depth(self.land(begin, self.y, turn, self.speed, acceleration)[1]))
                pull = self.law.pull()
                if self.touching and pull is not None and min(depths) <= pull <= max(depths):
                    depths.append(pull)
                seen["force"] += [self.law.force(d, self.touching) for d in depths]
                if self.touching:
                    seen["depth"] += depths
                    seen["time"] += phase - begin
            begin, self.y = phase, y
            if crossed:
                self.touching = not self.touching
                if seen is not None:
                    seen["begun"] += self.touching
        return seen

    def results(self):
        n = self.count
        warm = self.start + TAU * (self.periods - self.measure)
        self.advance(self.start, warm)
        self.y = np.concatenate([self.y, np.zeros(3 + 2 * HARMONICS)])
        seen = self.advance(
            warm, self.start + TAU * self.periods, {"force": [], "depth": [], "time": 0.0, "begun": 0}
        )
        span = TAU * self.measure
        force, work, virial = self.y[2 * n : 2 * n + 3]
        sine, cosine = 2 / span * self.y[2 * n + 3 :: 2], 2 / span * self.y[2 * n + 4 :: 2]
        energy = self.level * self.length
        return {
            "amplitude": self.length * math.hypot(sine[0], cosine[0]),
            "phase": math.degrees(math.atan2(-cosine[0], sine[0])) % 360,
            "force_max": max(seen["force"]),
            "force_min": min(seen["force"]),
            "force_mean": force * self.level / span,
            "indentation_max": max(seen["depth"], default=math.nan),
            "contact_time": seen["time"] / span,
            "dissipation": -work * energy / self.measure,
            "virial": virial * energy / span,
            "contacts": seen["begun"] / self.measure,
            "harmonic_amplitude": self.length * np.hypot(sine, cosine),
        }

    def scale(self, name, truth):
        """What an observable's error counts on; energies on the drive's work in a free period at resonance."""
        if name in ("amplitude", "indentation_max", "harmonic_amplitude"):
            return self.length
        if name.startswith("force"):
            return max(abs(truth["force_max"]), abs(truth["force_min"]))
        if name in ("dissipation", "virial"):
            return math.pi * self.level * self.length
        return math.degrees(1) if name == "phase" else 1.0


def main(program, scenes):
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for path in scenes:
            file = Path(folder) / "results.h5"
            subprocess.run(
                [program, "run", path, "-q", "--overwrite", "--backend", "reference", "-o", file], check=True
            )
            with h5py.File(file) as results:
                ours = {name: item[()] for name, item in results.items() if isinstance(item, h5py.Dataset)}
            scene = tomllib.loads(Path(path).read_text())
            print(scene["title"])
            for method in METHODS:
                instance = Instance(scene, method)
                truth = instance.results()
                off = {
                    name: float(np.max(np.abs(ours[name].ravel() - value)) / instance.scale(name, truth))
                    for name, value in truth.items()
                }
                name, largest = max(off.items(), key=lambda item: math.inf if math.isnan(item[1]) else item[1])
                worst = max(worst, math.inf if math.isnan(largest) else largest)
                print(f"  {method:<8} largest {largest:.1e} ({name});", end=" ")
                print(", ".join(f"{name} {value:.0e}" for name, value in off.items()), flush=True)
    print(f"largest difference {worst:.1e}, bound {BOUND:.0e}")
    return worst <= BOUND


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(not main(sys.argv[1], sys.argv[2:]))

"""SciPy's solve_ivp; JKR's memory by its terminal events."""

import math

import numpy as np
from scipy.integrate import solve_ivp

from peers import LONGEST

METHODS = {"RK45": [1e-3, 1e-5, 1e-7, 1e-9], "DOP853": [1e-3, 1e-5, 1e-7, 1e-9, 1e-11]}


def solvers(problem):
    instances = problem.few
    for method, tolerances in METHODS.items():
        for tolerance in tolerances:

            def run(method=method, tolerance=tolerance):
                pairs = [whole(problem, problem.samples[i], method, tolerance) for i in instances]
                steps = sum(steps for _, steps in pairs) / (len(pairs) * problem.periods)
                return [answer for answer, _ in pairs], steps

            yield f"SciPy {method}", f"{tolerance:.0e}", instances, run


def whole(problem, sample, method, tolerance):
    walk = Walk(problem, sample, method, tolerance)
    state = walk.to(0.0, problem.begin, np.zeros(6))
    walk.path.clear()
    state = walk.to(problem.begin, problem.end, np.append(state, np.zeros(3)))
    answers = []
    for theta, states, touching in walk.path:
        answers.append(problem.answer(sample, theta, states, touching, state[6:]))
    answers[0]["force_max"] = max(answer["force_max"] for answer in answers)
    return answers[0], walk.steps


class Walk:
    """One instance."""

    def __init__(self, problem, sample, method, tolerance):
        self.problem, self.sample = problem, sample
        self.options = {"method": method, "rtol": tolerance, "atol": tolerance, "max_step": LONGEST}
        self.touching = False
        self.steps = 0
        # Pieces between changes of the memory: angles, states, memory.
        self.path = []
        self.force = self.law()

    def law(self):
        sample, name = self.sample, self.problem.law
        kappa = sample["hertz"]
        if name == "hertz":
            return lambda d: kappa * d * math.sqrt(d) if d > 0 else 0.0
        if name == "dmt":
            adhesion, decay = sample["adhesion"], sample["decay"]

            def dmt(d):
                if d > 0:
                    return kappa * d * math.sqrt(d) - adhesion
                share = decay / (decay - d)
                return -adhesion * share * share

            return dmt
        pull, unit = sample["pull"], sample["unit"]
        return lambda d: jkr(pull, unit, d) if self.touching else 0.0

    def rates(self, theta, y):
        x0, x1, x2, v0, v1, v2, *rest = y.tolist()
        (k0, k1, k2), (c0, c1, c2), (s0, s1, s2) = self.problem.stiffness, self.problem.loss, self.problem.share
        cosine = math.cos(theta)
        beyond = x0 + x1 + x2
        force = self.force(-(self.sample["gap"] + cosine + beyond))
        out = [
            v0,
            v1,
            v2,
            s0 * force - c0 * v0 - k0 * x0,
            s1 * force - c1 * v1 - k1 * x1,
            s2 * force - c2 * v2 - k2 * x2,
        ]
        if rest:
            sine = math.sin(theta)
            out += [beyond * cosine, beyond * sine, force * (v0 + v1 + v2 - sine)]
        return out

    def to(self, theta, end, state):
        """From one angle to another, over every change of the memory."""
        if self.problem.law != "jkr":
            return self.integrate(theta, end, state, None)[1]
        while True:
            level = -3 * self.sample["unit"] if self.touching else 0.0

            def event(theta, y):
                return -(self.sample["gap"] + math.cos(theta) + float(y[0] + y[1] + y[2])) - level

            event.terminal = True
            event.direction = -1 if self.touching else 1
            theta, state, found = self.integrate(theta, end, state, event)
            if not found:
                return state
            self.touching = not self.touching

    def integrate(self, theta, end, state, event):
        result = solve_ivp(self.rates, (theta, end), state, events=event, **self.options)
        self.steps += len(result.t) - 1
        self.path.append((result.t, result.y, self.touching))
        return result.t[-1], result.y[:, -1], result.status == 1


def jkr(pull, unit, delta):
    rise = max(delta / unit + 3.0, 1e-20)
    s = 1.0 + math.sqrt(1.0 + math.sqrt(rise / 1.5))
    e = math.sqrt(rise / (1.0 + 2.0 / (s * s)))
    for _ in range(3):
        s = math.sqrt(1.0 + e)
        t = s + 1.0
        e -= ((e * e - rise) * t * t + 2.0 * e * e) / (2.0 * e * t / s * (s * s + s + 1.0))
    cube = (1.0 + e) * math.sqrt(1.0 + e)
    return pull * cube * (cube / 6.0 - 1.0)

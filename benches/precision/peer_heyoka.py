"""heyoka in batch mode: eight Taylor integrators side by side.

Two ways over the place where contact begins. "events": terminal events switch the law, the only way for JKR. "smooth":
no events; the indentation d inside is taken as (d + sqrt(d^2 + width^2))/2, which is faster where that is enough.
"""

import heyoka as hy
import numpy as np

from peers import LONGEST, TAU

# Tolerance, and the width of the rounding (in free amplitudes) that is worth it.
SMOOTH = {
    "hertz": [(1e-4, 1e-3), (1e-7, 1e-3), (1e-11, 1e-4), (1e-14, 1e-5)],
    "dmt": [(1e-4, 1e-4), (1e-7, 1e-4), (1e-9, 1e-4), (1e-11, 1e-5), (1e-14, 1e-6)],
}
EVENTS = [1e-5, 1e-6, 1e-7, 1e-9, 1e-11, 1e-14]
# A Taylor series has nothing to hold to where a law has no derivatives: Hertz's is moved off its beginning by
# this length, and JKR's release stands so far above the fold (in its own unit).
OFF = 1e-8
FOLD = 1e-6
# Places per period from which the largest force is taken.
PLACES = 256
hy.set_logger_level_critical()
WIDTH = hy.recommended_simd_size()
ENSEMBLE = 8 * WIDTH
# Parameters: the sample's, then whether it is in contact.
FIELDS = ("gap", "hertz", "adhesion", "decay", "pull", "unit")
TOUCHING = hy.par[len(FIELDS)]


def solvers(problem):
    every = max(len(problem.samples) // ENSEMBLE, 1)
    instances = list(range(0, len(problem.samples), every))[:ENSEMBLE]
    # Lanes wait for each other: neighbours by their gaps.
    instances.sort(key=lambda i: problem.samples[i]["gap"])
    settings = [("smooth", tolerance, width) for tolerance, width in SMOOTH.get(problem.law, [])]
    settings += [("events", tolerance, OFF) for tolerance in EVENTS]
    for form, tolerance, width in settings:
        walks = [Walk(problem, form, tolerance, width, measuring) for measuring in (False, True)]

        def run(walks=walks):
            answers, steps = [], 0
            for start in range(0, len(instances), WIDTH):
                batch = [problem.samples[i] for i in instances[start : start + WIDTH]]
                found, count = whole(problem, walks, batch)
                answers += found
                steps += count
            return answers, steps / (len(instances) * problem.periods)

        name = f"{tolerance:.0e}" + (f", width {width:.0e}" if form == "smooth" else "")
        yield f"heyoka {form}", name, instances, run


def whole(problem, walks, batch):
    warm, last = walks
    # A batch that is not full is filled up with its last instance.
    filled = batch + [batch[-1]] * (WIDTH - len(batch))
    parameters = np.array([[sample[name] for sample in filled] for name in FIELDS])
    warm.begin(0.0, np.zeros((6, WIDTH)), parameters, np.zeros(WIDTH))
    steps = warm.until(problem.begin)
    state = np.concatenate([warm.integrator.state, np.zeros((3, WIDTH))])
    last.begin(problem.begin, state, parameters, warm.touching())
    theta, states, flags, more = last.through(problem)
    answers = []
    for lane, sample in enumerate(batch):
        path = states[:, :, lane]
        if not np.isfinite(path).all():
            answers.append(None)
            continue
        answers.append(problem.answer(sample, theta, path.T, flags[:, lane], path[-1, 6:]))
    return answers, float((steps + more)[: len(batch)].sum())


class Walk:
    """An integrator for a batch, compiled."""

    def __init__(self, problem, form, tolerance, width, measuring):
        self.law, self.form = problem.law, form
        x = hy.make_vars("x0", "x1", "x2")
        v = hy.make_vars("v0", "v1", "v2")
        sine, cosine = hy.sin(hy.time), hy.cos(hy.time)
        beyond = x[0] + x[1] + x[2]
        delta = -(hy.par[0] + cosine + beyond)
        force = self.smooth(delta, width) if form == "smooth" else self.branches(delta, width)
        system = [(x[k], v[k]) for k in range(3)]
        system += [
            (v[k], problem.share[k] * force - problem.loss[k] * v[k] - problem.stiffness[k] * x[k])
            for k in range(3)
        ]
        if measuring:
            speed = v[0] + v[1] + v[2] - sine
            rates = [beyond * cosine, beyond * sine, force * speed]
            system += list(zip(hy.make_vars("c", "s", "w"), rates))
        self.integrator = hy.taylor_adaptive_batch(
            system,
            np.zeros((len(system), WIDTH)),
            pars=np.zeros((self.parameters(), WIDTH)),
            tol=tolerance,
            t_events=self.events(delta) if form == "events" else [],
        )

    def parameters(self):
        """heyoka wants as many as the system uses."""
        if self.form == "events":
            return len(FIELDS) + 1
        return {"hertz": 2, "dmt": 4}[self.law]

    def smooth(self, delta, width):
        inside = 0.5 * (delta + hy.sqrt(delta * delta + width * width))
        hertz = hy.par[1] * inside**1.5
        if self.law == "hertz":
            return hertz
        share = hy.par[3] / (hy.par[3] - (delta - inside))
        return hertz - hy.par[2] * share * share

    def branches(self, delta, width):
        touching = hy.gt(TOUCHING, 0.5)
        if self.law == "jkr":
            # Ferrari's root y of y^4 - 4y = depth; out of contact of any depth that has one.
            depth = hy.select(touching, delta / hy.par[5], 1.0)
            third = depth / 3.0
            u = (1.0 + hy.sqrt(1.0 + third * third * third)) ** (1.0 / 3.0)
            w = third / u
            s = hy.sqrt(4.0 / (u * u + third + w * w))
            y = 0.5 * (s + hy.sqrt(8.0 / s - s * s))
            cube = y * y * y
            return hy.select(touching, hy.par[4] * cube * (cube / 6.0 - 1.0), 0.0)
        inside = hy.select(touching, delta + width, 1.0)
        hertz = hy.select(touching, hy.par[1] * inside**1.5, 0.0)
        if self.law == "hertz":
            return hertz
        share = hy.par[3] / (hy.par[3] - hy.select(touching, 0.0, delta))
        return hertz - hy.par[2] * share * share

    def events(self, delta):
        flag = len(FIELDS)

        def becomes(value):
            def callback(integrator, sign, lane):
                integrator.pars[flag, lane] = value
                return True

            return callback

        level = (FOLD - 3.0) * hy.par[5] if self.law == "jkr" else 0.0
        up, down = hy.event_direction.positive, hy.event_direction.negative
        return [
            hy.t_event_batch(delta, callback=becomes(1.0), direction=up),
            hy.t_event_batch(delta - level, callback=becomes(0.0), direction=down),
        ]

    def begin(self, theta, state, parameters, touching):
        one = self.integrator
        one.set_time(theta)
        one.state[:] = state
        if self.form == "events":
            one.reset_cooldowns()
            one.pars[: len(FIELDS)] = parameters
            one.pars[len(FIELDS)] = touching
        else:
            one.pars[:] = parameters[: one.pars.shape[0]]

    def touching(self):
        if self.form == "events":
            return self.integrator.pars[len(FIELDS)].copy()
        return np.zeros(WIDTH)

    def until(self, theta):
        """To an angle; the steps of each lane."""
        self.integrator.propagate_until(theta, max_delta_t=LONGEST)
        return self.steps()

    def steps(self):
        return np.array([result[3] for result in self.integrator.propagate_res])

    def through(self, problem):
        """The measured periods: angles, states at them, memory at them, steps."""
        theta = problem.begin + TAU / PLACES * np.arange(problem.measure * PLACES + 1)
        theta[-1] = problem.end
        grid = np.repeat(theta[:, None], WIDTH, axis=1)
        states = self.integrator.propagate_grid(grid, max_delta_t=LONGEST)
        if isinstance(states, tuple):
            states = states[-1]
        delta = -(self.integrator.pars[0] + np.cos(grid) + states[:, :3].sum(axis=1))
        # Deep inside, where the largest force is, JKR's memory is no question.
        return theta, states, delta > 0, self.steps()

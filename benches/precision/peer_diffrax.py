"""diffrax (JAX), the ensemble under vmap. JKR is left out: an event ends a solve, and an ensemble whose members start
anew at each touch and release is another program."""

import functools

import diffrax
import jax
import jax.numpy as jnp
import numpy as np

from peers import LONGEST, TAU

jax.config.update("jax_enable_x64", True)

METHODS = {"Tsit5": diffrax.Tsit5, "Dopri8": diffrax.Dopri8}
TOLERANCES = [1e-3, 1e-5, 1e-7, 1e-9, 1e-11]
# Places per period from which the largest force is taken.
PLACES = 256
# Instances under one vmap.
ENSEMBLE = 64
FIELDS = ("gap", "hertz", "adhesion", "decay", "pull", "unit")


def solvers(problem):
    if problem.law == "jkr":
        return
    every = max(len(problem.samples) // ENSEMBLE, 1)
    instances = list(range(0, len(problem.samples), every))[:ENSEMBLE]
    samples = {name: jnp.array([problem.samples[i][name] for i in instances]) for name in FIELDS}
    for name, method in METHODS.items():
        for tolerance in TOLERANCES:
            ensemble = jax.jit(jax.vmap(functools.partial(whole, problem, method(), tolerance)))
            compiled = ensemble.lower(samples).compile()

            def run(compiled=compiled):
                final, theta, states, steps = (np.asarray(part) for part in compiled(samples))
                answers = [
                    problem.answer(problem.samples[i], theta[n], states[n].T, False, final[n, 6:])
                    for n, i in enumerate(instances)
                ]
                return answers, float(np.mean(steps)) / problem.periods

            yield f"diffrax {name}", f"{tolerance:.0e}", instances, run


def force(law, sample, delta):
    inside = jnp.maximum(delta, 0.0)
    hertz = sample["hertz"] * inside * jnp.sqrt(inside)
    if law == "hertz":
        return hertz
    share = sample["decay"] / (sample["decay"] - jnp.minimum(delta, 0.0))
    return hertz - sample["adhesion"] * share * share


def whole(problem, method, tolerance, sample):
    stiffness, loss, share = (jnp.array(one) for one in (problem.stiffness, problem.loss, problem.share))

    def rates(theta, y, _):
        x, v = y[:3], y[3:6]
        beyond = x.sum()
        cosine = jnp.cos(theta)
        push = force(problem.law, sample, -(sample["gap"] + cosine + beyond))
        out = [v, share * push - loss * v - stiffness * x]
        if y.shape[0] == 9:
            sine = jnp.sin(theta)
            out.append(jnp.stack([beyond * cosine, beyond * sine, push * (v.sum() - sine)]))
        return jnp.concatenate(out)

    def solve(begin, end, state, saveat):
        return diffrax.diffeqsolve(
            diffrax.ODETerm(rates),
            method,
            begin,
            end,
            0.01,
            state,
            saveat=saveat,
            stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=tolerance, dtmax=LONGEST),
            max_steps=None,
            adjoint=diffrax.ForwardMode(),
        )

    warm = solve(0.0, problem.begin, jnp.zeros(6), diffrax.SaveAt(t1=True))
    places = problem.begin + TAU / PLACES * jnp.arange(problem.measure * PLACES + 1)
    places = places.at[-1].set(problem.end)
    start = jnp.concatenate([warm.ys[0], jnp.zeros(3)])
    last = solve(problem.begin, problem.end, start, diffrax.SaveAt(ts=places))
    steps = warm.stats["num_accepted_steps"] + last.stats["num_accepted_steps"]
    return last.ys[-1], places, last.ys, steps

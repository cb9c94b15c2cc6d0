"""The force a model asks for to move as recorded (its inverse dynamics, by the kernel's own laws), and its partials.

Sample by sample; one look at a sample gives the force and all its partials, which the laws write together.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray, IntArray, read_only
from harness.core.jit import compiled
from harness.diagnosis.problems.simulated import factor, frictionless, frictionless_terms, pushed
from harness.kernels.integrate import mode_moving
from harness.kernels.layout import Layout, lay_out
from harness.kernels.rhs import rhs
from harness.kernels.solve import By
from harness.kernels.work import SPARE, Work, workspace
from harness.model.covariate import Acts
from harness.model.law import MASS
from harness.model.model import Model
from harness.model.term import History

Numbers: TypeAlias = tuple[By | None, ...]
"""Numbers of a model."""
NOWHERE: Final = -1
"""Of a number that the force does not hang on."""
OFFSET: Final = -2
"""Of the sensor's zero, which is no place in theta."""


def _by_samples(
    t: FloatArray,
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    inside: FloatArray,
    inside_by: FloatArray,
    m: float,
    weight: FloatArray,
    places: IntArray,
    w: Work,
    force: FloatArray,
    by: FloatArray,
) -> None:
    """Weight m (a - acceleration without drive) at every sample, and its partials by ``places``.

    inside (n, k) : internal states beyond x and v; inside_by (k, n, q) : their partials, of size 0 where there are
    none. force (n,), by (n, q) : filled.
    """
    for n in range(t.size):
        w.z[0], w.z[1] = x[n], v[n]
        for i in range(inside.shape[1]):
            w.z[2 + i] = inside[n, i]
        rhs(SPARE, t[n], w.z, mode_moving(v[n], w), 0.0, w)
        left = a[n] - w.ks[SPARE, 1]
        force[n] = weight[n] * m * left
        for q in range(places.size):
            moved = 0.0
            if places[q] >= 0:
                moved = -m * w.by_theta[1, places[q]]
                if places[q] == MASS:
                    moved += left
            elif places[q] == OFFSET:
                moved = m * w.jac[1, 0]
            for i in range(inside_by.shape[0]):
                moved -= m * w.jac[1, 2 + i] * inside_by[i, n, q]
            by[n, q] = weight[n] * moved


by_samples = compiled(_by_samples)


def asked(
    model: Model,
    t: FloatArray,
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    given: Mapping[str, FloatArray],
    by: Numbers = (),
) -> tuple[FloatArray, FloatArray]:
    """Force (n,), N, that moves a model through x (as its sensor shows it), v, a (n,) at t (n,), s.

    And its partials (n, q) by numbers of it. given : the model's covariates as they were measured, by name, (n,).
    Internal states are as each term says that the motion leaves them; what it says nothing of moves with the slider.
    None is a number that the model has not.
    """
    motion, ones = (t, x, v, a), np.ones(t.size)
    if not model.covariates:
        return _asked(model, motion, ones, by)
    dry, wet = (factor(model, given, acts) for acts in (Acts.FRICTION, Acts.DAMPING))
    if dry.ndim:
        # all of it by the factor, and what is no friction back to what it was
        force, partials = _asked(model, motion, dry, by)
        bare, bare_partials = _asked(frictionless(model), motion, dry - 1.0, _without_friction(model, by))
        force, partials = force - bare, partials - bare_partials
    else:
        force, partials = _asked(model, motion, ones, by)
    slowed = (wet - 1.0) * v
    force = force + model.c * slowed - pushed(model, given)
    for q, number in enumerate(by):
        if number == "c":
            partials[:, q] += slowed
        for one in model.covariates:
            if number not in one.fitted:
                continue
            effect = one.effect_by(str(number), given[one.name])
            match one.acts:
                case Acts.FORCE:
                    partials[:, q] = -effect
                case Acts.DAMPING:
                    partials[:, q] = model.c * np.where(wet > 0.0, effect, 0.0) * v
                case Acts.FRICTION:
                    effect = np.where(dry > 0.0, effect, 0.0)
                    partials[:, q] = _asked(model, motion, effect)[0] - _asked(frictionless(model), motion, effect)[0]
    return force, partials


Motion: TypeAlias = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""t (s), x, v, a, each (n,)."""


def _asked(model: Model, motion: Motion, weight: FloatArray, by: Numbers = ()) -> tuple[FloatArray, FloatArray]:
    """The same without covariates, each sample times its weight (n,)."""
    t, x, v, a = (read_only(y) for y in motion)
    layout = lay_out(model, max(float(np.max(np.abs(v))), 1e-300))
    places = np.array([_place(number, layout) for number in by], dtype=np.int64)
    inside, inside_by = _states_inside(model, layout, t, v, by)
    work = workspace(
        layout.spec, layout.theta, len(layout.names), np.empty(0, np.int64), np.ones(layout.start.size), layout.start,
        np.zeros((layout.start.size, 0)),
    )  # fmt: skip
    force, partials = np.empty(t.size), np.empty((t.size, len(by)))
    by_samples(t, x - model.offset, v, a, inside, inside_by, model.m, weight, places, work, force, partials)
    return force, partials


def _states_inside(
    model: Model, layout: Layout, t: FloatArray, v: FloatArray, by: Numbers = ()
) -> tuple[FloatArray, FloatArray]:
    """Internal states (n, k) as the motion leaves them, and their partials (k, n, q) by numbers of the model.

    The partials are of size 0 where no state hangs on any of them.
    """
    count = layout.start.size - 2
    inside, moved = np.zeros((t.size, count)), np.zeros((count if by else 0, t.size, len(by)))
    if count == 0:
        return inside, moved
    inside[:, [i - 2 for i in layout.speeds if i > 1]] = v[:, None]
    motion = History(t, v, t, v, model.f_k)
    for i, (names, entry) in enumerate(zip(model.internal_names, model.terms, strict=True)):
        if entry.term.implied is None:
            continue
        columns = [layout.state_names.index(name) - 2 for name in names]
        states = entry.term.implied(entry.values, motion)
        inside[:, columns] += states.values
        for key, partials in states.by.items():
            number = (i, key) if isinstance(key, int) else key
            if number in by:
                moved[columns, :, by.index(number)] = partials.T
    return inside, moved


def _place(number: By | None, layout: Layout) -> int:
    """Where a number stands in theta, or why not."""
    if isinstance(number, tuple):
        return layout.term_at[number[0]] + number[1]
    if number == "offset":
        return OFFSET
    return layout.names.index(number) if number in layout.names else NOWHERE


def _without_friction(model: Model, by: Numbers) -> Numbers:
    """The numbers as they stand in the model without friction; None for those that are gone."""
    kept = frictionless_terms(model)

    def there(number: By | None) -> By | None:
        if isinstance(number, tuple):
            return (kept.index(number[0]), number[1]) if number[0] in kept else None
        return None if number == "f_k" else number

    return tuple(there(number) for number in by)


def given_force(
    model: Model, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray, given: Mapping[str, FloatArray]
) -> FloatArray:
    """Force (n,), N, that moves a model as in ``asked``."""
    return asked(model, t, x, v, a, given)[0]


def inverse_force(model: Model, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """The same, covariates apart."""
    return given_force(replace(model, covariates=()), t, x, v, a, {})

"""The force a model asks for to move as recorded (its inverse dynamics, by the kernel's own laws), and its partials.

As means over blocks of samples; one look at a sample gives the force and all its partials, which the laws write
together.

The force a model asks for to move as recorded, sample by sample.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray, read_only
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


def _by_blocks(
    t: FloatArray,
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    inside: FloatArray,
    inside_by: FloatArray,
    m: float,
    weight: FloatArray,
    counts: BoolArray,
    places: IntArray,
    w: Work,
    force: FloatArray,
    by: FloatArray,
) -> None:
    """Means of weight m (a - acceleration without drive) over the blocks that count, and their partials by ``places``.

    inside (n, k) : internal states beyond x and v; inside_by (k, n, q) : their partials, of size 0 where there are
    none. force (b,), by (b, q) : filled, row by row for each block that counts.
    """
    length, row = t.size // counts.size, 0
    for block in range(counts.size):
        if not counts[block]:
            continue
        force[row] = 0.0
        for q in range(places.size):
            by[row, q] = 0.0
        for n in range(block * length, (block + 1) * length):
            w.z[0], w.z[1] = x[n], v[n]
            for i in range(inside.shape[1]):
                w.z[2 + i] = inside[n, i]
            rhs(SPARE, t[n], w.z, mode_moving(v[n], w), 0.0, w)
            share = weight[n] / length
            left = a[n] - w.ks[SPARE, 1]
            force[row] += share * m * left
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
                by[row, q] += share * moved
        row += 1


by_blocks = compiled(_by_blocks)


@dataclass(frozen=True, slots=True)
class Path:
    """A motion t (s), x, v, a, each (n,), its covariates by name (n,), and which of its blocks (n / block,) count."""

    t: FloatArray
    x: FloatArray
    v: FloatArray
    a: FloatArray
    given: Mapping[str, FloatArray]
    counts: BoolArray

    def means(self, y: FloatArray) -> FloatArray:
        """Means of y (n,) or (n, q) over the blocks that count."""
        found: FloatArray = y.reshape(self.counts.size, -1, *y.shape[1:]).mean(axis=1)[self.counts]
        return found


def asked(model: Model, path: Path, by: Numbers = ()) -> tuple[FloatArray, FloatArray]:
    """Force (b,), N, that a model asks for, mean over the blocks that count, and its partials (b, q) by numbers of it.

    Covariates act as they were measured. Internal states are as each term says that the motion leaves them; what it
    says nothing of moves with the slider. None is a number that the model has not.
    """
    if not model.covariates:
        return _asked(model, path, np.ones(path.t.size), by)
    dry, wet = (factor(model, path.given, acts) for acts in (Acts.FRICTION, Acts.DAMPING))
    if dry.ndim:
        # all of it by the factor, and what is no friction back to what it was
        force, partials = _asked(model, path, dry, by)
        bare, bare_partials = _asked(frictionless(model), path, dry - 1.0, _without_friction(model, by))
        force, partials = force - bare, partials - bare_partials
    else:
        force, partials = _asked(model, path, np.ones(path.t.size), by)
    slowed = path.means(wet * path.v) - path.means(path.v) if wet.ndim else np.zeros(force.size)
    force = force + model.c * slowed - path.means(np.broadcast_to(pushed(model, path.given), path.t.shape))
    for q, number in enumerate(by):
        if number == "c":
            partials[:, q] += slowed
        for one in model.covariates:
            if number not in one.fitted:
                continue
            effect = one.effect_by(str(number), path.given[one.name])
            match one.acts:
                case Acts.FORCE:
                    partials[:, q] = -path.means(effect)
                case Acts.DAMPING:
                    partials[:, q] = model.c * path.means(np.where(wet > 0.0, effect, 0.0) * path.v)
                case Acts.FRICTION:
                    effect = np.where(dry > 0.0, effect, 0.0)
                    partials[:, q] = _asked(model, path, effect)[0] - _asked(frictionless(model), path, effect)[0]
    return force, partials


def _asked(model: Model, path: Path, weight: FloatArray, by: Numbers = ()) -> tuple[FloatArray, FloatArray]:
    """The same without covariates, each sample times its weight (n,)."""
    layout = lay_out(model, max(float(np.max(np.abs(path.v))), 1e-300))
    places = np.array([_place(number, layout) for number in by], dtype=np.int64)
    inside, inside_by = _states_inside(model, layout, path.t, path.v, by)
    work = workspace(
        layout.spec, layout.theta, len(layout.names), np.empty(0, np.int64), np.ones(layout.start.size), layout.start,
        np.zeros((layout.start.size, 0)),
    )  # fmt: skip
    size = int(np.count_nonzero(path.counts))
    force, partials = np.empty(size), np.empty((size, len(by)))
    by_blocks(
        read_only(path.t), path.x - model.offset, read_only(path.v), read_only(path.a), inside, inside_by, model.m,
        weight, path.counts, places, work, force, partials,
    )  # fmt: skip
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
    """Force (n,), N, that moves the model through x (as its sensor shows it), v, a (n,) at t (s).

    given : the model's covariates as they were measured, by name, (n,).
    """
    return asked(model, Path(t, x, v, a, given, np.ones(t.size, dtype=np.bool_)))[0]


def inverse_force(model: Model, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """The same, covariates apart."""
    return given_force(replace(model, covariates=()), t, x, v, a, {})

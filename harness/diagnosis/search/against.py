"""What speaks against a model, by which models of one recording are held against each other.

What a law takes off a misfit in company: beside the other law with which it leaves least.

Several small effects that sum up to one law are told as well by two others, or by one other and less of that law; a
main effect keeps what it takes.
"""

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.model_fit import Fit, of_laws
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.force_noise import FAR
from harness.diagnosis.rules import SHAPE_WIDTH
from harness.model.registry import term
from harness.model.term import Term

_BRIEF = 1e-6
"""Share of a recording that a moment is never told more exactly than."""


def against(found: Fit, problem: Problem) -> float:
    """BIC, and what a moment costs beyond it; beside a force whose noise moves reversals a sample is no further out
    than far.

    Such noise puts single samples on the other side of a jump of the acceleration, and whatever law moves that reversal
    puts them back. What it may leave (``Problem.spare``) is drawn with the same bound.
    """
    size = found.bic + _scanned(found, problem.duration)
    return size if problem.spare <= 0.0 else size - far_out(found)


def _scanned(found: Fit, span: float) -> float:
    """What BIC asks too little for a moment that was looked for all along a recording of ``span``, s, at least 0.

    Chance has as many tries as there are moments that can be told apart.
    """
    if not any(one.moment for entry in found.model.terms for one in entry.term.parameters):
        return 0.0
    told = (number.error for number in of_laws(found) if number.parameter.moment)
    return sum(max(_costs(span, max(error, _BRIEF * span)) - _full(found), 0.0) for error in told)


def _costs(width: float, error: float) -> float:
    """What a number costs that may be anywhere within a width and is told with a standard error, twice a logarithm."""
    return 2.0 * math.log(max(width / (math.sqrt(2.0 * math.pi) * error), 1.0))


def far_out(found: Fit) -> float:
    """Chi-square of single samples beyond what one that is far out says."""
    return float(np.sum(np.maximum(found.residual**2 - FAR**2, 0.0)))


def among_names(found: Fit, problem: Problem) -> float:
    """What speaks against a model beside one of another name: BIC, less what it asks of a shape that is hardly told.

    BIC takes a number for one that the recording tells as well as it does the others. The speed over which friction
    falls, which could be twice as large, has fitted little: it costs 2 ln of its width before over its width after,
    the integral over it by Laplace (MacKay 2003, Information Theory, Inference, and Learning Algorithms, 28.1).
    """
    return against(found, problem) - untold(found)


def untold(found: Fit) -> float:
    """What BIC takes too much for numbers that shape laws, at least 0."""
    full, spare = _full(found), 0.0
    # a speed or a length that the motion does not come to shapes nothing: there a law is another one's limit
    reach = {"m": float(np.max(np.abs(found.shown.x))), "m/s": float(np.max(np.abs(found.shown.v)))}
    for number in of_laws(found):
        width = _width(number.law, number.which)
        if width > 0.0 and number.error > 0.0 and number.value <= reach.get(number.parameter.unit, math.inf):
            error = number.error / (number.value if number.parameter.positive else 1.0)
            spare += max(full - _costs(width, error), 0.0)
    return spare


def _full(found: Fit) -> float:
    """What BIC asks for one number."""
    return math.log(max(found.points, 2))


def _width(law: Term, which: int) -> float:
    """Width of what a number that shapes a law may be, of its logarithm where it is positive; 0 of any other."""
    number, amplitude = law.parameters[which], term(law.frees).amplitude if law.frees else law.amplitude
    if amplitude is None or which == amplitude:
        return 0.0
    if number.positive:
        return math.log(SHAPE_WIDTH.value)
    span = number.upper - number.lower
    return span if math.isfinite(span) else 0.0


def in_turn(fits: Sequence[Fit], problem: Problem) -> tuple[Fit, ...]:
    """The one that least speaks against first."""
    return tuple(sorted(fits, key=lambda f: against(f, problem)))


class Fitted(Protocol):
    """residual (N,) of a fit, and its partials (N, q) by what is free."""

    @property
    def residual(self) -> FloatArray:
        """Data minus model."""

    @property
    def jacobian(self) -> FloatArray:
        """Of the model."""


def in_company(law: Fitted, others: Sequence[Fitted], base: Fitted) -> float:
    """Squares that a law takes off a base model's, in units of the residual, beside the other it leaves least with.

    Each fitted law counts with what it changes of the motion times a size that is free, the base model's numbers being
    free besides, to first order. Of what the two take together the law's is the mean of what it takes first and of what
    it takes last (Lindeman, Merenda and Gold 1980; Groemping 2006, J. Stat. Softw. 17, 1); without others it is all
    that it takes. law, others : fits to the same samples under the same noise as ``base``.
    """
    changes = [base.residual - one.residual for one in (law, *others)]
    left, *seen = _beside(base, np.column_stack([base.residual, *changes])).T
    alone, *each = (_taken(left, [one]) for one in seen)
    if not each:
        return alone
    both = [_taken(left, [seen[0], one]) for one in seen[1:]]
    best = int(np.argmax(both))
    return 0.5 * (alone + both[best] - each[best])


def taken_by_two(laws: Sequence[Fitted], base: Fitted) -> FloatArray:
    """Squares (m, m) that each two of m laws take off a base model's together, as ``in_company`` counts them."""
    left, *seen = _beside(base, np.column_stack([base.residual, *(base.residual - one.residual for one in laws)])).T
    return np.array([[_taken(left, [one, other]) for other in seen] for one in seen])


def _beside(base: Fitted, columns: FloatArray) -> FloatArray:
    """What of columns (N, m) the base model's numbers cannot do."""
    size = np.linalg.norm(base.jacobian, axis=0)
    partials = base.jacobian[:, size > 0.0] / size[size > 0.0]
    found: FloatArray = columns - partials @ np.linalg.lstsq(partials, columns, rcond=None)[0]
    return found


def _taken(left: FloatArray, changes: Sequence[FloatArray]) -> float:
    """Squares of ``left`` (N,) that columns (N,) of free sizes take together."""
    size = [float(np.linalg.norm(one)) for one in changes]
    a = np.column_stack([one / s for one, s in zip(changes, size, strict=True) if s > 0.0] or [np.zeros(left.size)])
    along = a.T @ left
    return float(along @ np.linalg.lstsq(a.T @ a, along, rcond=1e-9)[0])

"""Tables that stay, as people see them: curves and a surface with bands, in words, beside the nearest laws."""

from dataclasses import dataclass, replace

from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.outcome import Surface, Table
from harness.diagnosis.problem import Problem
from harness.diagnosis.tables.curve import table_of
from harness.diagnosis.tables.describe import described
from harness.diagnosis.tables.nearest import nearest
from harness.diagnosis.tables.plane import surface_of
from harness.diagnosis.tables.selection import Tabulated
from harness.kernels.solve import Scales
from harness.model.evidence import Evidence
from harness.model.model import Model
from harness.model.term import Slot, Term


@dataclass(frozen=True, slots=True)
class Drawn:
    """What a rung's tables look like. tables : curves, each with its places among the model's terms.

    surface : the same of the one that hangs on both; None where there is none.
    """

    tables: tuple[tuple[tuple[int, ...], Table], ...]
    surface: tuple[int, Surface] | None

    @classmethod
    def of(
        cls,
        first: Tabulated,
        start: Model,
        problem: Problem,
        strokes: Strokes,
        scales: Scales,
        held: float,
        seen: Evidence,
    ) -> "Drawn":
        """The tables of a rung, on top of ``start``.

        strokes : of the residual. scales : what they were fitted in. held : held-out error with them, over that
        without. seen : of what ``start`` leaves, for laws that are near.
        """
        found, named = first.fit, len(start.terms)
        tables = []
        for numbers, form in curves(first, named):
            table = table_of(found, strokes, scales, numbers, form, held)
            said = described(table, found.model, problem.angular)
            tables.append(
                (numbers, replace(table, described=said, nearest=nearest(table, start, problem, scales, seen)))
            )
        both = _plane(first, named)
        if both is None:
            return cls(tuple(tables), None)
        return cls(tuple(tables), (both, surface_of(found, strokes, scales, both, held, problem.angular)))


def curves(first: Tabulated, named: int) -> list[tuple[tuple[int, ...], str]]:
    """The tables of a rung that are curves: places among the model's terms, and what each is a function of."""
    found: list[tuple[tuple[int, ...], str]] = []
    for i, term in enumerate(first.rung.terms, start=named):
        assert term.known is not None
        if term.known.of == "-v":
            # the other direction of the one before
            found[-1] = ((*found[-1][0], i), found[-1][1])
        elif term.known.of != "x, v":
            found.append(((i,), _forms(term)))
    return found


def _plane(first: Tabulated, named: int) -> int | None:
    """The place among the model's terms of a rung's table over both, None where it has none."""
    kinds = [term.known.of for term in first.rung.terms if term.known is not None]
    return named + kinds.index("x, v") if "x, v" in kinds else None


def _forms(term: Term) -> str:
    assert term.known is not None
    if term.slot is Slot.FRICTION_MODULATION:
        return "g(x) sgn v"
    return {"x": "f(x)", "v": "f(v)", "|v|": "f(|v|) sgn v"}[term.known.of]

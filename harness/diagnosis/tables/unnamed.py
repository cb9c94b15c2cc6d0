"""Whether a smooth curve of no name says more of a misfit than any name does: of the position, or of the speed.

A law that nobody knows is followed in part by one or another of the catalogue; a table follows all of it.
"""

from dataclasses import replace

from harness.diagnosis.baseline.words import margin_of
from harness.diagnosis.grading.contest import decided, shown_as_part
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.outcome import Grade
from harness.diagnosis.parameters import base_of
from harness.diagnosis.rules import MARGIN
from harness.diagnosis.tables.basis import RUNGS
from harness.diagnosis.tables.beside import MotionLeft

_CURVES = tuple(rung for rung in RUNGS if rung.said in ("f(x)", "f(|v|) sgn v", "f(v)"))


def beside_curves(graded: Graded) -> Graded:
    """The grades of a motion's misfit beside a smooth curve: what is named, or listed, may then be neither."""
    if graded.grade not in (Grade.MAIN, Grade.ONE_OF):
        return graded
    misfit, first = graded.misfit, graded.named[0].fit
    left, noise = MotionLeft(misfit, misfit.base.model, base_of(misfit.base.free)), misfit.noise_left(first)
    curves = [curve for curve in map(left.fitted, _CURVES) if curve is not None]
    gains = [misfit.evidence_by(curve.squares, curve.effective, noise) for curve in curves]
    ahead = max(gains, default=0.0) - misfit.evidence_of(first, noise) - margin_of(misfit.words)
    seen = replace(graded, ahead=ahead)
    again = decided(seen)
    if (again.grade, [f.name for f in again.named]) == (graded.grade, [f.name for f in graded.named]):
        return seen
    as_seen = {f.name: f for f in graded.named}
    named = tuple(as_seen.get(f.name, f) for f in again.named)
    return shown_as_part(replace(again, named=named, rules=(*again.rules, MARGIN)))

"""A first look at the whole catalogue: how much would each term explain, to first order?

A term whose amplitude is zero leaves the motion as it is, but its sensitivity says how the motion would answer. One
simulation carries the answers of hundreds of probes; what each would take off chi-square, with the base parameters
free to follow, is a projection of the residual (the score test). It costs a simulation, not a fit.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.cores import each
from harness.core.errors import SimulationError
from harness.diagnosis.fit.bounds import brought_within
from harness.diagnosis.fit.model_fit import Fit, evaluate, whitened
from harness.diagnosis.parameters import free_of, with_values
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import COARSE
from harness.diagnosis.search.few_pieces import for_looks
from harness.kernels.solve import By, Scales
from harness.model.model import Model, ModelTerm
from harness.model.term import SINGLE, Evidence, Slot, Term
from harness.model.term import Probe as TermProbe

_SAMPLES = 2000
_COLUMNS = 120
_INTERNAL_AT_ONCE = 4
"""Samples, and columns and laws with states of their own that are simulated at once: they bound time and memory."""
_KEPT = 2
"""Probes of a law that go on."""
_SEEN, _OWN = 1e-10, 1e-9
"""Of a column: below it what was fitted already says the same, or rounding alone is left of an answer."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A term with starting values, the rest of the model moved to meet it, and what it promises to take off chi2.

    short : where the model was to move further than one look can tell of: as far along the same way as it may.
    """

    term: Term
    model: Model
    gain: float
    short: Model | None = None


@dataclass(frozen=True, slots=True)
class _Probe:
    term: Term
    values: tuple[tuple[float, ...], ...]  # one set, or cosine and sine


@dataclass(frozen=True, slots=True)
class _Answer:
    """A probe with the amplitudes (m,) that take most off, the values they come to and the gain; along (q, m) : how far
    the motion answers each as it answers what is fitted.
    """

    probe: _Probe
    values: tuple[float, ...]
    gain: float
    amplitudes: FloatArray
    along: FloatArray


def applicable(term: Term, model: Model, problem: Problem) -> bool:
    """Whether a term can be added to a model of this recording at all."""
    recorded = all(c in problem.channels for c in term.channels)
    given = problem.given | ({"spring"} if model.k > 0.0 else frozenset())
    met = given.issuperset(term.needs)
    taken = term.slot in SINGLE and bool(model.in_slot(term.slot))
    once = not term.several and any(e.term.name == term.name for e in model.terms)
    return recorded and met and not (taken or once)


def _probes(term: Term, evidence: Evidence) -> Iterator[_Probe]:
    values = list(term.probes(evidence))
    if term.phase is None:
        yield from (_Probe(term, (v,)) for v in values)
    else:
        yield from (_Probe(term, (values[i], values[i + 1])) for i in range(0, len(values), 2))


def _batches(probes: Sequence[_Probe]) -> Iterator[list[_Probe]]:
    """Probes that may share one simulation."""
    shared, internal, sensors = [], [], []
    for probe in probes:
        if probe.term.slot in SINGLE:
            yield [probe]
        elif probe.term.slot is Slot.INTERNAL:
            internal.append(probe)
        elif probe.term.slot is Slot.OBSERVATION:
            sensors.append(probe)
        else:
            shared.append(probe)
    if sensors:
        yield sensors
    for i in range(0, len(internal), _INTERNAL_AT_ONCE):
        yield internal[i : i + _INTERNAL_AT_ONCE]
    batch: list[_Probe] = []
    for probe in shared:
        batch.append(probe)
        if sum(len(p.values) for p in batch) >= _COLUMNS:
            yield batch
            batch = []
    if batch:
        yield batch


def _responses(model: Model, problem: Problem, batch: list[_Probe], scales: Scales) -> FloatArray:
    """Whitened answers (N, m) of the channels to each probe's amplitude."""
    first = len(model.terms)
    entries: list[ModelTerm] = []
    by: list[By] = []
    for probe in batch:
        for values in probe.values:
            amplitude = probe.term.amplitude
            assert amplitude is not None
            by.append((first + len(entries), amplitude))
            entries.append(ModelTerm(probe.term, values))
    extended = replace(model, terms=(*model.terms, *entries))
    shown = problem.shows(extended, tuple(by), scales, COARSE)
    return whitened(problem, shown.dy)


def with_amplitudes(term: Term, start: TermProbe, amplitudes: FloatArray) -> TermProbe:
    """Parameter values of a term's probe with its linear amplitude, or cosine and sine (1 or 2,), put in."""
    index, values = term.amplitude, list(start)
    assert index is not None
    if term.phase is not None:
        values[index] = float(np.hypot(amplitudes[0], amplitudes[1]))
        values[term.phase] = float(np.arctan2(-amplitudes[1], amplitudes[0]))
    else:
        values[index] += float(amplitudes[0])
    return tuple(values)


def _combined(probe: _Probe, amplitudes: FloatArray) -> tuple[float, ...] | None:
    """Parameter values for these amplitudes, None where they lie out of bounds."""
    index = probe.term.amplitude
    assert index is not None
    values = list(with_amplitudes(probe.term, probe.values[0], amplitudes))
    parameter = probe.term.parameters[index]
    if probe.term.phase is not None:
        values[index] = min(values[index], parameter.upper)
    lower = probe.values[0][index] if probe.term.slot is Slot.FRICTION_LEVEL else parameter.lower
    return tuple(values) if lower <= values[index] <= parameter.upper else None


def screen(
    current: Fit, problem: Problem, evidence: Evidence, scales: Scales, terms: Sequence[Term]
) -> list[Candidate]:
    """Candidates among ``terms`` with a linear amplitude, the best probes of each, most promising first."""
    small, scale_up = for_looks(current, problem, scales, _SAMPLES)
    residual, jacobian, _ = evaluate(current.model, small, current.free, scales, COARSE)
    norm = np.sqrt(np.sum(jacobian**2, axis=0))
    norm[norm == 0.0] = 1.0
    q, r = np.linalg.qr(jacobian / norm)
    usable = np.abs(np.diag(r)) > _SEEN
    found: dict[str, list[_Answer]] = {}
    probes = [
        p
        for term in terms
        if term.amplitude is not None and applicable(term, current.model, problem)
        for p in _probes(term, evidence)
    ]

    def answered(batch: list[_Probe]) -> FloatArray | None:
        with suppress(SimulationError):
            return _responses(current.model, small, batch, scales)
        return None

    def added(shift: FloatArray, term: Term, values: tuple[float, ...]) -> Model:
        """The model moved, with one term more; an amplitude is as long as its linear look says, so within bounds."""
        moved = _moved(current, shift)
        model = replace(moved, terms=(*moved.terms, ModelTerm(term, values)))
        return brought_within(model, free_of(model, ()), problem, scales)

    batches = list(_batches(probes))
    for batch, answers in zip(batches, each(answered, batches), strict=True):
        if answers is None:
            continue
        along = q.T @ answers
        across = answers - q @ along
        size, whole = (np.sqrt(np.sum(columns**2, axis=0)) for columns in (across, answers))
        own = (size > _OWN * whole) & (size > 0.0)
        projected = across.T @ residual
        column = 0
        for probe in batch:
            here = slice(column, column + len(probe.values))
            column = here.stop
            if not np.all(own[here]):
                continue
            part = across[:, here]
            amplitudes = np.asarray(np.linalg.lstsq(part.T @ part, projected[here], rcond=1e-12)[0], dtype=np.float64)
            values = _combined(probe, amplitudes)
            if values is not None and np.all(np.isfinite(values)):
                gain = float(projected[here] @ amplitudes) * scale_up
                found.setdefault(probe.term.key, []).append(_Answer(probe, values, gain, amplitudes, along[:, here]))

    def candidate(answer: _Answer) -> Candidate:
        probe, term = answer.probe, answer.probe.term
        shift = np.zeros(len(current.free))
        if np.all(usable):
            shift = -np.linalg.solve(r, answer.along @ answer.amplitudes) / norm
        share = _share_of(current, shift)
        part_way = _combined(probe, share * answer.amplitudes) if share < 1.0 else None
        short = None if part_way is None else added(share * shift, term, part_way)
        return Candidate(term, added(shift, term, answer.values), answer.gain, short)

    best = [a for group in found.values() for a in sorted(group, key=lambda a: -a.gain)[:_KEPT]]
    return [candidate(a) for a in sorted(best, key=lambda a: -a.gain)]


def _limit(current: Fit) -> FloatArray:
    """How far each number of a model may be moved, (q,): one that is never negative by no more than half."""
    of = zip(current.free, current.values, strict=True)
    return np.array([0.5 * abs(v) if f.log or f.lower == 0.0 else np.inf for f, v in of])


def _share_of(current: Fit, shift: FloatArray) -> float:
    """Share of a shift (q,) that moves no number too far."""
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(shift != 0.0, _limit(current) / np.abs(shift), np.inf)
    return min(1.0, float(np.min(shares, initial=1.0)))


def _moved(current: Fit, shift: FloatArray) -> Model:
    """The current model with its numbers moved as the new term asks, within their bounds and by no more than half."""
    values, limit = current.values, _limit(current)
    moved = values + np.clip(shift, -limit, limit)
    moved = np.array([min(max(v, f.lower), f.upper) for f, v in zip(current.free, moved, strict=True)])
    return with_values(current.model, current.free, moved)


def direct(current: Fit, problem: Problem, evidence: Evidence, terms: Sequence[Term]) -> list[Candidate]:
    """Candidates among ``terms`` without a linear amplitude: every probe is a start; they promise nothing yet."""
    return [
        Candidate(term, replace(current.model, terms=(*current.model.terms, ModelTerm(term, values))), 0.0)
        for term in terms
        if term.amplitude is None and applicable(term, current.model, problem)
        for values in (term.probes(evidence) or ([()] if not term.parameters else []))
    ]

"""What each of several recordings has of its own, in the form of the results."""

from collections.abc import Sequence

import numpy as np

from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.diagnosis.fit.rmse import rmse
from harness.diagnosis.fit.standard_errors import numbers_of
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pooling.pooled import differences
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.together import Together
from harness.model.elsewhere import named
from harness.results.common import P
from harness.results.diagnosis import OwnResult


def own_results(recordings: Sequence[Recording], outcome: Outcome) -> list[OwnResult]:
    """Start, zero, noise and errors of each recording, and in what it differs from the first."""
    problem, refined, pooled = outcome.problem, outcome.refined, outcome.pooled
    assert isinstance(problem, Together | ForcesTogether)
    assert pooled is not None
    explained = outcome.verdict in ("adequate", "missing_physics")
    length = "rad" if problem.angular else "m"
    numbers = numbers_of(refined, problem, outcome.scales.omega, explained)
    differ = differences(refined, problem, outcome.scales.omega, explained)
    first = recordings[0].file
    errors = _of_starts(problem)
    found = []
    runs = problem.runs(refined.model)
    for r, (one, at, alone) in enumerate(zip(recordings, problem.places, problem.alone, strict=True)):
        inside = np.zeros(problem.t.size, dtype=bool)
        inside[at] = True
        own, clock = runs[r].model, runs[r].clock
        values = {"x0": (own.x0, length), "v0": (own.v0, f"{length}/s"), "offset": (own.offset, length)}
        said = {}
        for name, (value, unit) in values.items():
            error = numbers.get(named(name, r), errors[r].get(name))
            why = None if error else "given, not fitted" if name != "v0" else "released from rest"
            said[name] = P.of(Quantity(value, error, unit, why))
        found.append(
            OwnResult(
                file=one.file,
                begins_s=clock + (0.0 if isinstance(problem, Together) else runs[r].model.t0),
                start={name: said[name] for name in ("x0", "v0")},
                zero=said["offset"] if problem.zero_free and "x" in problem.channels else None,
                noise={c: n.said for c, n in alone.noise.items()},
                baseline_rmse=rmse(outcome.base.shown.y, problem, inside),
                rmse=rmse(refined.shown.y, problem, inside),
                alone={name: P.of(q) for name, q in pooled.compared.alone[r].parameters.items()},
                differs=[d.said(first) for d in differ[r] if d.clearly],
            )
        )
    return found


def _of_starts(problem: Together | ForcesTogether) -> list[dict[str, float]]:
    """Standard errors of the starts of recordings that are not fitted but smoothed, by name."""
    if isinstance(problem, Together):
        return [{} for _ in problem.alone]
    firsts = [one.starts.windows[0] for one in problem.each]
    return [{"x0": w.x_sd, "v0": w.v_sd} for w in firsts]

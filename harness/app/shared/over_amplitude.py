"""Damping and frequency over amplitude, as a recording shows them and as models have them; a result, and a CSV."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from harness.app.shared.deliver import write_text
from harness.core.events import EventKind
from harness.core.trajectory import Trajectory
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.estimate.over_amplitude import OverAmplitude, measured
from harness.results.common import DampingResult
from harness.show.plots import position_at

_AT_REST = 1e-6
"""Of its largest speed, from which a model begins at a turning point."""
_LET_GO = 2.0
"""Intervals within which what is let go has the speed that it is first seen with."""
_BELOW = 0.7
"""Of the smallest amplitude that was measured, down to which a model's is told."""


def damping_of(problem: Problem, models: Mapping[str, Trajectory]) -> DampingResult | None:
    """Of a free decay; None of anything else, and where too few turning points are seen. models : by name."""
    if not isinstance(problem, FreeDecay):
        return None
    found = measured(problem.t, problem.channels)
    if found is None:
        return None
    least, laws = _BELOW * float(np.min(found.amplitude)), {}
    for name, motion in models.items():
        law = _of_model(motion)
        if law is not None:
            keep = law.amplitude >= least
            columns = {"amplitude": law.amplitude, "zeta": law.zeta, "frequency_hz": law.frequency_hz}
            laws[name] = {column: values[keep].tolist() for column, values in columns.items()}
    return DampingResult.taken_from(found, unit="rad" if problem.angular else "m", laws=laws)


def _of_model(motion: Trajectory) -> OverAmplitude | None:
    """From its turning points, between samples where its events do not tell them."""
    times = motion.events.of(EventKind.REVERSAL, EventKind.STICK).t
    if not len(motion.events):
        at = np.flatnonzero(motion.v[1:] * motion.v[:-1] < 0.0)
        share = motion.v[at] / (motion.v[at] - motion.v[at + 1])
        times = motion.t[at] + share * (motion.t[at + 1] - motion.t[at])
    # held until it is let go, which is its first turning point unless it begins with a speed
    moving = np.flatnonzero(np.abs(motion.v) >= _AT_REST * float(np.max(np.abs(motion.v))))
    begins = motion.t[moving[:1] - 1] if moving.size and moving[0] > 0 else motion.t[:0]
    if begins.size:
        i = moving[0]
        interval = motion.t[i] - motion.t[i - 1]
        begins = begins[: int(abs(motion.v[i]) <= _LET_GO * abs(motion.a[i]) * interval)]
    first = begins[0] if begins.size else motion.t[0]
    times = np.concatenate((begins, times[(times > first) & (times <= motion.t[-1])]))
    return OverAmplitude.of(times, position_at(motion, times)[0], np.zeros(times.size))


def write_damping(path: Path, found: DampingResult) -> None:
    """A row an amplitude; source is measured, or the name of a model, which has no errors."""
    names = ("amplitude", "zeta", "zeta_stderr", "frequency_hz", "frequency_stderr")
    lines = [f"source,amplitude_{found.unit},zeta,zeta_stderr,loss_factor,frequency_hz,frequency_stderr"]
    sources = {"measured": {name: getattr(found, name) for name in names}, **found.laws}
    for source, columns in sources.items():
        for k, amplitude in enumerate(columns["amplitude"]):
            zeta, frequency = columns["zeta"][k], columns["frequency_hz"][k]
            errors = [f"{columns[name][k]:.9g}" if name in columns else "" for name in (names[2], names[4])]
            row = (f"{amplitude:.9g}", f"{zeta:.9g}", errors[0], f"{2.0 * zeta:.9g}", f"{frequency:.9g}", errors[1])
            lines.append(",".join([source, *row]))
    write_text(path, "\n".join(lines) + "\n")

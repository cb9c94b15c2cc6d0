"""Driven plants with one effect or none, on a spring or a free axis, force noise to half a per cent: what is said."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.calibrate.calibration import Calibration, stands
from harness.core.recording import Recording
from harness.diagnosis.outcome import Grade
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import FORCE_HELD, MOST_LISTED
from harness.model.model import Restoring
from harness.model.registry import NAMED
from harness.proof.plant.cases import draw
from harness.proof.plant.effects import FAMILY_OF_MACHINES, KINDS
from harness.proof.statistics import Rate

SETTINGS = {"driven": Restoring.SPRING, "axis": Restoring.NONE}
"""Of the plant, and what holds the slider there."""
FORCE_NOISE = (0.0, 0.001, 0.0025, 0.005)
"""Of the measured force, over its rms."""
LISTED, WRONG, QUIET = 0.85, 0.03, 0.98
"""Shares that are asked: of effects named or listed, of those called another family, of controls."""
_OF_A_SPRING = frozenset({"spring", "angle"})
"""What a law may need that a free axis does not have."""
HEADLINES = (Grade.EXPLAINS, Grade.MAIN, Grade.ONE_OF)


@dataclass(frozen=True, slots=True)
class Told:
    """A recording: where it was made, noise of its force, the hidden effect ("" for none), and what was said."""

    setting: str
    noise: float
    hidden: str
    verdict: str
    names: tuple[str, ...]

    @property
    def listed(self) -> bool:
        """Whether the hidden effect is among the names."""
        return self.hidden in self.names

    @property
    def wrong(self) -> bool:
        """Whether what is said first is of another family, the effect nowhere."""
        return (
            bool(self.names)
            and not self.listed
            and FAMILY_OF_MACHINES[self.names[0]] != FAMILY_OF_MACHINES[self.hidden]
        )


def names_of(setting: str) -> tuple[str, ...]:
    """Effects that a catalogue entry can say there."""
    none = _OF_A_SPRING if setting == "axis" else frozenset()
    known = {term.name for term in NAMED if none.isdisjoint(term.needs)}
    return tuple(name for name in KINDS if name in known)


def measure(seed: int, index: int) -> Told:
    """One recording; of three one is a control, and the effects take turns. Raises SimulationError."""
    rng = np.random.default_rng([seed, 23, index])
    setting = tuple(SETTINGS)[index % 2]
    turn, place = divmod(index // 2, 3)
    names = names_of(setting)
    hidden = names[(2 * turn + place - 1) % len(names)] if place else ""
    case = draw(hidden or "control", rng, setting=setting)
    noise = float(rng.choice(FORCE_NOISE))
    u = case.recorded["u"]
    u = u + noise * float(np.sqrt(np.mean(u**2))) * rng.standard_normal(u.size)
    channels = {c: case.recorded[c] for c in case.channels}
    recording = Recording(case.recorded["t"], channels | {"u": u}, f"{setting}-{index}")
    problem, _ = prepare(recording, Asked(SETTINGS[setting], zero_free=False))
    outcome = diagnose(problem)
    said = tuple(m.name for m in outcome.mechanisms if m.grade in HEADLINES)
    return Told(setting, noise, hidden, outcome.verdict, said[: MOST_LISTED.count])


def said(rows: Sequence[Told]) -> Iterator[str]:
    """Rates, and every recording of which something else was said."""
    with_one, without = [r for r in rows if r.hidden], [r for r in rows if not r.hidden]
    for label, outcomes in (
        ("named", [r.names[:1] == (r.hidden,) and r.verdict != "one_of" for r in with_one]),
        ("named or listed", [r.listed for r in with_one]),
        ("another family", [r.wrong for r in with_one]),
        ("controls quiet", [r.verdict == "adequate" for r in without]),
    ):
        rate = Rate.of(outcomes)
        if rate.value is not None and rate.low is not None and rate.high is not None:
            between = f"{100.0 * rate.low:.1f} to {100.0 * rate.high:.1f}"
            yield f"{label}: {rate.hits} of {rate.cases}, {100.0 * rate.value:.1f} % ({between})"
    for r in rows:
        if not r.listed if r.hidden else r.verdict != "adequate":
            names = ", ".join(r.names) or "no name"
            yield f"  {r.setting}, force noise {100.0 * r.noise:g} %, {r.hidden or 'control'}: {r.verdict}, {names}"
    listed = sum(r.listed for r in with_one) >= LISTED * len(with_one)
    wrong = sum(r.wrong for r in with_one) <= WRONG * len(with_one)
    quiet = sum(r.verdict == "adequate" for r in without) >= QUIET * len(without)
    asked = (
        f"asked: {100 * LISTED:.0f} % named or listed, {100 * WRONG:.0f} % another family, {100 * QUIET:.0f} % quiet"
    )
    yield stands(FORCE_HELD, listed and wrong and quiet, asked)


CALIBRATION = Calibration(measure, said, "what is said of driven plants with one effect or none")

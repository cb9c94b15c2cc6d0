"""Whether recordings are pooled, in a sentence that stands beside the verdict."""

from collections.abc import Sequence
from typing import Any

from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.pooling.own import SAID
from harness.diagnosis.pooling.pooled import Differs, Pooled, differences
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.together import Together
from harness.diagnosis.rules import POOLED

_EACH = 3
"""Recordings whose values are said one by one; of more the least and the most."""


def sentences(found: Fit, problem: Together | ForcesTogether, before: Pooled[Any], explained: bool) -> tuple[str, ...]:
    """What is shared and what differs; found : the best model, in which recordings have what is their own."""
    count = len(problem.starts.stretches)
    chance = before.compared.chance
    if before.own:
        every = differences(found, problem, before.scales.omega, explained)
        names = " and ".join(SAID[stem] for stem in before.own)
        values = [_of_recording(r, row) for r, row in enumerate(every) if r and any(d.clearly for d in row)]
        return (f"The recordings differ in {names}: {'; '.join(values)}. All else is shared.",)
    if chance >= POOLED.value:
        return (f"The {count} recordings are pooled: alone they agree in their base parameters (chance {chance:.2g}).",)
    return (
        f"The {count} recordings are pooled: read alone they differ ({'; '.join(_apart(before))}), and what is missing"
        " in all of them says that as well as a parameter of their own would.",
    )


def _of_recording(number: int, row: Sequence[Differs]) -> str:
    said = " and ".join(d.said("the first") for d in row if d.clearly)
    return f"recording {number + 1} has {said}"


def _apart(before: Pooled[Any]) -> list[str]:
    """The base parameters that are furthest apart alone, with their values."""
    each = [one.parameters for one in before.compared.alone]
    far: list[tuple[float, str]] = []
    for name in each[0]:
        read = [one[name] for one in each]
        values = [q.value for q in read if q.value is not None]
        errors = [q.stderr for q in read if q.stderr is not None]
        if len(values) == len(read) and errors:
            scale = (sum(e**2 for e in errors) / len(errors)) ** 0.5
            far.append(
                ((max(values) - min(values)) / scale, f"{name} {' and '.join(f'{v:.4g}' for v in _ends(values))}")
            )
    far.sort(reverse=True)
    return [said for _, said in far[:1]]


def _ends(values: Sequence[float]) -> Sequence[float]:
    return values if len(values) <= _EACH else (min(values), max(values))

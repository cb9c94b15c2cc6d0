"""How far a pair with a flexible law stands from the next of other families: a true one, and one that follows what no
catalogue holds.
"""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.calibrate.calibration import Calibration, head, quantiles, stands
from benchmarks.calibrate.plant_cases import NAMES, case_of, pair_of, start_of, terms_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.rules import APART, FLEXIBLE
from harness.diagnosis.search.search import search
from harness.proof.plant.effects import ALIENS

TRUE, ALIEN = "true pair", "effect of no catalogue"
_FLEXIBLE = tuple(name for name in NAMES if any(len(t.parameters) >= FLEXIBLE.value for t in terms_of(name)))


def measure(seed: int, index: int) -> tuple[str, float | None]:
    """What was hidden, and the distance in BIC; None where the search ended at no pair that the rule is for."""
    rng = np.random.default_rng([seed, 4, index])
    kind = (TRUE, ALIEN)[index % 2]
    names = pair_of(rng, _FLEXIBLE) if kind == TRUE else str(rng.choice(list(ALIENS)))
    start = start_of(case_of(names, rng, index))
    found = search(start.problem, start.base, start.scales)
    chosen = found.chosen
    flexible = any(len(entry.values) >= FLEXIBLE.value for entry in chosen.model.terms)
    if len(chosen.model.terms) < 2 or not flexible or not found.explained:
        return kind, None
    if kind == TRUE and {entry.term.name for entry in chosen.model.terms} != set(names):
        return kind, None
    others = [rival.bic for rival in found.rivals if _families(rival) != _families(chosen)]
    return kind, min(others) - chosen.bic if others else math.inf


def _families(found: Fit) -> frozenset[str]:
    return frozenset(entry.term.family for entry in found.model.terms)


def said(rows: Sequence[tuple[str, float | None]]) -> Iterator[str]:
    """Quantiles of the distance of either; the rule should lie above all of what follows something else."""
    yield head("BIC to the next pair")
    far = {kind: [d for k, d in rows if k == kind and d is not None] for kind in (TRUE, ALIEN)}
    for kind, distances in far.items():
        yield quantiles(kind, [min(d, 1e6) for d in distances])
        yield f"  of {sum(k == kind for k, _ in rows)} searches {len(distances)} ended at a pair that the rule is for"
    kept = sum(d >= APART.value for d in far[TRUE])
    passed = sum(d >= APART.value for d in far[ALIEN])
    why = f"{passed} of {len(far[ALIEN])} that follow something else pass, {kept} of {len(far[TRUE])} true ones"
    yield stands(APART, passed == 0, why)


CALIBRATION = Calibration(measure, said, "distance in BIC of a pair with a flexible law to the next of other families")

"""Sensitivities of every pair of terms that may stand in one model, against differences.

``PYTHONPATH=.:tests/support python -m benchmarks.sensitivities [KEY ...]`` prints those pairs (of these terms) that do
not agree, and ends with 1 where there are any.
"""

import itertools
import sys

import numpy as np
from kernel_cases import VALUES, difference_error, goal, model, term

from harness.model.registry import term as find
from harness.model.term import SINGLE

T = np.linspace(0.0137, 3.0, 76)


def pairs(keys: list[str]) -> list[tuple[str, str]]:
    """The pairs that may stand in one model; those with one of these terms, or all."""
    slots = {key: find(key).slot for key in VALUES}
    found = (p for p in itertools.combinations(VALUES, 2) if slots[p[0]] not in SINGLE or slots[p[0]] != slots[p[1]])
    return [pair for pair in found if not keys or set(keys) & set(pair)]


def told(first: str, second: str) -> str:
    """What is wrong with a pair; "" where nothing is."""
    both = model(term(first), term(second))
    try:
        error, where, _ = difference_error(both, T)
    except AssertionError as unclear:
        return str(unclear)
    most = 2.0 * goal(both)
    return "" if error < most else f"{error:.3g} by {where}, at most {most:.3g}"


def main() -> int:
    """Print what does not agree; 1 where something does not."""
    asked = pairs(sys.argv[1:])
    wrong = {pair: said for pair in asked if (said := told(*pair))}
    for (first, second), said in wrong.items():
        print(f"{first} + {second}: {said}")
    print(f"{len(asked) - len(wrong)} of {len(asked)} pairs agree with differences")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

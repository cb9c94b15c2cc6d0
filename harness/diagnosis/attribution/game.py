"""Shapley values: what each player brings, averaged over all orders in which the players may come.

L. S. Shapley, A value for n-person games, Contributions to the Theory of Games II (1953) 307-317.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import combinations

Value = Callable[[frozenset[str]], float]
"""What is left when these players have been put right; asked for the same players many times."""


def saved(players: Sequence[str], left: Value) -> Mapping[str, float]:
    """What putting each player right takes off what is left, averaged over all orders; sums to left({}) - left(all).

    Negative for a player whose error hides those of others.
    """
    count = len(players)
    found = {}
    for player in players:
        others = [other for other in players if other != player]
        total = 0.0
        for size in range(count):
            weight = math.factorial(size) * math.factorial(count - size - 1) / math.factorial(count)
            for before in map(frozenset, combinations(others, size)):
                total += weight * (left(before) - left(before | {player}))
        found[player] = total
    return found

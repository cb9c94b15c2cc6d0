"""Which recordings of machines are drawn: kinds in turn, and on each an effect that has not occurred often."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import cycle, islice

import numpy as np

from harness.core.errors import InputError
from harness.proof.machines.effects import STATIC, UNKNOWN
from harness.proof.machines.kinds import DRIVEN, FREE, KINDS, Kind

MAIN, CONTROL, UNNAMED, TABLE = "main", "machine-control", "unknown", "table"
"""One effect of the catalogue above small ones; small ones alone; one of no catalogue; a static one of no catalogue."""
GROUPS = (MAIN, CONTROL, UNNAMED, TABLE)


@dataclass(frozen=True, slots=True)
class Job:
    """A recording to be drawn. index : its place, from which its chance follows. main : "" in a control."""

    index: int
    group: str
    kind: str
    main: str


def chosen_kinds(names: Sequence[str]) -> list[Kind]:
    """Kinds by name, "free" and "driven" for all of them. Raises InputError for one that is none."""
    found: dict[str, Kind] = {}
    for name in names:
        group = {"free": FREE, "driven": DRIVEN}.get(name, KINDS)
        if group is KINDS and name not in KINDS:
            raise InputError("--kind", name, f"free, driven or one of {', '.join(KINDS)} is accepted")
        found |= {name: KINDS[name]} if group is KINDS else group
    return list(found.values())


def plan(kinds: Sequence[Kind], mains: int, controls: int, unknown: int, tables: int, seed: int) -> list[Job]:
    """The recordings in random order; every kind occurs as often as any other in each group, give or take one."""
    rng = np.random.default_rng([seed, 0])
    used: Counter[str] = Counter()
    drafts: list[Job] = []
    for group, count in ((MAIN, mains), (CONTROL, controls), (UNNAMED, unknown), (TABLE, tables)):
        order = [kinds[int(i)] for i in rng.permutation(len(kinds))]
        for kind in islice(cycle(order), count):
            main = _least(possible(kind, group), used, rng)
            used[main] += 1
            drafts.append(Job(0, group, kind.name, main))
    return [replace(drafts[int(i)], index=index) for index, i in enumerate(rng.permutation(len(drafts)))]


def possible(kind: Kind, group: str) -> tuple[str, ...]:
    """Main effects of a group on a kind of machine."""
    if group == MAIN:
        return kind.names
    if group == CONTROL:
        return ("",)
    names = (*UNKNOWN, *STATIC) if group == UNNAMED else tuple(STATIC)
    return tuple(name for name in names if kind.has(name))


def _least(names: Sequence[str], used: Counter[str], rng: np.random.Generator) -> str:
    # not the rarest alone: a kind would get nothing but what no other kind has
    fewest = min(used[name] for name in names)
    rarest = [name for name in names if used[name] <= fewest + 1]
    return rarest[int(rng.integers(len(rarest)))]

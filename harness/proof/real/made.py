"""Which recordings a proof on real machines makes, and each from the files that were given."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from harness.proof.paths.files import packed
from harness.proof.real.effects import EFFECTS, effects_of
from harness.proof.real.measured import Measured, Rig

UNTOUCHED, CONSTRUCTED, SWITCHED, REPEATED = "real-untouched", "real-constructed", "real-switched", "real-repeated"
GROUPS = (UNTOUCHED, CONSTRUCTED, SWITCHED, REPEATED)
Files = tuple[tuple[str, ...], tuple[str, ...]]
"""Before, and after; after alone of one recording."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """A recording to be made: of which group, from which files, with which effect ("" for none)."""

    group: str
    files: Files
    effect: str = ""


def wanted(rigs: Sequence[Rig], count: int, rng: np.random.Generator) -> list[Wanted]:
    """Every file as it is, ``count`` constructed effects, every two conditions of a machine, every condition in halves.

    Machines take turns, of a machine its files, and of a file its effects. Which condition comes first is chance.
    """
    machines: dict[str, list[Rig]] = {}
    for rig in sorted(rigs, key=lambda one: one.file):
        machines.setdefault(rig.machine, []).append(rig)
    found = [Wanted(UNTOUCHED, ((), (rig.file,))) for of_one in machines.values() for rig in of_one]
    able = {name: [rig for rig in of_one if effects_of(rig)] for name, of_one in machines.items()}
    order = [name for name, of_one in able.items() if of_one]
    decks: dict[str, list[tuple[str, str]]] = {}
    for number in range(count if order else 0):
        name = order[number % len(order)]
        if not decks.get(name):
            every = [(rig.file, effect) for rig in able[name] for effect in effects_of(rig)]
            decks[name] = [every[int(i)] for i in rng.permutation(len(every))]
        file, effect = decks[name].pop()
        found.append(Wanted(CONSTRUCTED, ((), (file,)), effect))
    for of_one in machines.values():
        conditions: dict[float, list[Rig]] = {}
        for rig in of_one:
            if rig.condition is not None:
                conditions.setdefault(rig.condition, []).append(rig)
        for pair in combinations(sorted(conditions), 2):
            if all(rig.moves for value in pair for rig in conditions[value]):
                first, last = (tuple(rig.file for rig in conditions[value]) for value in rng.permutation(pair).tolist())
                found.append(Wanted(SWITCHED, (first, last)))
        for alike in conditions.values():
            names = [alike[int(i)].file for i in rng.permutation(len(alike))]
            half = len(names) // 2
            if half:
                found.append(Wanted(REPEATED, (tuple(names[:half]), tuple(names[half:]))))
    return found


def made(
    seed: int, index: int, job: Wanted, rigs: Mapping[str, Rig], measured: Mapping[str, Measured]
) -> tuple[bytes, dict[str, Any]]:
    """A recording, and its answer."""
    before, after = job.files
    about: dict[str, Any] = {
        "group": job.group,
        "effect": job.effect,
        "machine": rigs[after[0]].machine,
        "files": [list(before), list(after)],
        "right": [],
        "moves": {},
        "amount": None,
        "base_chi2_excess": None,
        "base_r2": [],
    }
    parts = {file: measured[file] for file in (*before, *after)}
    if job.effect:
        effect, (file,) = EFFECTS[job.effect], after
        found = effect.put(parts[file], np.random.default_rng([seed, 6, index]))
        parts[file] = found.recording
        about |= {"right": list(effect.right), "moves": dict(effect.moves), "amount": found.amount}
        about["base_r2"] = [] if found.r2 is None else [found.r2]
    elif job.group == SWITCHED:
        (was, now), moves = (rigs[side[0]].condition or 0.0 for side in job.files), rigs[after[0]].moves
        about["moves"] = {moves: 1 if now > was else -1}
    # file names of a machine's owner tell the condition
    blind = {file: f"recording-{number}.csv" for number, file in enumerate(parts, 1)}
    options = dict(parts[after[0]].options)
    if before:
        options |= {
            "before": ",".join(blind[file] for file in before),
            "after": ",".join(blind[file] for file in after),
        }
    common = {
        "mechanisms": [*about["right"][:1], *about["moves"]],
        "source": "real",
        "setting": about["machine"],
        "channels": rigs[after[0]].channels,
        "points": sum(one.t.size for one in parts.values()),
        "arguments": [part for name, value in options.items() for part in (f"--{name}", value)],
    }
    return packed({blind[file]: one.text for file, one in parts.items()}), {**about, **common}

"""What a proof hides, recording by recording: a list of jobs that follows from its seed and its sizes."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from itertools import combinations

import numpy as np

from harness.core.errors import InputError
from harness.proof.engine_source import ENGINE_KINDS, ENGINES
from harness.proof.plant.catalogue import ALIENS, KINDS, compatible

SINGLE, CONTROL, PAIR, OUTSIDE = "single", "control", "pair", "outside"
PLANT = "plant"
ENGINE_EVERY = 8
"""Of so many recordings of a group that an engine can make, each engine makes one."""
CONTROL_SETTINGS = {"decay": 0.9, "driven": 0.04, "pendulum": 0.03, "axis": 0.03}
"""How often controls are recorded how; effects are recorded as free decays, static friction driven."""


@dataclass(frozen=True, slots=True)
class Sizes:
    """How many recordings of each group. Raises InputError for a negative number and for none at all."""

    singles: int = 300
    controls: int = 300
    pairs: int = 60
    outside: int = 60

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value < 0:
                raise InputError(f"--{field.name}", str(value), "0 or more is accepted")
        if self.total == 0:
            raise InputError("--singles, --controls, --pairs, --outside", "0 each", "1 or more of one is accepted")

    @property
    def total(self) -> int:
        """Recordings of all groups."""
        return self.singles + self.controls + self.pairs + self.outside

    @property
    def is_evidence(self) -> bool:
        """Whether so many recordings can carry the figures a proof speaks of."""
        return all(getattr(self, name) >= least for name, least in asdict(FULL).items())

    @classmethod
    def of(cls, said: Mapping[str, int]) -> "Sizes":
        """As a transcript holds it."""
        return cls(**{field.name: int(said[field.name]) for field in fields(cls)})


FULL = Sizes()
SHORT = Sizes(14, 5, 2, 3)


@dataclass(frozen=True, slots=True)
class Job:
    """One recording to be drawn.

    index : its place, from which its chance follows. group : "single", "control", "pair", "outside". source : what
    makes the motion. kinds : what is hidden, () in a control. setting, noise : as in harness.proof.plant.cases.draw.
    """

    index: int
    group: str
    source: str
    kinds: tuple[str, ...]
    setting: str
    noise: str


def plan(sizes: Sizes, seed: int) -> list[Job]:
    """The jobs of a proof in random order; kinds cycle: each occurs as often as any other, give or take one."""
    rng = np.random.default_rng([seed, 0])
    pairs = possible_pairs()
    chosen = rng.choice(len(pairs), sizes.pairs, replace=sizes.pairs > len(pairs))
    settings = rng.choice(list(CONTROL_SETTINGS), sizes.controls, p=list(CONTROL_SETTINGS.values()))
    drafts: list[tuple[str, tuple[str, ...], str]] = []
    drafts += [(SINGLE, (kind,), "decay") for kind in _cycled(KINDS, sizes.singles, rng)]
    drafts += [(CONTROL, (), str(setting)) for setting in settings]
    drafts += [(PAIR, pairs[int(i)], "decay") for i in chosen]
    drafts += [(OUTSIDE, (kind,), "decay") for kind in _cycled(tuple(ALIENS), sizes.outside, rng)]
    sources = _sources(drafts)
    jobs = []
    for index, place in enumerate(rng.permutation(len(drafts))):
        group, kinds, setting = drafts[int(place)]
        jobs.append(Job(index, group, sources[int(place)], kinds, setting, "mixed"))
    return jobs


def _sources(drafts: Sequence[tuple[str, tuple[str, ...], str]]) -> list[str]:
    """What makes the motion of each: engines take turns with the plant wherever they can."""
    turns: Counter[str] = Counter()
    sources = []
    for group, kinds, setting in drafts:
        source = PLANT
        if setting == "decay" and set(kinds) <= set(ENGINE_KINDS):
            turn = turns[group] % ENGINE_EVERY
            turns[group] += 1
            source = ENGINES[turn - ENGINE_EVERY] if turn >= ENGINE_EVERY - len(ENGINES) else PLANT
        sources.append(source)
    return sources


def possible_pairs() -> list[tuple[str, str]]:
    """Every two names that can act together."""
    return [(a, b) for a, b in combinations(KINDS, 2) if compatible(a, b)]


def _cycled(names: tuple[str, ...], count: int, rng: np.random.Generator) -> list[str]:
    """``count`` names: all of them as often as possible, the rest by chance and each at most once."""
    whole, rest = divmod(count, len(names))
    return [*names * whole, *(names[int(i)] for i in rng.choice(len(names), rest, replace=False))]

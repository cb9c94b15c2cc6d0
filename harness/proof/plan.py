"""What a proof hides, recording by recording: a list of jobs that follows from its seed and its sizes."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from itertools import combinations

import numpy as np

from harness.core.errors import InputError
from harness.proof.detection import KINDS as CURVE
from harness.proof.detection import LOSSES
from harness.proof.engine_source import ENGINE_KINDS, ENGINES
from harness.proof.machines.kinds import FREE
from harness.proof.machines.kinds import plan as plan_machines
from harness.proof.paths.forms import FIRST
from harness.proof.paths.forms import PATHS as WAYS
from harness.proof.paths.made import ways
from harness.proof.plant.effects import ALIENS, KINDS, compatible
from harness.proof.real.made import Files, Rig
from harness.proof.real.made import wanted as of_machines_at_hand

SINGLE, CONTROL, PAIR, OUTSIDE, DETECTION = "single", "control", "pair", "outside", "detection"
PLANT, MACHINE, PATH, REAL = "plant", "machine", "path", "real"
ENGINE_EVERY = 8
"""Of so many recordings of a group that an engine can make, each engine makes one."""
CONTROL_SETTINGS = {"driven": 0.04, "pendulum": 0.03, "axis": 0.03}
"""Shares of the controls that are recorded so; all others, and effects, are free decays."""
NOISE = "mixed"
DRIVEN = ("static-friction",)
"""Effects that no free decay shows: they occur alone, driven."""


@dataclass(frozen=True, slots=True)
class Sizes:
    """How many recordings of each group. Raises InputError for a negative number and for none at all.

    ways : over how many of the ways, from the first, ``paths`` are spread; 0 for those of the first published proof.
    real : constructed effects on recordings that were given; whatever else these can be asked comes besides.
    """

    singles: int = 300
    controls: int = 300
    pairs: int = 60
    outside: int = 60
    machines: int = 0
    paths: int = 0
    ways: int = 0
    real: int = 0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value < 0:
                raise InputError(f"--{field.name}", str(value), "0 or more")
        if self.total == 0:
            raise InputError("--singles, --controls, --pairs, --outside", "0 each", "1 or more of one")

    @property
    def total(self) -> int:
        return self.singles + self.controls + self.pairs + self.outside + self.machines + self.paths + self.real

    @property
    def is_evidence(self) -> bool:
        """Whether so many recordings can carry the figures a proof speaks of."""
        enough = self.paths >= LEAST_OF_A_WAY * (self.ways or FIRST)
        return enough or self.real >= REAL_LEAST or any(self.covers(full) for full in (FULL, MACHINES))

    def covers(self, other: "Sizes") -> bool:
        """Whether no group is smaller."""
        return all(getattr(self, name) >= least for name, least in asdict(other).items())

    @classmethod
    def of(cls, said: Mapping[str, int]) -> "Sizes":
        return cls(**{field.name: int(said.get(field.name, 0)) for field in fields(cls)})


FULL = Sizes()
SHORT = Sizes(16, 5, 2, 1)
MACHINES, SHORT_MACHINES = Sizes(0, 0, 0, 0, machines=600), Sizes(0, 0, 0, 0, machines=24)
"""Proofs on recordings of machines alone."""
LEAST_OF_A_WAY = 16
"""Recordings of each way, half of them controls: of nine ways, none wrong of 72 bounds false alarms at 5 %. Every
figure has its interval, and one whose bound is asked falls short where the cases are too few for it."""
REAL_LEAST = 200
"""Constructed effects on real machines, as every figure with its interval over machines."""
OF_A_WAY = 600
"""Of each 300 controls, 225 effects and, over all, an eighth unknown ones."""


def on_ways(recordings: int) -> Sizes:
    """A proof on all ways that give a verdict, with so many recordings."""
    return Sizes(0, 0, 0, 0, paths=recordings, ways=len(WAYS))


SHORT_REAL = 24
PATHS, SHORT_PATHS = on_ways(OF_A_WAY * len(WAYS)), on_ways(24)


@dataclass(frozen=True, slots=True)
class Job:
    """One recording to be drawn.

    index : its place, from which its chance follows. group : "single", "control", "pair", "outside", "detection", or
    one of a machine or of a way. source : what makes the motion. kinds : what is hidden, () in a control; of a machine
    the main effect, of a way the form. setting, noise : as in harness.proof.plant.cases.draw; of a machine its kind, of
    a way its name. series, level : of the detection curve, which case it is at which noise. files : of a real machine.
    """

    index: int
    group: str
    source: str
    kinds: tuple[str, ...]
    setting: str
    noise: str
    series: int = 0
    level: int = 0
    files: Files = ((), ())


def plan(sizes: Sizes, seed: int, rigs: Sequence[Rig] = ()) -> list[Job]:
    """The jobs of a proof in random order; kinds cycle: each occurs as often as any other, give or take one.

    A proof that is evidence has the detection curve besides. rigs : recordings of real machines that were given.
    """
    rng = np.random.default_rng([seed, 0])
    pairs = possible_pairs()
    chosen = rng.choice(len(pairs), sizes.pairs, replace=sizes.pairs > len(pairs))
    settings = [name for name, share in CONTROL_SETTINGS.items() for _ in range(int(share * sizes.controls))]
    settings += ["decay"] * (sizes.controls - len(settings))
    drafts = [
        Job(0, SINGLE, PLANT, (kind,), "driven" if kind in DRIVEN else "decay", NOISE)
        for kind in _cycled(KINDS, sizes.singles, rng)
    ]
    drafts += [Job(0, CONTROL, PLANT, (), setting, NOISE) for setting in settings]
    drafts += [Job(0, PAIR, PLANT, pairs[int(i)], "decay", NOISE) for i in chosen]
    drafts += [Job(0, OUTSIDE, PLANT, (kind,), "decay", NOISE) for kind in _cycled(tuple(ALIENS), sizes.outside, rng)]
    drafts = _sourced(drafts)
    # of machines half are controls, and one in twelve has a main effect that no catalogue holds
    controls, unknown = sizes.machines // 2, sizes.machines // 12
    mains = sizes.machines - controls - unknown
    for one in plan_machines(list(FREE.values()), mains, controls, unknown, 0, seed):
        drafts.append(Job(0, one.group, MACHINE, (one.main,) if one.main else (), one.kind.name, ""))
    for path, group, form in ways(sizes.paths, np.random.default_rng([seed, 4]), sizes.ways or FIRST):
        drafts.append(Job(0, group, PATH, (form,) if form else (), path, ""))
    for wanted in of_machines_at_hand(rigs, sizes.real, np.random.default_rng([seed, 7])):
        effect = (wanted.effect,) if wanted.effect else ()
        drafts.append(Job(0, wanted.group, REAL, effect, "", "", files=wanted.files))
    if sizes.covers(FULL):
        drafts += [
            Job(0, DETECTION, PLANT, (kind,), "decay", "white", series, level)
            for series, kind in enumerate(CURVE)
            for level in range(len(LOSSES))
        ]
    return [replace(drafts[int(place)], index=index) for index, place in enumerate(rng.permutation(len(drafts)))]


def _sourced(drafts: Sequence[Job]) -> list[Job]:
    """Engines take turns with the plant wherever they can."""
    turns: Counter[str] = Counter()
    jobs = []
    for job in drafts:
        source = PLANT
        if job.setting == "decay" and set(job.kinds) <= set(ENGINE_KINDS):
            turn = turns[job.group] % ENGINE_EVERY
            turns[job.group] += 1
            source = ENGINES[turn - ENGINE_EVERY] if turn >= ENGINE_EVERY - len(ENGINES) else PLANT
        jobs.append(replace(job, source=source))
    return jobs


def possible_pairs() -> list[tuple[str, str]]:
    """Every two names that can act together in a free decay."""
    return [(a, b) for a, b in combinations(KINDS, 2) if compatible(a, b) and not {a, b} & set(DRIVEN)]


def _cycled(names: tuple[str, ...], count: int, rng: np.random.Generator) -> list[str]:
    """``count`` names: all of them as often as possible, the rest by chance, each at most once, none that is driven."""
    whole, rest = divmod(count, len(names))
    free = [name for name in names if name not in DRIVEN]
    chosen = [free[int(i)] for i in rng.choice(len(free), rest, replace=False)]
    return [*names * whole, *chosen]

"""Every number that moves a verdict: rules.toml says its value, its unit, what it moves and where it comes from.

A rule is used as ``RULE.value``. Numbers that only decide how much work is done, or how a curve is smoothed, stand
beside the code that uses them. docs/rules.md is made from the table: ``python -m harness.diagnosis.rules``.
"""

import math
import sys
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from harness.model.registry import NAMED


@dataclass(frozen=True, slots=True)
class Rule:
    """A number that moves a verdict.

    name : as results and docs call it. value, unit : "1" for a pure number. moves : what it decides. origin : a source,
    a derivation, or the command that simulates it.
    """

    name: str
    value: float
    unit: str
    moves: str
    origin: str

    @property
    def count(self) -> int:
        """The value of a rule that counts."""
        return round(self.value)


@dataclass(frozen=True, slots=True)
class Weights:
    """Of linear log odds. values : by feature. name, moves, origin : as of a rule."""

    name: str
    values: Mapping[str, float]
    moves: str
    origin: str

    def odds(self, features: Mapping[str, float]) -> float:
        """Log odds by features, of which those that have a weight count."""
        return sum(weight * features[name] for name, weight in self.values.items())


NAMES = len({term.name for term in NAMED})
_TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
_AMONG_PAIRS = _TABLE["decisive"]["value"] + 2.0 * math.log(NAMES * (NAMES - 1) // 2)


def rule(name: str, **grown: float) -> Rule:
    """A row of the table; grown : the value of one that grows with the catalogue, which has none there."""
    row = _TABLE[name]
    origin = row["origin"].format(names=NAMES, among_pairs=_AMONG_PAIRS)
    return Rule(name, **{**row, **grown, "origin": origin})


DECISIVE = rule("decisive")
MOVED = rule("moved")
MOST_MOVED = rule("most-moved")
REPEATS = rule("repeats")
REPEATS_SPRING = rule("repeats-spring")
REPEATS_KNOWN = rule("repeats-known")
EVEN = rule("even")
SHAPE_WIDTH = rule("shape-width")
AMONG_NAMES = rule("among-names", value=DECISIVE.value + 2.0 * math.log(NAMES))
SECOND_TERM = rule("second-term")
MOST_TERMS = rule("most-terms")
MOST_FORCE_TERMS = rule("most-force-terms")
FLEXIBLE = rule("flexible-law")
APART = rule("pairs-apart")
STRUCTURE = rule("structure")
STRUCTURE_NAMED = rule("structure-named")
LAW_KNOWN = rule("law-known")
ADVISED = rule("advised")
COLOUR_ALONE = rule("colour-alone")
STEADY = rule("steady")
AS_FAST = rule("as-fast")
PREDICTS_WORSE = rule("predicts-worse")
MISSES_MORE = rule("misses-more")
LOOSE = rule("loose")
SHOWN_BY_FORCE = rule("shown-by-force")
HAND_SHOWN = rule("hand-shown")
HAND_KNOCKS = rule("hand-knocks")
HAND_UNSEEN = rule("hand-unseen")
HAND_USUAL = rule("hand-usual")
HAND_STANDS_OUT = rule("hand-stands-out")
HAND_UNUSUAL = rule("hand-unusual")
HAND_TURNS = rule("hand-turns")
FORCE_HELD = rule("force-held")
INPUT_NOISE_DRAWS = rule("input-noise-draws")
NULL_DRAWS = rule("null-draws")
OVER_SIMULATED = rule("over-simulated")
BETWEEN_SAMPLES = rule("between-samples")
STROKE_CUT = rule("stroke-cut")
PERIODS_COUNTED = rule("periods-counted")
DRIVE_REPEATS = rule("drive-repeats")
CONFIRMED = rule("confirmed")
STEPPED = rule("stepped")
INTEGRATED = rule("integrated")
STEPPED_WITHIN = rule("stepped-within")
PERIOD_SEEN = rule("period-seen")
SAMPLED = rule("sampled")
FOLLOWED = rule("followed")
NEARLY_FOLLOWED = rule("nearly-followed")
MOVES = rule("moves")
RELAXATION_SEEN = rule("relaxation-seen")
PRESLIDING_SEEN = rule("presliding-seen")
SCREEN_GAIN = rule("screen-gain")
SCREEN_GAIN_OF_ONE = rule("screen-gain-of-one")
SCREEN_SHARE = rule("screen-share")
PAIR_PROMISE = rule("pair-promise")
FRICTION_GONE = rule("friction-gone")
MOST_WORDS = rule("most-words")
HAS_BEGUN = rule("has-begun")
BEGINS_ALIKE = rule("begins-alike")
GAIN = rule("gain")
TAKEN = rule("taken")
MARGIN = rule("margin")
LEAST_RATIO = rule("least-ratio")
MAIN_FROM = rule("main-from")
TIMES_NEXT = rule("times-next")
LISTED_FROM = rule("listed-from")
OF_LIST = rule("of-list")
POSTERIOR = Weights("posterior", **_TABLE["posterior"])
FORCE_POSTERIOR = Weights("force-posterior", **_TABLE["force-posterior"])
MOST_LIKELY = rule("most-likely")
UNSEEN = rule("unseen")
OTHER_FORM = rule("other-form")
SHARE_OF_EXCESS = rule("share-of-excess")
SHARE_OF_MISFIT = rule("share-of-misfit")
PART_APART = rule("part-apart")
PART_SPANS = rule("part-spans")
ZERO_REACH = rule("zero-reach")
LARGE_ANGLE = rule("large-angle")
SAME_CLOCK = rule("same-clock")
BEAT = rule("beat")
LEAST_CYCLES = rule("least-cycles")
MOST_LISTED = rule("most-listed")
TRACES_STRUCTURE = rule("traces-structure")
CLOCK_RATE = rule("clock-rate")
TRACES_LOUD = rule("traces-loud")
CLOCK_DRIFT = rule("clock-or-spring")
CHANGED = rule("changed")
CHANGED_BY = rule("changed-by")
ONE_CHANNEL = rule("one-channel")
CHANNELS_AGREE = rule("channels-agree")
CHANNELS_RELATED = rule("channels-related")
TABLE_OVER_NOISE = rule("table-over-noise")
TABLE_BETTER = rule("table-better")
TABLE_ERRORS = rule("table-errors")
TABLE_BAND = rule("table-band")
TABLE_WORDS = rule("table-words")
PATH_APART = rule("path-apart")
PATH_AGAIN = rule("path-again")
COVARIATE_VARIES = rule("covariate-varies")
COVARIATE_APART = rule("covariate-apart")
MASS_UNSEEN = rule("mass-unseen")
COVARIATES = (DECISIVE, COVARIATE_VARIES, COVARIATE_APART)
"""Those that decide whether and how a covariate enters."""
POOLED = rule("pooled")
OWN = rule("own")
AMPLITUDES_APART = rule("amplitudes-apart")
CHANCE = rule("fleet-chance")
POOLING = (POOLED, OWN, AMPLITUDES_APART)
"""Those that decide what several recordings share."""
RULES: tuple[Rule, ...] = tuple(value for value in list(globals().values()) if isinstance(value, Rule))


def document() -> str:
    """docs/rules.md."""
    head = (
        "# Rules\n\nEvery number that moves a verdict, where it comes from, and what repeats it (`benchmarks` is in a\n"
        "checkout). Made from harness/diagnosis/rules.toml by `python -m harness.diagnosis.rules`; a result carries\n"
        "those that decided it.\n\n"
        "| rule | value | what it decides | origin |\n|---|---|---|---|\n"
    )
    rows = [f"| {r.name} | {r.value:.4g} {r.unit if r.unit != '1' else ''} | {r.moves} | {r.origin} |\n" for r in RULES]
    for w in (POSTERIOR, FORCE_POSTERIOR):
        values = ", ".join(f"{name} {value:.3g}" for name, value in w.values.items())
        rows.append(f"| {w.name} | {values} | {w.moves} | {w.origin} |\n")
    return head + "".join(row.replace(" |", " |") for row in rows)


if __name__ == "__main__":
    sys.stdout.write(document())

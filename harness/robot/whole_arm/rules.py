"""Every number that moves a verdict on a whole arm's log: its value, its unit, what it moves, where it comes from."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Rule:
    """A number that moves a verdict.

    name : as results call it. value, unit : "1" for a pure number. moves : what it decides. origin : a source, a
    derivation, or the command that simulates it.
    """

    name: str
    value: float
    unit: str
    moves: str
    origin: str


NAMED = Rule(
    "named",
    15.0,
    "evidence",
    "an effect or an error of the model is named",
    "TBD",
)
RIVAL = Rule(
    "rival",
    10.0,
    "evidence",
    "what explains the same and is behind by less is listed beside what is named",
    'Kass and Raftery 1995, J. Am. Stat. Assoc. 90, 773, section 3.2: "very strong" evidence',
)
MAIN = Rule(
    "main",
    0.5,
    "share",
    "an effect that takes more than this of what the base leaves beyond the noise is the main one",
    "most of the misfit, as the word says",
)
EXPLAINED = Rule(
    "explained",
    1.5,
    "rms",
    "what a model leaves is no more than so many times the noise of the recorded torque, so that it explains the joint",
    "a judgement: noise that remembers is up to so much larger than white noise of the same recording above the filter",
)
MOST = Rule(
    "most-named",
    3.0,
    "effects",
    "so many effects of a joint, and so many errors of the model, are named at most",
    "a judgement: beyond three the catalogue follows what is not in it",
)
LEAST_SAMPLES = Rule(
    "least-samples",
    60.0,
    "samples",
    "a joint with fewer guarded samples, or a tenth of it in either direction, does not move enough to be judged",
    "three numbers and an autoregression of order 8 need several samples each: a judgement",
)
ENOUGH_TURNS = Rule(
    "enough-reversals",
    5.0,
    "reversals",
    "presliding, static friction, backlash and delay of one joint are judged where it reverses at least so often",
    "a variance between reversals from fewer has t quantiles above 10 at the level of a name",
)


RULES = tuple(value for value in list(vars().values()) if isinstance(value, Rule))

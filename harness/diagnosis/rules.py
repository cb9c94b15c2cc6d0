"""Every number that moves a verdict: its value, its unit, what it moves, and where it comes from.

A rule is used as ``RULE.value``. Numbers that only decide how much work is done, or how a curve is smoothed, stand
beside the code that uses them. docs/rules.md is made from this file: ``python -m harness.diagnosis.rules``.
"""

import math
import sys
from dataclasses import dataclass

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


NAMES = len({term.name for term in NAMED})
_PAIRS = NAMES * (NAMES - 1) // 2

DECISIVE = Rule(
    "decisive",
    10.0,
    "BIC",
    "one model is preferred to another; a name nearer than this stays as an alternative, a term missed by less is left"
    " out again",
    'Kass and Raftery 1995, J. Am. Stat. Assoc. 90, 773, section 3.2: "very strong" evidence',
)
EVEN = Rule(
    "even",
    2.0,
    "BIC",
    "a lone law that explains a recording is named, and not listed beside another that does",
    'Kass and Raftery 1995, section 3.2: below it "not worth more than a bare mention"; where the zero of the position'
    " is unknown another must be worse by the margin of a main effect",
)
AMONG_NAMES = Rule(
    "among-names",
    DECISIVE.value + 2.0 * math.log(NAMES),
    "BIC",
    "a first term is added to viscous and Coulomb friction",
    f"decisive, and 2 ln of the number of names: before the recording is seen each of the {NAMES} names is as likely"
    " as the next; it grows with the catalogue",
)
SECOND_TERM = Rule(
    "second-term",
    40.0,
    "BIC",
    "a second term is added to a first",
    "far above what the best second term takes off where one effect is hidden and its law fitted: nothing in 130 of"
    " 133 free decays, 0.42, 3.5 and 41 in the others, so that 99 % are below 2.5; the 41 belong to a law whose own fit"
    " stopped beside its best (1.08 chi-square a point, of which another start leaves 1.01). What is above 2.5 is"
    " caution (python -m benchmarks.calibrate second-term --draws 144)",
)
MOST_TERMS = Rule(
    "most-terms",
    2.0,
    "terms",
    "a free decay is searched for models of so many terms",
    "three laws of three parameters each follow the amplitude and the phase of every cycle of a decay of ten: nothing"
    " is left that could contradict them",
)
MOST_FORCE_TERMS = Rule(
    "most-force-terms",
    3.0,
    "terms",
    "a force is searched for models of so many terms",
    "a driven path comes back to the same places at other speeds, so that one law more than in a decay can be told",
)
FLEXIBLE = Rule(
    "flexible-law",
    3.0,
    "parameters",
    "a pair that holds a law of so many parameters must stand apart from pairs of other families",
    "a law with a place, a width and a height bends towards any one feature",
)
APART = Rule(
    "pairs-apart",
    30.0,
    "BIC",
    "what the next pair of another family must lose before a pair with a flexible law is named",
    f"decisive and 2 ln of the number of pairs ({DECISIVE.value + 2.0 * math.log(_PAIRS):.3g}), and what chance adds"
    " between rivals where an effect of no catalogue is followed. Draws leave room: of 12 searches where such a pair is"
    " hidden 9 end at one, all at least 86 from the next of another family; of 11 with an effect of no catalogue none"
    " ends at one (python -m benchmarks.calibrate pairs-apart --draws 23)",
)
STRUCTURE = Rule(
    "structure",
    1e-3,
    "chance",
    "viscous and Coulomb friction are said not to explain a recording",
    "level of the test: one sound control in a thousand (rate simulated: pytest -m full"
    " tests/diagnosis/test_error_rates.py)",
)
STRUCTURE_NAMED = Rule(
    "structure-named",
    5e-3,
    "chance",
    "a model that names something is said to explain a recording",
    "level of the test: five sound models in a thousand are turned away; what mimics another effect leaves little, so"
    " that the level is higher than for a base model",
)
LAW_KNOWN = Rule(
    "law-known",
    1e-4,
    "share of what terms explain",
    "what a model that names something leaves is no structure of its own",
    "a hundredth of an effect in size: of no law of friction is the form known more closely, and so far is a simulation"
    " trusted at jumps. Against noise alone the same law fails wherever an effect is strong",
)
ADVISED = Rule(
    "advised",
    1.5,
    "chi-square per point",
    "changes of a simulation are advised by a model that leaves less than this, and by a main effect with a caution",
    "half as much misfit as noise: beyond it numbers move by more than the noise moves them, and what is missing has a"
    " part in them that no standard error counts",
)
COLOUR_ALONE = Rule(
    "colour-alone",
    0.02,
    "chance",
    "the whole residual is taken for coloured noise",
    "level of the test: of residuals that are nothing else one in fifty is not taken for it, and what is missing must"
    " hide from the same test at twenty times the level of the verdict",
)
STEADY = Rule(
    "steady",
    1e-3,
    "chance",
    "the whole residual is not taken for coloured noise where one stretch of it is stronger than the rest",
    "level of the test: of steady noise one residual in a thousand is not taken for it",
)
AS_FAST = Rule(
    "as-fast",
    0.7,
    "of the power",
    "the whole residual is taken for coloured noise only where windows of a quarter of a swing see so much of it",
    "of 19,736 residuals that are such noise, of 300 to 4,000 samples, none shows less, the least 0.73"
    " (python -m benchmarks.calibrate colours --draws 400 --seed 1)",
)
PREDICTS_WORSE = Rule(
    "predicts-worse",
    1.05,
    "ratio of rmse",
    "a refined model that predicts what was held out worse than this is said to; one that says a force to its noise and"
    " whose own motion misses more than the base model's by this explains nothing",
    "a term forced into a control, which needs none, raises the error of what was held out by 1.8 % at most of 500"
    " (reports/proof, harness prove)",
)
LOOSE = Rule(
    "loose",
    1.0,
    "standard errors over the number",
    "a law of a fitted force whose leading number is looser than itself is no name, nor is one that explains a motion"
    " at a rate in time that is",
    "below one standard error nothing says that there is any of it: zero is as near as the number",
)
HAND_SHOWN = Rule(
    "hand-shown",
    0.5,
    "half-cycles",
    "a hand is looked for so long after a release that the recording shows",
    "a hand that gives way over 10 to 50 ms is off within a quarter of a period of anything slower than 5 Hz",
)
HAND_KNOCKS = Rule(
    "hand-knocks",
    1.0,
    "half-cycles",
    "knocks, or anything that acts no longer, are looked at as a hand that still held the slider",
    "a slider that is let go at rest turns a half-cycle later at the earliest: a knock before that is another"
    " release, two, or friction that is then gone, are what holds it at its place, then lets go: a held pendulum with"
    " 11 samples a swing shows either (tests/diagnosis/test_release.py)",
)
HAND_UNSEEN = Rule(
    "hand-unseen",
    2.5,
    "half-cycles",
    "a hand is looked for so long where the recording shows no release and nothing else explains it",
    "the first turning point after a motion that began unseen, and a whole period to be sure",
)
HAND_USUAL = Rule(
    "hand-usual",
    3.5,
    "half-cycles",
    "stretch after it from which the level of a usual residual is taken",
    "at least three turning points, so that a jump beside one does not make the level",
)
HAND_STANDS_OUT = Rule(
    "hand-stands-out",
    5.0,
    "standard deviations of noise",
    "a sample shows a hand",
    "one in two million by normal noise: none in a recording",
)
HAND_UNUSUAL = Rule(
    "hand-unusual",
    3.0,
    "times the usual residual",
    "a sample shows a hand",
    "the largest of a sine is 1.4 times its rms; a factor of two over that is none of the residual's own",
)
HAND_TURNS = Rule(
    "hand-turns",
    3.0,
    "reversals",
    "must stay after what a hand touched",
    "a base model has omega_n, zeta and x_k: fewer reversals than numbers contradict none of them",
)
FORCE_HELD = Rule(
    "force-held",
    0.98,
    "ratio of chi-square",
    "a measured force counts as held between its samples",
    "chance alone moves the ratio by 1/sqrt(N): 2 % are two of these at the least of 2,500 values; asked again beside"
    " what comes nearest, 78 of 80 effects on driven plants are named or listed, none called another family, 40 of 40"
    " controls quiet (python -m benchmarks.calibrate driven --draws 120 --seed 20261125)",
)
GUARD_SPEED = Rule(
    "guard-speed",
    0.05,
    "of the rms speed",
    "of a robot's joint, a fitted force does not count within the smoothing's reach of a slower sample",
    "30 logs of one joint under a servo, with viscous and Coulomb friction alone: f_k is at most 0.22 % off,"
    " and nothing is named in any; where only speeds without a sure sign are left out it is 0.18 % off at most"
    " (python -m benchmarks.calibrate guard-speed --draws 30)",
)
INPUT_NOISE_DRAWS = Rule(
    "input-noise-draws",
    11.0,
    "draws",
    "chi-square that noise of a force leaves beyond first order: the most of so many draws",
    "the next draw exceeds the most of n with chance 1/(n + 1): one in twelve",
)
NULL_DRAWS = Rule(
    "null-draws",
    4.0,
    "draws",
    "what a search takes off a true model's force: the most of so many draws",
    "the next draw exceeds the most of n with chance 1/(n + 1): one in five, and the evidence asked for on top makes it"
    " rare",
)
OVER_SIMULATED = Rule(
    "over-simulated",
    1.5,
    "ratio of rms",
    "a fitted force leaves more than noise, the most of some simulated draws (null-draws), at some length of means",
    "the draws share one motion, whose reversals the smoothing rounds off at other places than the recording's: set"
    " after 23 sound recordings, six kinds of noise, the worst of which exceeded the most of four draws 1.42 times; a"
    " noisy force (2 % of it) can exceed it (pytest tests/diagnosis/test_fitted_force_grades.py)",
)
STROKE_CUT = Rule(
    "stroke-cut",
    2.0,
    "correlation times",
    "a stroke of a driven motion is cut into pieces at least so long, each a word",
    "integrated correlation time: values twice as far apart as the residual remembers are all but independent",
)
PERIODS_COUNTED = Rule(
    "periods-counted",
    3.0,
    "periods",
    "of a drive that repeats itself only so many periods count as words",
    "the same path again says what was said; two repeats show that it is not chance",
)
DRIVE_REPEATS = Rule(
    "drive-repeats",
    0.02,
    "share of squares",
    "a force counts as periodic: it differs so little from itself one period earlier",
    "a sixth of the swing in rms (sqrt(0.02) = 0.14): more than a loop's noise and start, less than waves of different"
    " periods come to by chance",
)
CONFIRMED = Rule(
    "confirmed",
    2.0,
    "standard errors",
    "the force error on another recording falls",
    "one-sided level of 2.3 %",
)
STEPPED = Rule(
    "stepped",
    5.0,
    "BIC",
    "a recording is the trace of an engine that steps",
    "a lag of exactly one step is one parameter less, worth ln N (5 at 150 samples)",
)
STEPPED_WITHIN = Rule(
    "stepped-within",
    1.1,
    "steps",
    "friction has turned round, so that it is dry friction to this engine",
    "friction that turns round within one step cannot be told from a jump; a tenth for the fit's own error",
)
PERIOD_SEEN = Rule(
    "period-seen",
    0.5,
    "periods",
    "a law that repeats in time is tried",
    "less than half a period is a slow change of any kind, a trend; the other bound is half the rate of the samples,"
    " beyond which a frequency shows as another (Nyquist)",
)
SAMPLED = Rule(
    "sampled",
    0.5,
    "share of the way",
    "a law that repeats along a driven travel is tried: so much of the way at least is gone at two samples a period",
    "where a sample goes further, another period in its guise shows the same (Nyquist); half, so that most of what such"
    " a law does is seen as what it is",
)
FOLLOWED = Rule(
    "followed",
    50.0,
    "% of the motion (NRMSE)",
    "a driven recording that no law explains is fitted by its force, where the base model follows less of the motion",
    "a motion that is right but for its phase misses half of its deviation when it is a twelfth of a period late"
    " (2 sin 15 deg): what is left of it says more of the phase than of a law",
)
MOVES = Rule(
    "moves",
    0.0,
    "% of the motion (NRMSE)",
    "a law of a fitted force is looked at: its own motion follows so much of the recording's, or no less than the base"
    " model's",
    "what stays at its mean follows nothing (0 %); where friction takes up the force that drives, a law of time says"
    " that force and no motion",
)
RELAXATION_SEEN = Rule(
    "relaxation-seen",
    1.0,
    "recordings",
    "a law that relaxes is tried, its relaxation time at most this long",
    "a branch that relaxes more slowly is a spring with its rest where it was let go, which is a constant force",
)
PRESLIDING_SEEN = Rule(
    "presliding-seen",
    1.0,
    "travels",
    "a bristle is tried, its presliding displacement f_k/sigma0 at most this long",
    "over one travel a bristle that bends further comes within 1/e of sliding at most: it is a spring, whatever f_k",
)
SCREEN_GAIN = Rule(
    "screen-gain",
    6.0,
    "chi-square",
    "a law of two or more parameters is fitted at all",
    "below 2 ln N + decisive for every N: a law that promises less cannot be named; first order promises up to twice"
    " or half of it",
)
SCREEN_GAIN_OF_ONE = Rule(
    "screen-gain-of-one",
    2.0,
    "chi-square",
    "a law of one parameter is fitted at all",
    "as screen-gain; the expectation of chance is 1, and a fit of one parameter costs little",
)
SCREEN_SHARE = Rule(
    "screen-share",
    0.04,
    "share of the best",
    "a law of two or more parameters is fitted at all; any law beside one that leaves structure",
    "a third of the least share of the best promise that a true effect had in the screen: 0.117 (attached-mode), of"
    " 45 free decays (python -m benchmarks.calibrate screen-share --draws 45), and a true second one beside the first:"
    " 0.123 (python -m benchmarks.calibrate pair-promise --draws 67)",
)

PAIR_PROMISE = Rule(
    "pair-promise",
    12.0,
    "chi-square per point",
    "a model that explains nothing is extended by a second term only if one promises to come so near the noise, and"
    " only by those that do",
    "above all that a true second term promises to first order: of 51 half promise 1.05 at most, one in ten more than"
    " 2.4, one in twenty more than 5.7, the worst 11.2 (python -m benchmarks.calibrate pair-promise --draws 67); what"
    " promises more is not searched, and its pair not named",
)
FRICTION_GONE = Rule(
    "friction-gone",
    0.05,
    "share of the damping",
    "laws that bend friction are also looked for from a base with friction in it",
    "below a twentieth of the damping's energy over a cycle friction answers less than the noise of a screen",
)
MOST_WORDS = Rule(
    "most-words",
    60.0,
    "words",
    "a misfit is counted as so many independent words at most",
    "not settled by draws: of 144 main effects of machines 30, 60 and 120 name 51, and of 72 controls claim none"
    " (python -m benchmarks.calibrate main-effect --draws 240 --seed 20261125)",
)
HAS_BEGUN = Rule(
    "has-begun",
    0.15,
    "share of the range",
    "a motion has begun, so that the next turning point is free of the hand",
    "half of what a decay of zeta 0.05 has lost after a half-cycle (1 - exp(-0.05 pi) = 0.145)",
)
BEGINS_ALIKE = Rule(
    "begins-alike",
    2.0,
    "ratio of rms",
    "a misfit that comes to no name from the first turning point on is looked at from the release on: the best law"
    " leaves of the beginning at most so many times what it leaves of the half-swing after it",
    "what is left of a law up to the fourth power of the swing doubles where a half-cycle takes a sixth of it (1.2^4 ="
    " 2.07); a hand that holds the slider for a tenth of a period leaves a fifth of the swing (1 - cos 36 deg)",
)
GAIN = Rule(
    "gain",
    6.0,
    "evidence in words",
    "a term improves on the base model where the misfit is not noise",
    'Kass and Raftery 1995, section 3.2: "strong" evidence',
)
TAKEN = Rule(
    "taken",
    0.04,
    "1",
    "a law that more often than this takes most of a motion's misfit which it has not made has less evidence, by twice"
    " the logarithm of how much more often",
    "half of the laws do so on fewer of the simulated machines without them (python -m benchmarks.calibrate taken"
    " --draws 400 --seed 31)",
)
MARGIN = Rule(
    "margin",
    6.0,
    "evidence in words",
    "one term is told apart from another where the misfit is not noise, or the zero of the position is unknown",
    'Kass and Raftery 1995, section 3.2: "strong" evidence',
)
LEAST_RATIO = Rule(
    "least-ratio",
    1.25,
    "ratio of squares",
    "another term must leave so much more, however many cycles there are",
    "at sixty words a margin of 6 is a ratio of 1.1, which unmodelled small effects shift by themselves; not settled by"
    " draws: of 144 main effects of machines 1.05, 1.1, 1.15 and 1.25 name 51, none wrongly, and claim no control"
    " (python -m benchmarks.calibrate main-effect --draws 240 --seed 20261125)",
)
CHANCE = Rule(
    "chance",
    0.85,
    "chance",
    "a name that stands apart from every other is the main effect, and not a list",
    "the least, in steps of .05, that claims at most one control in fifty: of 650 machines with a main effect it is the"
    " name that stands apart in 298 (another one in 9), and one stands apart in 47 of 650 controls; by weights made of"
    " the other draws a chance of .5 names 291, 7 wrongly, and claims 32 controls, .7 names 265, 4 wrongly, and claims"
    " 19, .85 names 218, 3 wrongly, and claims 10; what is said to be right at .52, .68, .84 and .96 is so at .54, .67,"
    " .85 and .96 (python -m benchmarks.calibrate chance --draws 1300 --seed 20261129, which makes the weights)",
)
_CHANCE_DRAWS = "a logistic regression on the draws of chance, each feature with a prior of unit variance"
CHANCE_INTERCEPT = Rule(
    "chance-intercept",
    -2.366,
    "logit",
    "the chance that a name that stands apart is the main effect, with what follows added",
    _CHANCE_DRAWS,
)
CHANCE_ALIKE = Rule(
    "chance-alike",
    -0.798,
    "logit",
    "that chance falls with the sum of the squares of the other names' shares, in its own",
    _CHANCE_DRAWS,
)
CHANCE_LOOSE = Rule(
    "chance-loose",
    -0.714,
    "logit",
    "that chance falls with the log of the largest relative standard error of its numbers",
    _CHANCE_DRAWS,
)
CHANCE_LONG = Rule(
    "chance-long",
    -1.168,
    "logit",
    "that chance falls with the log of the cycles: more small effects are seen in many",
    _CHANCE_DRAWS,
)
CHANCE_OF_SHARE = Rule(
    "chance-share",
    6.523,
    "logit",
    "that chance rises with its share of the misfit",
    _CHANCE_DRAWS,
)
CHANCE_COMPANY = Rule(
    "chance-company",
    2.139,
    "logit",
    "that chance rises with the share of the misfit that it takes beside the other name with which it leaves least",
    _CHANCE_DRAWS,
)
FORCE_CHANCE = Rule(
    "force-chance",
    0.5,
    "chance",
    "a name that stands apart from every other is the main effect of a fitted force, and not a list",
    "the least, in steps of .05, that claims at most one control in fifty: of 261 driven machines with a main effect,"
    " and with a force that is fitted, it is the name that stands apart in 45 (another one in 5), and one stands "
    "apart in 13 of 171 controls; by weights made of the other draws a chance of .5 names 37, 3 wrongly, and claims 3"
    " controls, .7 names 34, 3 wrongly, and claims 2, .85 names 23, 1 wrongly, and claims 2; what is said to be right"
    " at .24, .49, .83 and .94 is so at .26, .50, .87 and .82 (the last of 21 draws, whose standard error is .05, so "
    "that the command says that it falls short) (python -m benchmarks.calibrate force-chance --draws 900 --seed "
    "20261130, which makes the weights)",
)
_FORCE_CHANCE_DRAWS = "a logistic regression on the draws of force-chance, each feature with a prior of unit variance"
FORCE_CHANCE_INTERCEPT = Rule(
    "force-chance-intercept",
    -11.023,
    "logit",
    "the chance that a name that stands apart is the main effect of a fitted force, with what follows added",
    _FORCE_CHANCE_DRAWS,
)
FORCE_CHANCE_ALIKE = Rule(
    "force-chance-alike",
    -0.184,
    "logit",
    "that chance falls with the sum of the squares of the other names' shares, in its own",
    _FORCE_CHANCE_DRAWS,
)
FORCE_CHANCE_LOOSE = Rule(
    "force-chance-loose",
    -0.227,
    "logit",
    "that chance falls with the log of the largest relative standard error of its numbers",
    _FORCE_CHANCE_DRAWS,
)
FORCE_CHANCE_LONG = Rule(
    "force-chance-long",
    0.698,
    "logit",
    "that chance rises with the log of half the independent strokes",
    _FORCE_CHANCE_DRAWS,
)
FORCE_CHANCE_OF_SHARE = Rule(
    "force-chance-share",
    9.237,
    "logit",
    "that chance rises with its share of the misfit",
    _FORCE_CHANCE_DRAWS,
)
FORCE_CHANCE_COMPANY = Rule(
    "force-chance-company",
    2.685,
    "logit",
    "that chance rises with the share of the misfit that it takes beside the other name with which it leaves least",
    _FORCE_CHANCE_DRAWS,
)
NEARLY_AS_MUCH = Rule(
    "nearly-as-much",
    0.75,
    "share of the first's",
    "what a name that may be a sum of several is listed with takes as much off",
    "it adds names to look at, and takes none away: where the first takes 3/5, those that leave at most 1.4 times as"
    " much",
)
MOST_LIKELY = Rule(
    "most-likely",
    0.5,
    "chance",
    "a name beside which nothing else is listed is told as the most likely one, and not as the largest single part",
    "more likely than all else together",
)
SHARE_OF_EXCESS = Rule(
    "share-of-excess",
    0.6,
    "share of squares",
    "one term is the main part of the misfit beyond the sensors' noise",
    "more than the rest together, by half: of 144 main effects of machines .5 names 51 and lists 114, .6 names 51 and"
    " lists 113, .7 names 49 and lists 107"
    " (python -m benchmarks.calibrate main-effect --draws 240 --seed 20261125)",
)
SHARE_OF_MISFIT = Rule(
    "share-of-misfit",
    0.4,
    "share of squares",
    "one term is the main part of what is left, noise included",
    "with share-of-excess: then noise is at most a third of what is left (1 - .4/.6), and the rest of it is a misfit to"
    " speak of; of 144 main effects of machines .4 names 51 and lists 113, .5 names 50 and lists 111; of 72 controls"
    " neither claims one"
    " (python -m benchmarks.calibrate main-effect --draws 240 --seed 20261125)",
)
HELD_OUT = Rule(
    "held-out",
    0.9,
    "ratio of rmse",
    "a term predicts blocks that it was not fitted to better than the base",
    "a tenth less than without it: a guard, which the draws do not settle; of 144 main effects of machines .8 names 51"
    " and lists 111, .9 names 51 and lists 113, 1 names 52 and lists 116, none wrongly"
    " (python -m benchmarks.calibrate main-effect --draws 240 --seed 20261125)",
)
PREDICTS_BETTER = Rule(
    "predicts-better",
    2.0,
    "standard errors over blocks",
    "another term predicts better, so that both are listed",
    "one-sided level of 2.3 %",
)
RUN_BETTER = Rule(
    "run-better",
    0.7,
    "ratio of rmse",
    "a free run of the last 40 %, from a fit of the first 60 %, is so much better that a term counts though it takes"
    " little off where it was fitted",
    "half of the squares (.7^2); not settled by draws: of 144 main effects of machines .5 lists 112, .7 and .85 113"
    " (python -m benchmarks.calibrate main-effect --draws 240 --seed 20261125)",
)
RUNS_ON_BETTER = Rule(
    "runs-on-better",
    0.7,
    "ratio of rmse",
    "another name that takes most of the misfit runs on so much better than the first that both are listed",
    "half of the squares, as run-better; not settled by draws: of 144 main effects of machines it names 51 and lists"
    " 113, no such rule names 51 and lists 114, .85 names 51 and lists 114; none claims a control of 72"
    " (python -m benchmarks.calibrate main-effect --draws 240 --seed 20261125)",
)
AMONG_ALIKE = Rule(
    "among-alike",
    float(NAMES),
    "names",
    "what a free run may be better by through chance alone",
    "each name of the catalogue could have been the one",
)
ZERO_REACH = Rule(
    "zero-reach",
    10.0,
    "half travels",
    "a constant part of the force is the zero of a spring; beyond, it is a push",
    "derivation: a spring stretched to ten half travels pulls with ten times what the travel changes of its force; a"
    " recording that sees the spring by a tenth of the force sees no more of it",
)
LARGE_ANGLE = Rule(
    "large-angle",
    0.35,
    "rad",
    "a swing from which a pendulum is tried where nobody says what pulls it back",
    "below it sine and line differ by 2 % of the force at most (0.35^2 / 6), which stiffness laws of other kinds take"
    " up as well",
)
SAME_CLOCK = Rule(
    "same-clock",
    1.5,
    "periods over the recording",
    "a law with a clock keeps time with the swing, and is no name; a model that explains a recording by a clock on the"
    " swing itself, by one so slow, or by two so near is graded as one that does not",
    "two frequencies nearer than one over the length of the recording are one (Rayleigh), and half of that again for"
    " a period that changes with the swing; of 93 such laws that could be listed, of 240 machines, 5 are true"
    " (python -m benchmarks.calibrate main-effect --draws 240 --seed 20261125)",
)
LEAST_CYCLES = Rule(
    "least-cycles",
    8.0,
    "cycles",
    "a main effect is named; below it at most a list. A lone law that explains all is named below it where its evidence"
    " is decisive in the words that the base's own parameters leave",
    "the base's own six parameters eat words: were a misfit one word a stroke and laws directions by chance, the best"
    " of ten would pass gain and share at four cycles in 100 %, at five in 73 %, at six in 34 %, at eight in 5 % (of"
    " twelve: 100, 80, 39, 6 %). That is the cautious figure: of 213 simulated decays with a misfit of random amplitude"
    " and phase in each stroke 0.9 % pass at four cycles, none from five on"
    " (python -m benchmarks.calibrate few-cycles --draws 213); of 144 main effects of machines 8 names 51 and 6 names"
    " 56, none wrongly (python -m benchmarks.calibrate main-effect --draws 240 --seed 20261125)",
)
MOST_LISTED = Rule(
    "most-listed",
    4.0,
    "names",
    "a list is given",
    "a list of more says nothing that an experiment could decide between",
)
TRACES_STRUCTURE = Rule(
    "traces-structure",
    0.01,
    "chance",
    "two traces are said to differ (harness compare)",
    "level of the test: of pairs of the same motion one in a hundred is called different",
)
CLOCK_RATE = Rule(
    "clock-rate",
    1e-3,
    "relative",
    "two traces that differ by a rate of their clocks alone are said to differ: the same is read as another frequency,"
    " and only a force that drives both, measured in both, proves a clock",
    "ten times what quartz clocks differ by at worst (1e-4); as a frequency it is a stiffness of 0.2 %, less than a"
    " simulation is changed for",
)
TRACES_LOUD = Rule(
    "traces-loud",
    1.5,
    "mean square over the noise's",
    "two traces are said to differ, whatever the structure of what is between them; one channel is said to, where the"
    " others are below",
    "chance moves the mean square of N samples by sqrt(2/N), 0.2 at the least of 50, and an estimated noise by as"
    " much: two of these",
)
CLOCK_DRIFT = Rule(
    "clock-or-spring",
    0.03,
    "relative",
    "a drift of stiffness is listed beside a drift of the recording's clock, the frequency changing by so much at most",
    "rates of cameras and of controllers without a crystal change by 1 to 3 % with temperature and load; a spring and a"
    " clock change one channel of a free decay alike, so that only its size speaks for the spring",
)
CHANGED = Rule(
    "changed",
    3.0,
    "standard errors of the recording's figure",
    "a parameter of a simulation is to be changed",
    "two-sided level of 0.3 % each: of three parameters that are right one is named in 1 % of recordings",
)
CHANGED_BY = Rule(
    "changed-by",
    1e-3,
    "relative",
    "and it is off by so much",
    "as clock-rate: a frequency is known to the clock of its recording, and 0.1 % of any parameter moves nothing that a"
    " simulation is made for",
)
ONE_CHANNEL = Rule(
    "one-channel",
    0.95,
    "share of the excess",
    "what is between two traces is said to be one channel's",
    "the others together hold less than a twentieth, and none of them is loud: nothing else is left to be said of them",
)
CHANNELS_AGREE = Rule(
    "channels-agree",
    3.0,
    "standard errors",
    "two channels of a recording are said to disagree in gain, lag or offset",
    "two-sided level of 0.3 % each",
)
CHANNELS_RELATED = Rule(
    "channels-related",
    0.5,
    "share of squares",
    "two channels of a recording are said not to belong together",
    "a line through the one leaves half of the other's squares or more: more is strange than is common",
)
TABLE_OVER_NOISE = Rule(
    "table-over-noise",
    3.0,
    "sensors' noise",
    "what is left without a name is so much that a table of it is fitted",
    "a tenth of the squares is then noise, so that a table has something to predict",
)
TABLE_BETTER = Rule(
    "table-better",
    0.9,
    "ratio of rmse",
    "a table stays: it predicts blocks that took no part in its fit so much better than the model without it",
    "as for a term (held-out); measured with python -m benchmarks.calibrate tables; of fitted forces 20 of 20 with a"
    " law of no catalogue predict at .7 of the base's error or better, and of 10 without one none gets a table"
    " (python -m benchmarks.calibrate force-tables --draws 40 --seed 5)",
)
TABLE_ERRORS = Rule(
    "table-errors",
    2.5,
    "standard errors over blocks",
    "a table stays: its better prediction is no chance",
    "one-sided level of .6 %, by Student's distribution for few blocks: of 132 controls whose misfit is random one gets"
    " a table, and 311 of 375 static laws of no catalogue one that predicts at .7 of the base's error or better"
    " (python -m benchmarks.calibrate tables --draws 330 --seed 20261125, and --seed 777)",
)
TABLE_BAND = Rule(
    "table-band",
    1.35,
    "of a standard error",
    "one standard error that is drawn about a table, and that its words must exceed",
    "two of what the fit itself says hold the true force on 90 % of the range in 271 of 310 tables, two of these in 282"
    " (python -m benchmarks.calibrate tables --draws 330 --seed 20261125, and --seed 777), and in 147 of 155 of other"
    " draws (--seed 4243)",
)
TABLE_WORDS = Rule(
    "table-words",
    1.0 / 3.0,
    "parameters a word",
    "how many effective parameters a table may have",
    "three words a parameter at least; a bound, within which inner blocks choose",
)

PATH_APART = Rule(
    "path-apart",
    0.5,
    "of the recording",
    "a cell of the plane of position and speed counts as seen again so long after",
    "what drifts along the recording has gone half of its way by then, so that a table cannot follow it",
)
PATH_AGAIN = Rule(
    "path-again",
    0.9,
    "share of the time",
    "a driven path comes back, so that a force over position and speed at once is tried: so much of it is spent in"
    " cells (eight along each side) that are seen again",
    "24 motions that fade to .7 or less spend .78 of it there at most, those of 24 machines along waves .95 at least"
    " (python -m benchmarks.calibrate force-tables --draws 24)",
)

COVARIATE_VARIES = Rule(
    "covariate-varies",
    3.0,
    "its own noise",
    "a covariate is taken: its spread is so many times its noise, as a whole and beside the base model and time",
    "a regression on it then falls short by a ninth at most: the noise's share of its squares (Fuller 1987, 1.1)",
)
COVARIATE_APART = Rule(
    "covariate-apart",
    10.0,
    "variance inflation",
    "a caution stands beside a covariate: the base model and time say so much of what it does that its gain's variance"
    " is so many times what it would be without them",
    "Kutner, Nachtsheim and Neter 2004, Applied Linear Regression Models, section 10.5: a largest factor above 10",
)
MASS_UNSEEN = Rule(
    "mass-unseen",
    0.1,
    "rms of the force left over",
    "a mass whose part of the force is less, beside the law that says the force best, is not fitted but taken as so"
    " large",
    "derivation: what has a tenth of the rms and is independent of the rest adds a hundredth to its squares",
)
COVARIATES = (DECISIVE, COVARIATE_VARIES, COVARIATE_APART)
"""Those that decide whether and how a covariate enters."""

POOLED = Rule(
    "pooled",
    0.001,
    "chance",
    "several recordings differ in their base parameters, so that what differs is looked for",
    "one in a thousand where noise is all that differs: of 41 sliders let go twice with nothing hidden 2 are below .05,"
    " 1 below .01, none below .001; of 21 machines in which something is missing 13 are, so that the parameter must"
    " also say more than the catalogue does (own) (python -m benchmarks.calibrate together --draws 41); of 15 driven"
    " pairs with nothing hidden 2 are below .05, none below .01 (python -m benchmarks.calibrate forces-together"
    " --draws 60)",
)
OWN = Rule(
    "own",
    6.0,
    "evidence in words",
    "a base parameter becomes each recording's own, if it also says more than a law that all share",
    'Kass and Raftery 1995, section 3.2: "strong" evidence; of 21 machines let go twice, as they were, none is said to'
    " differ, of 20 with 5 % more inertia the second time 19, all in inertia"
    " (python -m benchmarks.calibrate together --draws 41); of 30 driven pairs, as they were, none, of 30 with 10 %"
    " more inertia or 20 % less friction 23, 22 in what it is"
    " (python -m benchmarks.calibrate forces-together --draws 60)",
)
AMPLITUDES_APART = Rule(
    "amplitudes-apart",
    1.5,
    "ratio of swings",
    "several recordings part a law of the amplitude from one of the time: a name is then ruled out by evidence alone",
    "a decay to a fifth from two thirds of the amplitude passes each one a quarter of its length earlier"
    " (ln 1.5 / ln 5). Not settled by draws: of 10 machines with small effects besides, 6 of them so far apart, the law"
    " is named in 2 by the larger decay alone and in 4 by both, and another is named or listed without it in 1 and in 3"
    " (python -m benchmarks.calibrate amplitudes --draws 10)",
)
POOLING = (POOLED, OWN, AMPLITUDES_APART)
"""Those that decide what several recordings share."""

RULES: tuple[Rule, ...] = tuple(value for value in list(globals().values()) if isinstance(value, Rule))


def document() -> str:
    """docs/rules.md."""
    head = (
        "# Rules\n\nEvery number that moves a verdict, where it comes from, and what repeats it (`benchmarks` is in a\n"
        "checkout). Made from harness/diagnosis/rules.py by `python -m harness.diagnosis.rules`; a result carries\n"
        "those that decided it.\n\n"
        "| rule | value | what it decides | origin |\n|---|---|---|---|\n"
    )
    rows = (f"| {r.name} | {r.value:.4g} {r.unit if r.unit != '1' else ''} | {r.moves} | {r.origin} |\n" for r in RULES)
    return head + "".join(row.replace(" |", " |") for row in rows)


if __name__ == "__main__":
    sys.stdout.write(document())

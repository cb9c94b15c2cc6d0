"""Every number that moves a verdict on a whole arm's log: its value, its unit, what it moves, where it comes from."""

from harness.diagnosis.rules import Rule

NAMED = Rule(
    "named",
    16.0,
    "evidence",
    "an effect or an error of the model is named",
    "some 85 candidates an arm: by chance alone one in a hundred clean arms has one this sure; of 140 simulated ones"
    " one had, the best of the others was at 10.9 (python -m benchmarks.robot_calibrate --only clean,"
    " --draws 60 --seed 4 and --draws 80 --seed 8)",
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
    "an effect that takes more than this of what the base leaves beyond the noise is the main one, and at reversals the"
    " only one that is named",
    "most of the misfit, as the word says; at reversals of 40 sound arms that rest (python -m benchmarks.draws"
    " path:whole-arm --draws 80 --seed 7501) seven laws took up to .13",
)
EXPLAINED = Rule(
    "explained",
    1.5,
    "rms",
    "a model leaves no more than so many times the noise of torque and positions, and explains the joint",
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
    "a joint with fewer guarded samples does not move enough to be judged",
    "three numbers and an autoregression of order 8 need several samples each: a judgement",
)
EITHER_WAY = Rule(
    "either-way",
    0.1,
    "share of least-samples",
    "a joint with fewer guarded samples in either direction does not move enough to be judged",
    "a judgement: Coulomb friction is half the difference of both directions, and its error that of the shorter one",
)
TOLD_GRAVITY = Rule(
    "told-gravity",
    0.1,
    "share of gravity",
    "an offset and gravity are listed as confounded where the motion does not show so large an error of gravity at the"
    " level of a rival",
    "as mass-spread: errors that are expected must be distinguishable from the offset, or the offset may be theirs",
)
TOLD_DELAY = Rule(
    "told-delay",
    0.01,
    "s",
    "viscous friction and a delay are listed as confounded where the motion does not show so long a delay at the level"
    " of a rival",
    "half of delay-spread: one sample of a slow bus, 100 Hz",
)
UNSMOOTHED = Rule(
    "unsmoothed",
    1e-6,
    "rms of the torque",
    "with less noise a record counts as smoothed: whether a model explains it to its noise is not said",
    "a judgement: single precision leaves 3e-8 of a number (2^-24 / sqrt(3)), and no sensor of torque resolves a"
    " millionth of what it measures",
)
SAID_BETTER = Rule(
    "said-better",
    0.995,
    "ratio of rms",
    "what is named is said to predict torque that was not fitted better",
    "three digits are printed: less of a difference shows in none of them",
)
LONGEST_SLIP = Rule(
    "longest-slip",
    0.1,
    "of a joint's span",
    "presliding and backlash are looked for up to this length",
    "a judgement: what takes longer is passed in full at few reversals, and is friction that depends on position",
)
FASTEST_RIPPLE = Rule(
    "fastest-ripple",
    60.0,
    "1/rad",
    "ripples of the torque are looked for up to this wave number",
    "waves of six degrees: at 1 rad/s 9.5 Hz, and the filter passes what is below 10 to 20 Hz",
)
ENOUGH_TURNS = Rule(
    "enough-reversals",
    5.0,
    "reversals",
    "presliding, static friction, backlash and delay of one joint are judged where it reverses at least so often",
    "a variance between reversals from fewer has t quantiles above 10 at the level of a name",
)

GUARD = Rule(
    "guard",
    0.6,
    "1/f_lowpass",
    "samples nearer to a reversal do not count for the base and for sliding friction; the guard grows by half until"
    " Coulomb friction moves by less than its error",
    "40 ms at 15 Hz: with it Coulomb friction of a log without noise is right to 0.2 %, without it 3 to 10 % too small",
)
REACH = Rule(
    "filter-reach",
    1.6,
    "1/f_lowpass",
    "what is left of a joint is held against its noise at samples no nearer to a reversal, where there are enough",
    "derivation: the slowest pole of the filter, 2 pi sin(pi/8) f_lowpass, has by then died to 2 %; what a joint does"
    " at rest, which no law says, is nearer many times the noise of a quiet log",
)
SURE = Rule(
    "sure-speed",
    4.0,
    "deviations",
    "slower samples, in deviations of the speed's noise, have no sure sign and do not count",
    "a wrong sign in one sample of 30 000",
)
RESTING = Rule(
    "resting",
    0.05,
    "share of the 95 % speed",
    "slower samples do not count: the joint may rest, or creep as it does in engines",
    "friction of engines is regularised, and a joint that sticks creeps with less; .02"
    " names that in one of 6 clean logs of MuJoCo (python -m benchmarks.robot_logs --only mujoco --seed 3)",
)
COVERED = Rule(
    "covered",
    0.04,
    "share of samples",
    "so many guarded samples must be slower than a Stribeck speed for it to be looked for among them; lower ones are"
    " static friction, judged at reversals",
    "three dozen samples of a log of 20 s: fewer hold no shape beside their noise",
)
SLOWEST_RIPPLE = Rule(
    "slowest-ripple",
    2.0,
    "1/rad",
    "ripples of the torque are looked for from this wave number, and from one wave in the joint's span",
    "gravity and its errors go with the sine of the angle, 1/rad",
)
SIZE = Rule(
    "size",
    3.0,
    "spreads",
    "an error of the model is named where it comes out no larger than so many of the spreads expected of it",
    "what comes out larger is not what its name says: on real logs with wrong inertias scales of 0.01 and tilts of 70"
    " rad came out otherwise",
)
LEAST_SIZE = Rule(
    "least-size",
    0.01,
    "spreads",
    "an error of the model whose numbers are all smaller, in spreads expected of them, is allowed for, and named only"
    " where it is the main one",
    "no model is as exact: .1 % of a mass, .2 % of a torque, 1 mrad of a tilt, .2 mrad of a zero, 30 g of a load",
)
WITHIN = Rule(
    "within-a-sample",
    1.0,
    "intervals",
    "a torque, or one joint's at its reversals, that seems early or late by less is no error of the log",
    "derivation: a hold acts half an interval after its sample in the mean, and what a bus hands on is up to one old",
)
STICKS = Rule(
    "sticks",
    0.3,
    "1/f_lowpass",
    "where a joint stays within its encoder's steps for longer, and half of it longer than its accelerations before and"
    " after take to turn it, it rests, and friction there is not judged but allowed for; what is over within the"
    " distance that a joint goes in this time of its own reversal is no presliding",
    "20 ms at 15 Hz: a jump through the filter has a width of half a guard; with the whole of it longer 3 of 40 clean"
    " logs of MuJoCo have backlash (python -m benchmarks.robot_logs --only mujoco --seed 3 --draws 40)",
)
HELD_LEAST = Rule(
    "held-least",
    0.3,
    "share",
    "presliding holds at least so much of Coulomb friction, backlash of the load",
    "by their laws all of it; the rest is for what else acts",
)
HELD_MOST = Rule("held-most", 1.7, "share", HELD_LEAST.moves.replace("least", "most"), HELD_LEAST.origin)
FOOT = Rule(
    "foot",
    0.01,
    "share of samples",
    "a Stribeck speed that fewer guarded samples are below gives way to static friction where the reversals tell that",
    "of 32 falls that the reversals tell as well, it lies above all but two Stribeck speeds and below all but two of"
    " static friction (python -m benchmarks.robot_calibrate --draws 330 --only effect, --seed 61, 62 and 63)",
)
MASS_SPREAD = Rule("mass-spread", 0.1, "1", "masses of the model are expected to be right to this share",
                   "masses of published models differ from weighed ones by so much")  # fmt: skip
IDENTIFIABLE = Rule(
    "identifiable",
    0.02,
    "share of the torque",
    "a number of a joint's friction is identifiable where its error, beside what may be wrong with the model, is less",
    "a judgement: friction is a fifth to a half of the torque of most joints, and is then known to a tenth",
)
WEAK = Rule(
    "weakly-identifiable",
    0.1,
    "share of the torque",
    "it is weak where the error is less, and else not identifiable from the log",
    "five times identifiable: as large as the friction of a good joint",
)
BODY_SPREAD = Rule(
    "body-spread",
    0.3,
    "share",
    "a body's mass, first moments and inertia are expected so near to the model's where all go along with a curve; they"
    " do where torque that was not fitted is then predicted better",
    "three times mass-spread: published models have centres of mass that are off by as much of a link's own size",
)
MOMENT_SPREAD = Rule("moment-spread", 0.3, "kg m", "a load is expected so near to the last body's centre of mass",
                     "load-spread (3 kg) at the ten centimetres of a gripper or tool")  # fmt: skip
LOADED = Rule("loaded-bodies", 3.0, "bodies", "a load is looked for on so many bodies, from the last on inwards",
              "a judgement: tools, cameras and valves sit at the wrist, which is turned by three joints")  # fmt: skip
HELD_WITHIN = Rule(
    "held-within",
    1.0,
    "m",
    "a load is named no farther from the centre of mass of what holds it",
    "a judgement: tools are shorter; a moment without a mass is no load, but a centre of mass or a zero",
)
LOAD_SPREAD = Rule("load-spread", 3.0, "kg", "loads of this size are expected", "what arms of 20 kg carry")
GAIN_SPREAD = Rule("gain-spread", 0.2, "1", "scales of torque are expected to be right to this share",
                   "motor constants fall by so much when hot")  # fmt: skip
TILT_SPREAD = Rule("tilt-spread", 0.1, "rad", "tilts of this size are expected", "six degrees: more is seen by eye")
ZERO_SPREAD = Rule("zero-spread", 0.02, "rad or m", "zeros of positions are expected so near to the model's",
                   "one degree: what arms are set to by marks on their joints")  # fmt: skip
DELAY_SPREAD = Rule("delay-spread", 0.02, "s", "delays of this size are expected", "two samples of a slow bus, 100 Hz")


RULES = tuple(value for value in list(vars().values()) if isinstance(value, Rule))

"""Every number that decides whether a log and a model go together."""

from harness.diagnosis.rules import Rule

_ORIGIN = "python -m benchmarks.robot_calibrate --only match"
CORRELATED = Rule(
    "correlated",
    0.5,
    "correlation",
    "a joint's torque follows its model's; of one that does not, where that would show, nothing is named",
    "half of it: at .5 the model explains a quarter of what friction leaves",
)
BY_FRICTION = Rule(
    "by-friction",
    0.95,
    "share",
    "friction explains a joint's torque, so that it need not follow the model's",
    "a judgement: the rest is what a motor's ripple and the noise of a current are",
)
LARGEST_SCALE = Rule(
    "largest-scale",
    2.0,
    "1",
    "most joints' torques are so many times the model's, or that part of it: another unit",
    "ten of gain-spread (0.2) off: motor constants are right to a fifth",
)
UNIT_NEAR = Rule(
    "unit-near",
    0.04,
    "share",
    "torques are as near to a unit's factor, and to each other's",
    "a judgement: a motor's constant is known to a few per cent",
)

RULES = tuple(value for value in list(vars().values()) if isinstance(value, Rule))

"""A robot's joint with the others still: which one is meant, and its equation in the form of the results."""

from harness.core.errors import InputError
from harness.results.robot import ReductionResult
from harness.robot.arm import Arm
from harness.robot.reduction import Reduced


def only_joint(arm: Arm) -> str:
    """The one joint of an arm, where none is named; raises InputError where there are several."""
    if len(arm.joints) != 1:
        found = f"not given, and {arm.file} has {', '.join(arm.joints)}"
        raise InputError("--joint", found, f"try: --joint {arm.joints[0]}")
    return arm.joints[0]


def reduction_of(arm: Arm, own: Reduced) -> ReductionResult:
    """A joint's equation, with the friction that the model has."""
    i = arm.index(own.joint)
    return ReductionResult.taken_from(
        own,
        rest_angle=None if own.slides or own.upright else own.q_eq,
        spring_rest=own.q_ref,
        frictionloss=float(arm.frictionloss[i]),
        damping=float(arm.damping[i]),
        said=own.sentence,
    )

"""Places of a mismatch, and a robot's joint with the others still, in the form of the results."""

from harness.diagnosis.explain.locate import Place
from harness.results.common import Where
from harness.results.robot import ReductionResult
from harness.robot.arm import Arm
from harness.robot.reduction import Reduced


def reduction_of(arm: Arm, own: Reduced) -> ReductionResult:
    """A joint's equation in the form of the results."""
    i = arm.index(own.joint)
    return ReductionResult(
        inertia=own.inertia,
        armature=own.armature,
        gravity=own.gravity,
        rest_angle=None if own.slides or own.upright else own.q_eq,
        spring=own.spring,
        spring_rest=own.q_ref,
        frictionloss=float(arm.frictionloss[i]),
        damping=float(arm.damping[i]),
        held=dict(own.held),
        said=own.sentence,
    )


def where_of_place(place: Place) -> Where:
    """Spans, regime, condition and share."""
    return Where.model_validate(
        {
            "time_s": [list(span) for span in place.spans],
            "regime": place.regime,
            "condition": place.condition,
            "share": place.share,
        }
    )

"""A joint in the engines, in sentences and as a table."""

import math

from harness.results.joint import JointRunResult, JointScore


def creep_said(result: JointRunResult, score: JointScore) -> str:
    """Creep in degrees or millimetres a second."""
    if score.creep is None:
        return "-"
    return f"{score.creep * 1e3:.3g} mm/s" if result.slides else f"{math.degrees(score.creep):.3g} deg/s"


def conclusions(result: JointRunResult) -> list[str]:
    """What the engines make of the joint, a sentence each."""
    own, torque = result.reduction, "N" if result.slides else "N m"
    said = [f"{own.said[0].upper()}{own.said[1:]}"]
    if result.load is None:
        said.append(
            f"The model gives {result.joint} no dry friction: there is nothing to hold it, and nothing to score."
        )
    elif own.gravity >= own.frictionloss:
        said.append(
            f"Dry friction of {own.frictionloss:.4g} {torque} does not hold gravity's {own.gravity:.4g} {torque};"
            f" creep is that under {result.load:.4g} {torque}, nearly all that friction bears."
        )
    else:
        said.append(f"Creep is that under {result.load:.4g} {torque}; a real joint does not move.")
    for score in result.scores:
        if score.error is not None:
            said.append(f"{score.engine} {score.preset} could not be run: {score.error}.")
            continue
        lead = "-" if score.reversal_lead_s is None else f"{score.reversal_lead_s * 1e3:.3g} ms"
        said.append(
            f"{score.engine} {score.preset}, step {1e3 * (score.dt_s or 0.0):.3g} ms: {result.joint} creeps at"
            f" {creep_said(result, score)}, and friction turns round {lead} before the speed."
        )
    if result.servo is not None:
        servo = result.servo
        said.append(
            f"Its servo of {servo.stiffness:.4g} {torque}/{'m' if result.slides else 'rad'} has zeta {servo.zeta:.3g};"
            f" at a step of {1e3 * servo.step_s:.3g} ms it acts as:"
        )
        for one in servo.scores:
            acts = (
                "it diverges" if one.zeta is None else f"zeta {one.zeta:.3g} ({one.false_damping:+.3g} false damping)"
            )
            said.append(f"{one.who}: {acts}.")
    return said

"""A joint in the engines, in sentences and as a table."""

import math

from harness.results.run import AsItIsResult, JointRunResult, ServoCure

_COMPENSATED = 0.99
"""Of gravity's torque, below which what is left is told."""
_NOTHING = 1e-12
"""m/s or rad/s, below which a solver's rounding is no creep."""
_SOFT_S = 0.2
"""s, ten of MuJoCo's time constants as shipped: what softness may cost until a joint has stopped."""


def conclusions(result: JointRunResult) -> list[str]:
    """What the engines make of the joint, a sentence each."""
    own, torque = result.reduction, "N" if result.slides else "N m"
    said = [f"{own.said[0].upper()}{own.said[1:]}"]
    itself = result.as_it_is[0] if result.as_it_is else None
    gravity = own.gravity if itself is None else itself.gravity
    friction = own.frictionloss if itself is None else max(itself.friction, itself.switched_off)
    bears = max(friction, 0.0 if itself is None else itself.break_away)
    if result.load is None:
        said.append(
            f"The model gives {result.joint} no dry friction: there is nothing to hold it, and nothing to score."
        )
    elif bears <= gravity:
        said.append(
            f"Dry friction ({friction:.4g} {torque}) is below gravity's {gravity:.4g} {torque}; creep is measured under"
            f" {result.load:.4g} {torque}, nearly all that friction bears."
        )
    else:
        said.append(f"Creep is measured under {result.load:.4g} {torque}; a real joint does not move.")
    if gravity < _COMPENSATED * own.gravity:
        said.append(f"Your file compensates gravity's {own.gravity:.4g} {torque} but for {gravity:.4g} {torque}.")
    said += [sentence for one in result.as_it_is for sentence in _itself(result, one)]
    for score in result.scores:
        if score.error is not None:
            said.append(f"{score.engine} {score.preset} could not be run: {score.error}.")
            continue
        creep = "-" if score.creep is None else _speed(result, score.creep)
        lead = "-" if score.reversal_lead_s is None else f"{score.reversal_lead_s * 1e3:.3g} ms"
        said.append(
            f"{score.engine} {score.preset}, step {1e3 * (score.dt_s or 0.0):.3g} ms: {result.joint} creeps at"
            f" {creep}, and friction reverses {lead} before the velocity."
        )
    return said + _servo(result)


def _itself(result: JointRunResult, one: AsItIsResult) -> list[str]:
    """What the user's file does when an engine steps it."""
    torque, speed = ("N", "m/s") if result.slides else ("N m", "rad/s")
    who = f"Your file itself in {one.engine}" + (f" {one.preset}" if one.engine != "mujoco" else "")
    said = []
    if one.switched_off > 0.0:
        said.append(
            f"Your file has dry friction of {one.switched_off:.4g} {torque} and switches it off"
            ' (<flag frictionloss="disable"/>): nothing holds the joint.'
        )
    said += [f"In your file {note}." for note in one.notes]
    if one.diverges_after is not None:
        ratio = one.dt_s * one.damping / (result.reduction.inertia + result.reduction.armature)
        limit = "" if ratio == 0.0 else f" (h c/m = {ratio:.3g}; a damping that is explicit bears less than 2)"
        said.append(f"{who}, step {1e3 * one.dt_s:.3g} ms: its own damping diverges{limit}.")
    elif one.creep is not None:
        falls = " it falls, at" if one.friction == 0.0 else f" {result.joint} creeps at"
        said.append(f"{who}, step {1e3 * one.dt_s:.3g} ms, the other joints held:{falls} {_speed(result, one.creep)}.")
    if one.differs is not None:
        said.append(one.differs)
    stop = one.stop
    if stop is not None and (stop.time_s is None or stop.time_s > stop.exact_time_s + _SOFT_S):
        took = "more than 4 s" if stop.time_s is None or stop.travel is None else (
            f"{stop.time_s:.3g} s and {_place(result, stop.travel)}"
        )  # fmt: skip
        exact = f"{stop.exact_time_s:.2g} s and {_place(result, stop.exact_travel)}"
        said.append(
            f"Let go at {stop.speed:.3g} {speed} without a load it takes {took} to stop, where Coulomb's law takes"
            f' {exact}: noslip makes friction push on beside joint damping; noslip_iterations="0" mends it.'
        )
    return said


def _servo(result: JointRunResult) -> list[str]:
    servo = result.servo
    if servo is None:
        return []
    torque, angle = ("N", "m") if result.slides else ("N m", "rad")
    said = []
    if servo.zeta is None:
        begins = f"Its actuator and the joint's damping brake with {servo.damping:.4g} {torque} s/{angle}"
    else:
        begins = f"Its servo of {servo.stiffness:.4g} {torque}/{angle} has zeta {servo.zeta:.3g}"
    said.append(f"{begins}; at a step of {1e3 * servo.step_s:.3g} ms it acts as:")
    for one in servo.scores:
        if not one.stable:
            acts = "it diverges"
        elif one.false_damping is None:
            acts = "it is stable, and reverses at every step"
        elif one.zeta is None:
            acts = f"{one.false_damping:+.3g} false damping"
        else:
            acts = f"zeta {one.zeta:.3g} ({one.false_damping:+.3g} false damping)"
        said.append(f"{one.who}: {acts}.")
    if servo.cure is not None:
        after = "" if servo.diverges_after is None else f" (your file itself: after {servo.diverges_after} steps)"
        said.append(f"The servo diverges in your file{after}. One of these mends it: {_cures(servo.cure, result)}.")
    return said


def _cures(cure: ServoCure, result: JointRunResult) -> str:
    torque, angle, mass = ("N", "m", "kg") if result.slides else ("N m", "rad", "kg m^2")
    found = []
    if cure.kp is not None:
        found.append(f"kp at most {cure.kp:.4g} at this damping")
    elif cure.stiffness is not None:
        found.append(f"a stiffness of at most {cure.stiffness:.4g} {torque}/{angle} at this damping")
    if cure.damping is not None:
        found.append(f"a damping of the servo of at most {cure.damping:.4g} {torque} s/{angle}")
    if cure.step_s is not None:
        found.append(f"a step of at most {1e3 * cure.step_s:.3g} ms")
    if cure.armature is not None:
        found.append(f"an armature that is larger by {cure.armature:.3g} {mass}")
    if cure.integrators:
        found.append(f"the integrator {' or '.join(cure.integrators)}")
    return "; ".join(found)


def _speed(result: JointRunResult, v: float) -> str:
    v = v if abs(v) > _NOTHING else 0.0
    return f"{v * 1e3:.3g} mm/s" if result.slides else f"{math.degrees(v):.3g} deg/s"


def _place(result: JointRunResult, x: float) -> str:
    return f"{x * 1e3:.3g} mm" if result.slides else f"{math.degrees(x):.3g} deg"

"""Plain sentences for what a whole arm's log says."""

from collections.abc import Sequence

from harness.core.quantity import Quantity
from harness.robot.whole_arm.friction_columns import ASYMMETRIC, DRIFT, LOAD, POSITION, QUADRATIC, RIPPLE, STRIBECK
from harness.robot.whole_arm.model_columns import ARMATURE, DELAY, INERTIA, MOTOR, PAYLOAD, SENSOR, TILT
from harness.robot.whole_arm.rules import SAID_BETTER
from harness.robot.whole_arm.turning import BACKLASH, PRESLIDING, STATIC

_EFFECTS = {
    STRIBECK: "Friction falls with speed: by {0} more at rest than when it slides, over {1}.",
    LOAD: "Friction grows with the joint's load: {0} of the torque of gravity.",
    ASYMMETRIC: "Viscous friction differs between the directions: by {0} on either side.",
    QUADRATIC: "Drag grows with the square of the speed: {0}.",
    DRIFT: "Friction changes during the log: Coulomb by {0}, viscous by {1}.",
    RIPPLE: "The torque ripples with the position: {0} and {1} (sine and cosine), {2}.",
    POSITION: "Coulomb friction depends on the position: {0} and {1} (sine and cosine), {2}.",
    PRESLIDING: "After a reversal friction builds up over a distance: {0} over {1}.",
    STATIC: "Friction is higher at the moment of reversal: by {0}, below {1}.",
    BACKLASH: "After a reversal the load is missing: {0} of it.",
}
_ERRORS = {
    INERTIA: "Masses of the model are off, by shares of {all}",
    PAYLOAD: "There is {0} more at the end of the arm than the model has",
    MOTOR: "The torque is scaled: by {0} more than it says",
    DELAY: "The torque is late by {0}",
    SENSOR: "The sensor does not see the rotors: {0} of their inertia is missing in the torque",
    TILT: "The base is tilted: by {0} about x and {1} about y",
    ARMATURE: "The inertia about the joint's axis is off by {0}",
}


def of_effect(name: str, parameters: Sequence[tuple[str, Quantity]], rivals: Sequence[str], pair: str = "") -> str:
    """One sentence about an effect, a second one where others do nearly as well, or can never be told from it."""
    said = _with_rivals(_filled(_EFFECTS.get(name, "{all}"), parameters), rivals)
    return f"{said} It stands for the pair: {pair}; this log cannot tell which." if pair else said


def of_error(
    name: str, joint: str | None, parameters: Sequence[tuple[str, Quantity]], partner: str, rivals: Sequence[str]
) -> str:
    """One sentence about an error of the model, with what it cannot be told from."""
    said = _filled(_ERRORS[name], parameters)
    where = f" ({joint})" if joint else ""
    beside = f", or it is the {partner}: no log of this kind can tell." if partner else "."
    return _with_rivals(f"{said}{where}{beside}", rivals)


def of_base(joint: str, coulomb: Quantity, viscous: Quantity, held_out: tuple[float, float], unit: str) -> str:
    """What a joint's friction is, and how well it predicts."""
    before, after = held_out
    better = f", {after:.3g} {unit} with what is named" if after < SAID_BETTER.value * before else ""
    return (
        f"{joint}: Coulomb friction {coulomb}, viscous friction {viscous}; it leaves {before:.3g} {unit} of torque that"
        f" was not fitted{better}."
    )


def _filled(said: str, parameters: Sequence[tuple[str, Quantity]]) -> str:
    everything = ", ".join(f"{name} {value}" for name, value in parameters)
    return said.format(*(str(value) for _, value in parameters), *["an unknown amount"] * 3, all=everything)


def _with_rivals(said: str, rivals: Sequence[str]) -> str:
    if not rivals:
        return said
    return f"{said} {' or '.join(rivals)} would explain it nearly as well."

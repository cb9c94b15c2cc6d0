"""What somebody needs of a log that does not have it, in one helpful line."""

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.core.robot.joint_log import JointLog


def effort_of(log: JointLog, joint: str) -> FloatArray:
    """The effort of a joint, (n,), N m or N. Raises InputError that says why there is none, and what would give one."""
    if joint not in log.position:
        known = ", ".join(log.joints)
        raise InputError(log.file, f"no joint '{joint}'", f"{known} is accepted{did_you_mean(joint, log.joints)}")
    if joint in log.effort:
        return log.effort[joint]
    why = next((note for note in log.notes if "effort" in note.lower() and not note.startswith("Read ")), "")
    accepted = why.rstrip(".") or f"a column {joint}.effort, or {joint}.current with --gain, is accepted"
    raise InputError(log.file, f"no effort of {joint}", accepted)

"""What a motion can tell of a joint's friction, from its columns alone, and the motion that would mend it."""

from dataclasses import replace

import numpy as np
from whole_arm_logs import LOWPASS, arm, log_of, machine

from harness.robot.whole_arm.whole import whole_arm


def test_a_motion_that_excites_everything_tells_everything() -> None:
    plant, motion = machine(quiet=False)
    found = whole_arm(log_of(plant, motion), arm(), lowpass=LOWPASS).identifiable
    assert {(one.joint, one.parameter) for one in found} == {
        (f"joint{i}", name) for i in range(1, 8) for name in ("Coulomb friction", "viscous friction", "offset")
    }
    assert all(one.verdict == "identifiable" and not one.why for one in found)


def test_a_short_way_cannot_part_an_offset_from_what_gravity_may_be_and_a_still_joint_nothing() -> None:
    plant, motion = machine(quiet=False)
    small = motion.amplitude.copy()
    small[3] *= 0.02
    small[[0, 1, 2, 4, 5, 6]] = 0.0
    found = whole_arm(log_of(plant, replace(motion, amplitude=small)), arm(), lowpass=LOWPASS).identifiable
    told = {(one.joint, one.parameter): one for one in found}
    offset = told["joint4", "offset"]
    assert offset.verdict in ("weak", "not")
    assert offset.why
    assert "larger angle" in offset.mend
    still = [one for one in found if one.joint == "joint2"]
    assert {one.verdict for one in still} == {"not"}
    errors = [one.error for one in found if one.joint == "joint4" and one.error is not None]
    assert len(errors) == 3
    assert np.all(np.isfinite(errors))

"""Lengths are not held against angles; what names no unit is what it is held against."""

import re

import numpy as np
import pytest

from harness.api import compare
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.alignment.match import as_kind_of, of_one_kind

T = np.linspace(0.0, 4.0, 800)
X = 0.1 * np.exp(-0.2 * T) * np.cos(9.0 * T)


def recorded(name: str, angular: bool, *units: str) -> Recording:
    return Recording(
        T, {"x": X, "v": np.gradient(X, T)}, name, units=dict(zip("xv", units, strict=False)), angular=angular
    )


LENGTH, ANGLE = recorded("stage.csv", False, "mm"), recorded("joint.csv", True, "deg", "rpm")
BARE, TURNED = recorded("bare.csv", False), recorded("turned.csv", True)


@pytest.mark.parametrize(("one", "other"), [(LENGTH, ANGLE), (ANGLE, LENGTH), (LENGTH, TURNED)])
def test_a_length_against_an_angle_is_refused_by_name(one: Recording, other: Recording) -> None:
    with pytest.raises(InputError, match="a length") as refused:
        as_kind_of(one, other, "--sim")
    assert str(refused.value).startswith(f"--sim {one.file}: ")
    assert other.file in str(refused.value)
    assert "one kind" in str(refused.value)


def test_what_names_no_unit_is_of_the_others_kind_and_says_so() -> None:
    for one, other, units in ((BARE, ANGLE, "rad and rad/s"), (TURNED, LENGTH, "m and m/s")):
        found = as_kind_of(one, other)
        assert found.angular == other.angular
        assert np.array_equal(found["x"], X)
        assert found.notes == (f"Its columns name no unit: read in {units}, as {other.file}.",)
        for pair in (of_one_kind(one, other), of_one_kind(other, one)):
            assert {trace.angular for trace in pair} == {other.angular}
    assert as_kind_of(BARE, LENGTH) is BARE
    assert of_one_kind(BARE, TURNED)[0].angular
    with pytest.raises(InputError):
        of_one_kind(ANGLE, LENGTH)


def test_compare_refuses_them_too() -> None:
    with pytest.raises(InputError, match=re.escape("stage.csv: a length (x in mm), where joint.csv is an angle")):
        compare(LENGTH, ANGLE)
    assert compare(BARE, ANGLE).largest.unit == "rad"

"""--columns: products of names and numbers, and nothing else; and units of columns."""

from pathlib import Path

import numpy as np
import pytest

from harness.core.errors import InputError
from harness.io.columns import Mapping, parse_columns
from harness.io.options import ReadOptions
from harness.io.recording import read_recording
from harness.io.units import is_unit_of, parse_unit, split_header

GOOD: list[tuple[str, list[Mapping]]] = [
    ("x=#1[deg]", [Mapping("x", ("#1",), 1.0, "deg")]),
    (
        "t=t,x=qm[m],u=vir*gtau[N]",
        [Mapping("t", ("t",)), Mapping("x", ("qm",), 1.0, "m"), Mapping("u", ("vir", "gtau"), 1.0, "N")],
    ),
    (
        "u = 35.15 * vir [N] , x = -1e-3 * run.q 1",
        [Mapping("u", ("vir",), 35.15, "N"), Mapping("x", ("run.q 1",), -1e-3)],
    ),
    ("a=2*a*3[m/s^2]", [Mapping("a", ("a",), 6.0, "m/s^2")]),
]


@pytest.mark.parametrize(("text", "wanted"), GOOD)
def test_products_are_understood(text: str, wanted: list[Mapping]) -> None:
    assert list(parse_columns(text).values()) == wanted


BAD: list[tuple[str, str]] = [
    ("x=__import__('os').system('touch /tmp/x')", "is no name, #N or number"),
    ("x=open('f')", "is no name"),
    ("x=a+b", "is no name"),
    ("x=a**b", "is no name"),
    ("x=a/2", "is no name"),
    ("x=(a)", "is no name"),
    ("x=[a for a in b]", "is no name"),
    ("x=lambda: 1", "is no name"),
    ("x=#", "is no name"),
    ("x=", "is no name"),
    ("x=2", "names no column"),
    ("x=0*a", "multiplies by 0"),
    ("x=1e999*a", "multiplies by inf"),
    ("x", "--columns: 'x'; expected CHANNEL=PRODUCT[UNIT]"),
    ("", "--columns: ''"),
    ("x=a,", "--columns: ''"),
    ("y=a", "unknown channel 'y'"),
    ("x=a,x=b", "channel x given twice"),
    ("x=a=b", "is no name"),
    ("x=a[m", "--columns: 'x=a[m'"),
]


@pytest.mark.parametrize(("text", "message"), BAD)
def test_anything_else_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_columns(text)
    assert message in str(caught.value)


UNITS: list[tuple[str, str, float, bool]] = [
    ("t", "ms", 1e-3, False),
    ("t", "min", 60.0, False),
    ("x", "µm", 1e-6, False),
    ("x", "in", 0.0254, False),
    ("x", "°", 0.017453292519943295, True),
    ("x", "rad", 1.0, True),
    ("v", "rpm", 0.10471975511965977, True),
    ("v", "rev/s", 6.283185307179586, True),
    ("x", "thou", 2.54e-5, False),
    ("v", "km/h", 1.0 / 3.6, False),
    ("a", "g", 9.80665, False),
    ("a", "mg", 9.80665e-3, False),
    ("a", "m/s²", 1.0, False),
    ("a", "deg/s^2", 0.017453292519943295, True),
    ("u", "lbf", 4.4482216152605, False),
    ("u", "N*m", 1.0, False),
    ("u", "mN", 1e-3, False),
    ("u", "Nm", 1.0, False),
    ("u", "mNm", 1e-3, False),
    ("u", "Ncm", 1e-2, False),
    ("u", "N-m", 1.0, False),
    ("u", "Newton-meter", 1.0, False),
    ("u", "oz-in", 0.028349523125 * 9.80665 * 0.0254, False),
    ("u", "ft-lb", 0.45359237 * 9.80665 * 0.3048, False),
    ("u", "kg-cm", 0.0980665, False),
]


@pytest.mark.parametrize(("channel", "text", "factor", "angular"), UNITS)
def test_units_as_factors_to_si(channel: str, text: str, factor: float, angular: bool) -> None:
    unit = parse_unit("test", channel, text)
    assert unit.factor == pytest.approx(factor, rel=1e-14)
    assert unit.angular == angular


@pytest.mark.parametrize("text", ["N-s", "Nms", "kg", "lb", "m-m", "g"])
def test_what_is_no_force_and_no_torque_is_none(text: str) -> None:
    with pytest.raises(InputError, match="a unit of force, torque or force per mass such as N, lbf, Nm or m/s"):
        parse_unit("test", "u", text)


@pytest.mark.parametrize(
    "text", ["__import__('os')", "m**9**9**9", "m**(99999)", "m+1", "2*m", "m; print(1)", "m" * 200, "m^a", "\n"]
)
def test_units_are_not_evaluated(text: str) -> None:
    with pytest.raises(InputError, match="is not a unit"):
        parse_unit("test", "x", text)


def test_headers_are_split() -> None:
    assert split_header(" x [mm] ") == ("x", "mm")
    assert split_header("x") == ("x", None)
    assert split_header("Position 1[ deg ]") == ("Position 1", "deg")


@pytest.mark.parametrize(("with_force", "told"), [(False, True), (True, False)])
def test_a_goal_is_told_where_no_force_says_how_it_was_obeyed(tmp_path: Path, with_force: bool, told: bool) -> None:
    t = np.arange(200) / 50.0
    table = [t, np.exp(-0.3 * t) * np.cos(6.0 * t), 0.5 * np.sign(np.sin(t)), *([np.cos(t)] if with_force else [])]
    path = tmp_path / "servo.csv"
    header = "t,position,goal_position" + (",u" if with_force else "")
    np.savetxt(path, np.column_stack(table), delimiter=",", header=header, comments="")
    notes = read_recording(path, ReadOptions()).notes
    assert any("goal_position" in note for note in notes) is told


USUAL = "s ms us m mm cm um rad mrad deg ° m/s mm/s rad/s deg/s m/s^2 mm/s² rad/s^2 deg/s² N mN kN"


@pytest.mark.parametrize("channel", ["t", "x", "v", "a", "u"])
def test_units_that_need_no_library_are_what_the_library_says(channel: str) -> None:
    for text in USUAL.split(" "):
        asked = f"{text} "  # which is none of the usual ones
        assert is_unit_of(channel, text) == is_unit_of(channel, asked)
        if is_unit_of(channel, text):
            plain, known = parse_unit("", channel, text), parse_unit("", channel, asked)
            assert (plain.factor, plain.angular) == (known.factor, known.angular)

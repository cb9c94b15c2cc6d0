"""Reading is forgiving where it is safe, says what it guessed, and ends in a line to paste where it cannot guess."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.io.columns import Meaning, meaning
from harness.io.options import ReadOptions
from harness.io.recording import read_recording

T = np.arange(400) / 200.0
X = np.exp(-0.5 * T) * np.cos(10.0 * T)


def written(path: Path, header: str, *columns: np.ndarray, comments: bool = False) -> Path:
    lines = [",".join(f"{v:.17g}" for v in row) for row in zip(*columns, strict=True)]
    if comments:
        lines[7:7] = ["# the belt slipped here", "# or so"]
    path.write_text("\n".join([*(["# made by hand"] if comments else []), header, *lines]) + "\n")
    return path


MEANINGS: list[tuple[str, Meaning | None]] = [
    ("time", Meaning("t")),
    ("Time", Meaning("t")),
    ("stamp", Meaning("t")),
    ("header.stamp", Meaning("t")),
    ("pos", Meaning("x")),
    ("Position 1", Meaning("x")),
    ("angle", Meaning("x", None, True)),
    ("theta", Meaning("x", None, True)),
    ("q", Meaning("x")),
    ("dq", Meaning("v")),
    ("tau", Meaning("u")),
    ("effort", Meaning("u")),
    ("/joint_states/position[0]", Meaning("x")),
    ("/joint_states/effort[12]", Meaning("u")),
    ("t_s", Meaning("t", "s")),
    ("t_ms", Meaning("t", "ms")),
    ("time_us", Meaning("t", "us")),
    ("millis", Meaning("t", "ms")),
    ("x_rad", Meaning("x", "rad")),
    ("v_rad_s", Meaning("v", "rad/s")),
    ("F_N", Meaning("u", "N")),
    ("theta_deg", Meaning("x", "deg", True)),
    ("acc_m_s2", Meaning("a", "m/s^2")),
    ("temperature", None),
    ("y", None),
    ("current", None),
    ("x_target", None),
    ("", None),
]


@pytest.mark.parametrize(("name", "wanted"), MEANINGS)
def test_what_a_name_means(name: str, wanted: Meaning | None) -> None:
    assert meaning(name) == wanted


HEADERS: list[tuple[str, float, float, bool]] = [
    ("Time (s),Position (mm)", 1.0, 1e3, False),
    ("t_ms,x_rad", 1e3, 1.0, True),
    ("stamp,/joint_states/position[0]", 1.0, 1.0, False),
    ("time [us],angle [deg]", 1e6, 180.0 / np.pi, True),
    ("secs,theta", 1.0, 1.0, True),
]


@pytest.mark.parametrize(("header", "per_s", "per_unit", "angular"), HEADERS)
@pytest.mark.parametrize("comments", [False, True])
def test_names_as_people_write_them(
    tmp_path: Path, header: str, per_s: float, per_unit: float, angular: bool, comments: bool
) -> None:
    found = read_recording(written(tmp_path / "a.csv", header, T * per_s, X * per_unit, comments=comments))
    np.testing.assert_allclose(found.t, T, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(found["x"], X, rtol=1e-12, atol=1e-15)
    assert found.angular == angular
    assert found.notes[0].startswith("Read t from ")


@pytest.mark.parametrize(("header", "per_s", "per_unit", "angular"), HEADERS)
def test_the_columns_that_a_guess_prints_give_the_same_recording(
    tmp_path: Path, header: str, per_s: float, per_unit: float, angular: bool
) -> None:
    path = written(tmp_path / "a.csv", header, T * per_s, X * per_unit)
    guessed = read_recording(path)
    again = read_recording(path, pasted(guessed.notes[0]))
    np.testing.assert_array_equal(guessed.t, again.t)
    np.testing.assert_array_equal(guessed["x"], again["x"])
    assert guessed.angular == again.angular == angular
    assert not any(note.startswith("Read") for note in again.notes)


def pasted(text: str) -> ReadOptions:
    """The options in a message, as a shell hands them on."""
    given = re.search(r'--columns "[^"]*"(?: --rate [^\s,]+)?', text)
    assert given is not None, text
    words = shlex.split(given[0].replace("HZ", "200"))
    return ReadOptions(columns=words[1], rate=float(words[3]) if len(words) > 2 else None)


CANNOT: list[tuple[str, int]] = [
    ("k1,k2,k3", 3), ("time,left,right", 3), ("t,pos,angle", 3), ("in s,C1 in V", 2), ("LECROYWS4054\nTime,Ampl", 2),
]  # fmt: skip


@pytest.mark.parametrize(("header", "width"), CANNOT)
def test_what_cannot_be_guessed_ends_in_columns_to_paste(tmp_path: Path, header: str, width: int) -> None:
    path = written(tmp_path / "a.csv", header, *(T, X, 2.0 * X)[:width])
    with pytest.raises(InputError) as caught:
        read_recording(path)
    assert "\n" not in str(caught.value)
    np.testing.assert_array_equal(read_recording(path, pasted(str(caught.value)))["x"], X)


@pytest.mark.parametrize("header", ["k,m", "row,x", "t,y", "t_s,x1_rad", "Zeit,Messung", ""])
def test_a_time_and_one_column_that_moves_are_the_recording(tmp_path: Path, header: str) -> None:
    found = read_recording(written(tmp_path / "a.csv", header, T, X) if header else plain(tmp_path / "a.txt"))
    np.testing.assert_array_equal(found.t, T)
    np.testing.assert_array_equal(found["x"], X)
    assert found.notes[0].startswith("Read t from ")


SPELLED = [
    ("time_s,speed_kmh", 1 / 3.6), ("Time (sec),Vehicle speed (km/h)", 1 / 3.6), ("t,GPS Speed kph", 1 / 3.6),
    ("t,speedMph", 0.44704), ("t,v_fps", 0.3048), ("t,motor_speed_rpm", np.pi / 30.0), ("t,speed (kmh)", 1 / 3.6),
    ("t,Drehzahl (1/min)", np.pi / 30.0), ("t,Drehzahl (U/min)", np.pi / 30.0), ("t,omega (rad s-1)", 1.0),
    ("t,speed (m s^-1)", 1.0), ("t,wheel_speed_rps", 2.0 * np.pi), ("t,gyro_dps", np.pi / 180.0),
    ("t,boat_speed_knots", 1852.0 / 3600.0), ("t,speed_mm_per_s", 1e-3),
]  # fmt: skip


@pytest.mark.parametrize(("header", "size"), SPELLED)
def test_a_speed_is_in_the_unit_that_its_name_says(tmp_path: Path, header: str, size: float) -> None:
    found = read_recording(written(tmp_path / "a.csv", header, np.arange(T.size), X))
    np.testing.assert_allclose(found["v"], X * size, rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(found.t, np.arange(T.size))


@pytest.mark.parametrize("header", ["turn,stamp_us", "micros"])
def test_times_alone_are_one_for_each_turn_when_somebody_says_so(tmp_path: Path, header: str) -> None:
    stamps = np.cumsum(np.round(2e4 * (1.0 + 0.01 * np.arange(200.0))))
    columns = (np.arange(1.0, 201.0), stamps) if "turn" in header else (stamps,)
    path = written(tmp_path / "wheel.csv", header, *columns)
    with pytest.raises(InputError) as refused:
        read_recording(path)
    found = read_recording(path, pasted(str(refused.value)))
    np.testing.assert_allclose(found.t, stamps * 1e-6, rtol=1e-12)
    np.testing.assert_allclose(np.diff(found["x"]), 2.0 * np.pi, rtol=1e-12)
    assert found.angular


@pytest.mark.parametrize(
    "above", ["# sample rate: 200 Hz", "Sampling frequency;0.2 kHz", "# Abtastrate = 200 Hz", "# fs = 200 Hz"]
)
def test_a_rate_above_the_numbers_is_the_one_to_paste(tmp_path: Path, above: str) -> None:
    rows = "\n".join(f"{1e3 * x:.9g}" for x in X)
    path = tmp_path / "laser.csv"
    path.write_text(f"{above}\nposition_mm\n{rows}\n", encoding="utf-8")
    with pytest.raises(InputError) as refused:
        read_recording(path)
    assert "--rate 200" in str(refused.value)
    found = read_recording(path, pasted(str(refused.value)))
    np.testing.assert_allclose(found.t, np.arange(T.size) / 200.0, rtol=1e-12)
    np.testing.assert_allclose(found["x"], X, rtol=1e-8)


def plain(path: Path) -> Path:
    """Numbers alone."""
    np.savetxt(path, np.stack([T, X], axis=1), fmt="%.17g")
    return path


@pytest.mark.parametrize(("name", "per_s"), [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
@pytest.mark.parametrize("told", [False, True])
def test_stamps_since_1970_count_from_the_first(tmp_path: Path, name: str, per_s: float, told: bool) -> None:
    header = f"stamp [{name}],x" if told else "t,x"
    found = read_recording(written(tmp_path / "a.csv", header, np.round((1.7e9 + T) * per_s, 3), X))
    np.testing.assert_allclose(found.t, T, atol=5e-4 if name == "s" else 3e-6)
    assert any("since 1970" in note and "2023-11-14 22:13:20 UTC" in note for note in found.notes)


def test_angles_that_wrap_are_put_together(tmp_path: Path) -> None:
    whole = 170.0 + 40.0 * X
    wrapped = (whole + 180.0) % 360.0 - 180.0
    found = read_recording(written(tmp_path / "a.csv", "t,angle [deg]", T, wrapped))
    np.testing.assert_allclose(found["x"], np.deg2rad(whole), atol=1e-12)
    assert any("wraps" in note for note in found.notes)


@pytest.mark.parametrize(
    ("unit", "half", "beside"),
    [("rad", 12.5, True), ("rad", 12.5, False), ("deg", 180.0, True), ("mm", 50.0, True), ("rad", 4 * np.pi, True)],
)
def test_a_range_that_wraps_is_found_beside_the_speed(tmp_path: Path, unit: str, half: float, beside: bool) -> None:
    whole = 3.0 * half * np.sin(2.0 * np.pi * T / T[-1])
    columns = [T, (whole + half) % (2.0 * half) - half, np.gradient(whole, T)][: 3 if beside else 2]
    header = f"t,x [{unit}],v [{unit}/s]" if beside else f"t,x [{unit}]"
    found = read_recording(written(tmp_path / "a.csv", header, *columns))
    factor = {"rad": 1.0, "deg": np.pi / 180.0, "mm": 1e-3}[unit]
    np.testing.assert_allclose(found["x"] - found["x"][0], factor * (whole - whole[0]), atol=1e-6 * factor * half)
    assert any(f"range of {2.0 * half:.6g}" in note for note in found.notes)


def test_lengths_do_not_wrap(tmp_path: Path) -> None:
    found = read_recording(written(tmp_path / "a.csv", "t,x", T, (10.0 * X) % 6.0))
    np.testing.assert_allclose(found["x"], (10.0 * X) % 6.0)


def test_rows_without_a_value(tmp_path: Path) -> None:
    x = X.copy()
    x[[3, 50, 51]] = np.nan
    path = written(tmp_path / "a.csv", "t,x", T, x)
    found = read_recording(path)
    np.testing.assert_array_equal(found["x"], X[~np.isnan(x)])
    np.testing.assert_array_equal(found.t, T[~np.isnan(x)])
    assert any("3 rows without a value, the first of them row 4 (line 5)" in said for said in found.mended)
    path.write_text(path.read_text().replace("nan", "N/A"))
    assert len(read_recording(path)) == 397
    x[100:200] = np.nan
    path = written(tmp_path / "a.csv", "t,x", T, x)
    with pytest.raises(InputError, match=r"row 4 \(line 5\), column x: no value or nan\. Try: --drop-nan"):
        read_recording(path)
    assert len(read_recording(path, ReadOptions(drop_nan=True))) == 297


def test_dropped_rows_keep_their_place_under_a_rate(tmp_path: Path) -> None:
    x = X.copy()
    x[10] = np.nan
    found = read_recording(written(tmp_path / "a.csv", "x", x), ReadOptions(rate=200.0, drop_nan=True))
    np.testing.assert_allclose(found.t, np.delete(T, 10), atol=1e-15)


def test_a_clock_too_coarse_for_even_samples_is_an_even_one(tmp_path: Path) -> None:
    found: Recording = read_recording(written(tmp_path / "a.csv", "t,x", np.floor(T * 100.0) / 100.0, X))
    assert any("200 of 400 times repeat the one before" in said for said in found.mended)
    np.testing.assert_array_equal(found["x"], X)
    assert found.rate == pytest.approx(200.0, rel=5e-3)


def recorded(path: Path, t: np.ndarray, stamps: np.ndarray) -> Recording:
    """A decay at times t under these stamps."""
    lines = [f"{s:.3f},{x:.17g}" for s, x in zip(stamps, np.exp(-0.5 * t) * np.cos(10.0 * t), strict=True)]
    path.write_text("\n".join(["t [s],x [m]", *lines]) + "\n")
    return read_recording(path)


@pytest.mark.parametrize("times", [2, 3])
def test_rows_that_a_logger_wrote_again_count_once(tmp_path: Path, times: int) -> None:
    again = read_recording(written(tmp_path / "again.csv", "t,x", np.repeat(T, times), np.repeat(X, times)))
    np.testing.assert_array_equal(again.t, T)
    np.testing.assert_array_equal(again["x"], X)
    count = (times - 1) * T.size
    assert again.mended == (f"{count} rows repeat the one before, values and all (row 2 (line 3)): not used.",)


@pytest.mark.parametrize("rate", [60.0, 90.0, 120.0, 400.0])
def test_stamps_rounded_to_ms_are_those_of_an_even_clock(tmp_path: Path, rate: float) -> None:
    t = np.arange(400) / rate
    found = recorded(tmp_path / "a.csv", t, np.round(t, 3))
    assert np.abs(found.t - t).max() < 0.5e-3
    np.testing.assert_allclose(np.diff(found.t), 1.0 / rate, rtol=1e-4)
    assert found.mended[0].startswith("Stamps are rounded to 1 ms: the even clock of ")
    lacking = np.delete(t, [50, 51, 200])
    kept = recorded(tmp_path / "b.csv", lacking, np.round(lacking, 3))
    assert np.abs(kept.t - lacking).max() < 0.5e-3
    assert np.diff(kept.t)[49] == pytest.approx(3.0 / rate, rel=1e-4)


def test_an_even_clock_that_lacks_samples_is_not_rounded(tmp_path: Path) -> None:
    t = np.delete(0.004 * np.arange(400), [50, 51, 200])
    found = recorded(tmp_path / "a.csv", t, t)
    np.testing.assert_allclose(found.t, t, rtol=0.0, atol=1e-12)
    assert not found.mended


def test_whole_ms_at_which_a_scheduler_sampled_stay(tmp_path: Path) -> None:
    t = np.round(np.arange(400) / 60.0, 3)
    found = recorded(tmp_path / "a.csv", t, t)
    np.testing.assert_array_equal(found.t, t)
    assert not found.mended
    assert "Sampling is irregular: intervals of 16 to 17 ms, median 17 ms." in found.notes


def test_stamps_of_three_digits_grow_coarser(tmp_path: Path) -> None:
    t = 9.0 + T
    found = read_recording(written(tmp_path / "a.csv", "t,x", np.array([float(f"{one:.2E}") for one in t]), X))
    assert found.rate == pytest.approx(200.0, rel=5e-3)
    np.testing.assert_allclose(found.t, t, atol=0.02)


def test_a_guessed_column_that_says_nothing_is_left_out(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", "time,position,effort", T, X, 0.0 * X)
    found = read_recording(path)
    assert list(found.channels) == ["x"]


def test_names_with_signs_stand_in_quotes(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", "Time (s),pos [mm],a=b", T, X * 1e3, X)
    found = read_recording(path, ReadOptions(columns="t='Time (s)',x='pos [mm]'"))
    np.testing.assert_allclose(found["x"], X, rtol=1e-14)
    found = read_recording(path, ReadOptions(columns="t='Time (s)',x=2*'a=b'[mm]"))
    np.testing.assert_allclose(found["x"], 2e-3 * X, rtol=1e-14)


BEST: list[tuple[str, str, list[np.ndarray], dict[str, np.ndarray]]] = [
    ("a speed is no position", "Time (s),Gyroscope x (rad/s)", [T, X], {"v": X}),
    ("nor is an acceleration", "Time (s),Linear Acceleration x (m/s^2)", [T, X], {"a": X}),
    ("nor a voltage", "time,supply [V],adc", [T, 5.0 + 0.1 * X, X], {"x": X}),
    ("nor what was commanded", "time,goal_position,measured", [T, np.cos(T), X], {"x": X}),
    ("nor what stays, counts or is empty", "time,k,n,e,m", [T, 0 * T + 2, np.arange(400.0), np.nan * T, X], {"x": X}),
    ("the axis that moves", "t,m 0 Position,m 1 Position", [T, 1e-3 * X, X], {"x": X}),
    ("whole numbers of a clock", "k,m", [np.round(5e3 * T), X], {"x": X}),
    ("a derivative beside it", "t,m,d", [T, X, np.gradient(X, T)], {"x": X, "v": np.gradient(X, T)}),
    ("its unit where none is said", "clock,way [mm],d", [T, 1e3 * X, np.gradient(1e3 * X, T)], {"x": X}),
    ("what a counter's slope follows", "t,n,s", [T, np.arange(400.0) // 9, X], {"x": X}),
    ("of several runs the first", "Run 1: t,Run 1: y,Run 2: t,Run 2: y", [T, X, T, 3 * X], {"x": X}),
    ("runs by a number at the end", "t1;w1;t2;w2".replace(";", ","), [T, X, T, 3 * X], {"x": X}),
    ("degrees where it turns too far", "t,theta,n", [T, 40.0 * X, 0.0 * T], {"x": np.deg2rad(40.0 * X)}),
]


@pytest.mark.parametrize(("header", "columns", "wanted"), [h[1:] for h in BEST], ids=[h[0] for h in BEST])
def test_what_is_clearly_the_best_is_taken_and_said(
    tmp_path: Path, header: str, columns: list[np.ndarray], wanted: dict[str, np.ndarray]
) -> None:
    path = written(tmp_path / "a.csv", header, *columns)
    found = read_recording(path)
    for channel, values in wanted.items():
        np.testing.assert_allclose(found[channel], values, rtol=1e-12, atol=1e-15)
    assert found.t[-1] == pytest.approx(T[-1] * (5.0 if header == "k,m" else 1.0))
    again = read_recording(path, pasted(found.notes[0]))
    for channel in found.channels:
        np.testing.assert_array_equal(again[channel], found[channel])


def test_a_run_is_asked_for_by_its_number(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", "Run 1: t,Run 1: y,Run 2: t,Run 2: y", T, X, T, 3.0 * X)
    assert any("2 runs" in note for note in read_recording(path).notes)
    np.testing.assert_array_equal(read_recording(path, ReadOptions(run=2))["x"], 3.0 * X)
    with pytest.raises(InputError, match="--run: 3 of 2"):
        read_recording(path, ReadOptions(run=3))


def test_settings_above_a_lone_column_say_its_rate_and_its_unit(tmp_path: Path) -> None:
    path = tmp_path / "swing.txt"
    x = 45.2 * X / X[0]
    path.write_text("start_deg, sample_rate, seconds\n45, 200, 5\n" + "".join(f"{value:.4f}\n" for value in x))
    with pytest.raises(InputError, match=r"--rate 200, which reads .* rad$"):
        read_recording(path)
    found = read_recording(path, ReadOptions(columns="x=#1", rate=200.0))
    np.testing.assert_allclose(found["x"], np.radians(x), atol=1e-6)


def test_no_even_clock_over_a_gap(tmp_path: Path) -> None:
    coarse = np.floor(T * 50.0) / 50.0
    assert read_recording(written(tmp_path / "a.csv", "t,x", coarse, X)).rate == pytest.approx(200.0, rel=5e-3)
    gap = np.where(T < 1.0, coarse, coarse + 0.2)
    with pytest.raises(InputError) as caught:
        read_recording(written(tmp_path / "b.csv", "t,x", gap, X))
    assert "--rate" not in str(caught.value)


def test_what_a_logger_leaves_behind_is_left_out_and_said(tmp_path: Path) -> None:
    lines = ["t,x", *(f"{t:.4f},{x:.9f}" for t, x in zip(T, X, strict=True))]
    lines[50:50] = [lines[49], lines[49]]
    path = tmp_path / "a.csv"
    path.write_text("\n".join([*lines, "s,m", ",", ",", "2.0"]))
    found = read_recording(path)
    assert len(found) == T.size
    for word in ("cut short", "no number", "without a value", "does not come after"):
        assert any(word in said for said in found.mended), word
    path.write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\n")
    with pytest.raises(InputError, match="git lfs pull"):
        read_recording(path)

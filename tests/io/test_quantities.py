"""Which quantity a column holds: by its unit, its name and its numbers; what is none is never read as a motion."""

import shlex
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.moves.classify import classify
from harness.io.options import ReadOptions
from harness.io.recording import read_recording

T = 0.5 * np.arange(300.0)
NOISE = np.random.default_rng(4).standard_normal(300)
COAST = 27.0 * np.exp(-T / 75.0) - 3.5 + 0.1 * NOISE
"""A coast-down, 2 Hz: from sample to sample it rises as often as it falls."""
X = np.exp(-T / 50.0) * np.cos(T)


def written(path: Path, header: str, *columns: FloatArray | Sequence[str]) -> Path:
    rows = (",".join(v if isinstance(v, str) else f"{v:.9g}" for v in row) for row in zip(*columns, strict=True))
    path.write_text("\n".join([*([header] if header else []), *rows]) + "\n")
    return path


def asked(path: Path) -> Recording:
    """What the printed line reads. Raises AssertionError where a file is read without a question."""
    with pytest.raises(InputError) as caught:
        read_recording(path)
    words = shlex.split(str(caught.value).partition("Try: ")[2].partition(", which reads")[0])
    return read_recording(path, ReadOptions(columns=words[words.index("--columns") + 1]))


def test_a_noisy_coast_down_without_names_is_a_speed(tmp_path: Path) -> None:
    found = read_recording(written(tmp_path / "a.csv", "", T, COAST))
    assert set(found.channels) == {"v"}
    np.testing.assert_allclose(found["v"], COAST, rtol=1e-8)


@pytest.mark.parametrize("header", ["t,sensor", "", "t,c1,c2,c3,c4"])
def test_what_falls_under_a_name_that_says_nothing_and_one_of_several_is_asked(tmp_path: Path, header: str) -> None:
    others = {"t,sensor": (), "": (0.2 * COAST,), "t,c1,c2,c3,c4": (0.2 * COAST, NOISE, X)}[header]
    assert "v" in asked(written(tmp_path / "a.csv", header, T, COAST, *others)).channels


@pytest.mark.parametrize(
    "header",
    [
        "time,temperature",
        "time,T [°C]",
        "time,humidity,pressure",
        "time,current_motor",
        "time,heart_rate",
        "time,load,temp",
        "Zeit,Temperatur,Leistung",
        "temps,pression",
        "时间,温度",
        "time,active power",
        "t [s],U [V]",
        "n,Time [s],Fz [N]",
    ],
)
def test_what_is_no_motion_is_refused_without_a_line_that_reads_it_as_one(tmp_path: Path, header: str) -> None:
    beside = [COAST, 2.0 + COAST][: header.count(",")]
    time = {"n": (np.arange(300.0), T)}.get(header.partition(",")[0], (T,))
    with pytest.raises(InputError) as caught:
        read_recording(written(tmp_path / "a.csv", header, *time, *beside[: header.count(",") + 1 - len(time)]))
    assert "rev]" not in str(caught.value)
    assert "Try:" not in str(caught.value) or "[m]" in str(caught.value)  # a voltage, with its scale to be given


@pytest.mark.parametrize("header", ["t,supply voltage", "t,ecg", "t,gyroADC[0]", "t,speed percentage", "t,motor PWM"])
def test_what_needs_its_scale_is_asked(tmp_path: Path, header: str) -> None:
    asked(written(tmp_path / "a.csv", header, T, 5000.0 * X))


@pytest.mark.parametrize(
    ("header", "size"),
    [("secs,km,kph", 1 / 3.6), ("secs,hr,kmh", 1 / 3.6), ("t,temp,mph", 0.44704), ("t,n,rps", 2.0 * np.pi)],
)
def test_a_name_that_is_a_unit_of_speed_says_it(tmp_path: Path, header: str, size: float) -> None:
    beside = np.cumsum(COAST) / 3600.0 if "km," in header else NOISE
    found = read_recording(written(tmp_path / "a.csv", header, T, beside, COAST))
    np.testing.assert_allclose(found["v"], size * COAST, rtol=1e-7)


@pytest.mark.parametrize("header", ["time,velocity,torque", "time,LeftVelocity,LeftTorque", "t,speed,Drehmoment"])
def test_beside_a_torque_what_says_no_unit_turns(tmp_path: Path, header: str) -> None:
    found = read_recording(written(tmp_path / "a.csv", header, T, np.sin(T), np.cos(T)))
    assert found.angular
    np.testing.assert_allclose(found["v"], np.sin(T), rtol=1e-7)


def test_of_two_slopes_the_one_that_is_called_a_speed_is_it(tmp_path: Path) -> None:
    v = np.gradient(X, T)
    found = read_recording(written(tmp_path / "a.csv", "time,x-position,velocity,momentum", T, X, v, 1.0001 * v))
    np.testing.assert_allclose(found["v"], v, rtol=1e-7)


@pytest.mark.parametrize("low", [0.0, -6.0])
def test_an_angle_that_begins_again_at_360_is_in_degrees(tmp_path: Path, low: float) -> None:
    turned = 35.0 * T - 0.05 * T**2
    found = read_recording(written(tmp_path / "a.csv", "Time,Angle", T, turned % 360.0 + low))
    np.testing.assert_allclose(np.diff(found["x"]), np.deg2rad(np.diff(turned)), rtol=1e-6)
    turned += 0.1 * low  # of a wheel
    whole = read_recording(written(tmp_path / "b.csv", "Time,Angle", T, turned))
    np.testing.assert_allclose(whole["x"], turned, rtol=1e-7)


def test_a_clock_goes_on_past_midnight(tmp_path: Path) -> None:
    clock = [
        f"{(86100 + 2 * k) // 3600 % 24:02d}:{(86100 + 2 * k) // 60 % 60:02d}:{2 * k % 60:02d}" for k in range(300)
    ]
    found = read_recording(written(tmp_path / "a.csv", "clock,angle [deg]", clock, X))
    np.testing.assert_array_equal(found.t, 4.0 * T)
    dates = [f"05-Jan-2024 10:{k // 60:02d}:{k % 60:02d}.500" for k in range(300)]
    found = read_recording(written(tmp_path / "b.csv", "When,angle [deg]", dates, X))
    np.testing.assert_array_equal(found.t, 2.0 * T)
    basic = [f"20240105T10{k // 60:02d}{k % 60:02d}.500Z" for k in range(300)]
    np.testing.assert_array_equal(read_recording(written(tmp_path / "c.csv", "When,angle [deg]", basic, X)).t, 2.0 * T)


def test_a_blank_before_a_quote_is_no_part_of_a_name(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = (f'"{t:.2f}", "{x:.6f}"' for t, x in zip(T, X, strict=True))
    path.write_text("\n".join(['"Time (s)", "Position (cm)"', *rows]))
    np.testing.assert_allclose(read_recording(path)["x"], 0.01 * X, atol=1e-8)


@pytest.mark.parametrize("counted", [False, True])
def test_a_scope_that_tells_its_step_has_times(tmp_path: Path, counted: bool) -> None:
    path = tmp_path / "NewFile1.csv"
    head = ["X,CH2,CH4,Start,Increment,", "Sequence,Volt,Volt,-1.2e-02,5.0e-03"]
    head = head if counted else [line.partition(",")[2] for line in head]
    body = ((f"{k}," if counted else "") + f"{x:.5e},1.0e-3," for k, x in enumerate(X))
    path.write_text("\n".join([*head, *body]) + "\n")
    with pytest.raises(InputError, match=r"x=CH2\[m\].* --rate 200"):
        read_recording(path)
    found = read_recording(path, ReadOptions(columns="x=CH2[m]", rate=200.0))
    np.testing.assert_allclose(found["x"], X, atol=1e-5)


def test_tabs_and_blanks_may_part_the_numbers_of_one_line(tmp_path: Path) -> None:
    path = tmp_path / "swing.txt"
    body = (f"{t:.2f}\t{x:.6f} 0.0008 0.008" for t, x in zip(T, X, strict=True))
    path.write_text("\n".join(["t\tamplitude xerr yerr", *body]) + "\n")
    np.testing.assert_allclose(read_recording(path)["x"], X, atol=1e-6)


def test_a_speed_with_its_unit_goes_before_a_position_in_counts(tmp_path: Path) -> None:
    counts = np.round(2000.0 * np.cumsum(COAST))
    found = read_recording(
        written(tmp_path / "a.csv", "Time [ms],Position [inc],Velocity [rpm]", 1e3 * T, counts, COAST)
    )
    assert set(found.channels) == {"v"}
    assert any("[inc]" in note for note in found.notes)


def test_statistics_below_the_rows_are_left_out_of_every_column(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", "Time (s),Position (mm)", T, X)
    words = ("Statistics", "Mean", "Std", "Min", "Max", "Median", "Range", "Count")
    below = ["", *(f"{word},{k}" for k, word in enumerate(words))]
    path.write_text(path.read_text() + "\n".join(below) + "\n")
    np.testing.assert_allclose(read_recording(path)["x"], 1e-3 * X, rtol=1e-7)


@pytest.mark.parametrize(
    "header",
    [
        "Speed (rpm),Friction Torque (N.m),Temperature (°C)",
        "speed_rpm,torque_nm,voltage_v",
        "velocity,friction,load",
    ],
)
def test_a_curve_of_friction_may_have_other_columns(tmp_path: Path, header: str) -> None:
    speed = np.linspace(-100.0, 100.0, 30)
    found = read_recording(written(tmp_path / "a.csv", header, speed, np.sign(speed), 0.1 * speed + 25.0))
    assert found.steady
    np.testing.assert_allclose(found["u"], np.sign(speed))


SPEEDS = np.linspace(0.02, 0.6, 30)
FORCES = 1.5 + 4.0 * SPEEDS


@pytest.mark.parametrize("mark", [",", ";", " "])
@pytest.mark.parametrize("both_ways", [True, False])
def test_a_curve_of_friction_may_have_no_names(tmp_path: Path, mark: str, both_ways: bool) -> None:
    v, u = (np.concatenate([-y[::-2], y[::2]]) if both_ways else y for y in (SPEEDS, FORCES))
    path = tmp_path / "a.csv"
    path.write_text("".join(f"{one:.17g}{mark}{other:.17g}\n" for one, other in zip(v, u, strict=True)))
    found = read_recording(path) if both_ways else asked(path)
    assert found.steady
    np.testing.assert_allclose(found["v"], v)
    np.testing.assert_allclose(found["u"], u)


def test_few_rows_of_a_motion_are_no_curve_of_friction(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("".join(f"{0.1 * i},{np.cos(i):.6f}\n" for i in range(30)))
    with pytest.raises(InputError, match="30 samples; expected at least 50"):
        read_recording(path)


PERIODS = 0.1 + 0.002 * np.arange(120.0)


@pytest.mark.parametrize(
    ("header", "per_s", "beside", "told"),
    [
        ("rev time [ms]", 1e3, "", True),
        ("seconds per turn", 1.0, "", True),
        ("T [s/rev]", 1.0, "", True),
        ("period", 1.0, "", False),
        ("period (s)", 1.0, "turn", False),
        ("period_us", 1e6, "n", False),
        ("period (s)", 1.0, "time (s)", False),
    ],
)
def test_how_long_each_turn_took_is_when_it_ended(
    tmp_path: Path, header: str, per_s: float, beside: str, told: bool
) -> None:
    ends = np.cumsum(PERIODS)
    others = {"": (), "time (s)": (ends,)}.get(beside, (np.arange(120.0),))
    path = written(tmp_path / "a.csv", ",".join([beside, header] if beside else [header]), *others, PERIODS * per_s)
    found = read_recording(path) if told else asked(path)
    np.testing.assert_allclose(found.t, ends, rtol=1e-8)
    np.testing.assert_allclose(found["x"], 2.0 * np.pi * np.arange(120.0), rtol=1e-12)
    assert found.angular


@pytest.mark.parametrize(
    ("header", "size"),
    [
        ("time (since start),pos [mm]", 1e-3),
        ("Time (from trigger),Displacement (laser 1)", 1.0),
        ("t (elapsed),x (measured)", 1.0),
        ("time [UTC],angle (encoder A)", 1.0),
    ],
)
def test_words_in_brackets_that_are_no_unit_say_which_column_it_is(tmp_path: Path, header: str, size: float) -> None:
    found = read_recording(written(tmp_path / "a.csv", header, T, X))
    np.testing.assert_array_equal(found.t, T)
    np.testing.assert_allclose(found["x"], size * X, rtol=1e-8)


def test_what_was_commanded_stays_so_in_brackets(tmp_path: Path) -> None:
    found = read_recording(written(tmp_path / "a.csv", "time,pos (target),pos (measured)", T, 2.0 * X, X))
    np.testing.assert_allclose(found["x"], X, rtol=1e-8)


@pytest.mark.parametrize("header", ["time [s],pos [raw]", "time (since start),pos (encoder counts)"])
def test_counts_in_brackets_are_asked(tmp_path: Path, header: str) -> None:
    path = written(tmp_path / "a.csv", header, T, X)
    with pytest.raises(InputError, match=r"pos .* is what a sensor counts. Try: "):
        read_recording(path)
    np.testing.assert_allclose(asked(path)["x"], X, rtol=1e-8)


@pytest.mark.parametrize(
    "header",
    ["time_ms,encoder", "time_ms,angle_counts", "time_ms,angle [ticks]", "t [ms],EncoderA", "t [ms],theta_raw"],
)
def test_steps_of_what_turns_are_asked_in_rad_and_never_in_mm(tmp_path: Path, header: str) -> None:
    """A pendulum's sensor of 4096 steps a turn, of whose steps nothing is said."""
    steps = np.round(4096.0 / (2.0 * np.pi) * 0.4 * X / np.max(np.abs(X))) + 600.0
    path = written(tmp_path / "a.csv", header, 1e3 * T, steps)
    with pytest.raises(InputError, match=r"0\.00153398 rad are a step where 4096 are a turn\. Try: "):
        read_recording(path)
    np.testing.assert_allclose(asked(path)["x"], 2.0 * np.pi / 4096.0 * steps, rtol=1e-6)
    assert asked(path).angular


def in_frames(t: FloatArray, steps: FloatArray, form: str) -> list[str]:
    """A position in the second pair of bytes of frames 0x181, low byte first, among a node's heartbeats."""
    data = [bytes([7, 0, *int(one).to_bytes(2, "little", signed=True)]).hex(" ").upper() for one in steps]
    rows = []
    for i, (at, said) in enumerate(zip(t, data, strict=True)):
        if form == "log":
            rows += [f"({1.7e9 + at:.6f}) can0 181#{said.replace(' ', '')}"]
            rows += [f"({1.7e9 + at:.6f}) can0 701#05"] * (i % 10 == 0)
        else:
            stamp = f" ({1e3 + at:013.6f})" if form == "screen" else ""
            rows += [f"{stamp}  can0  {'RX - -  ' * (form == 'screen')}181   [4]  {said}"]
    return rows


@pytest.mark.parametrize("form", ["log", "screen", "bare"])
def test_frames_of_a_can_bus_are_numbers_of_two_bytes_and_of_four(tmp_path: Path, form: str) -> None:
    steps = np.round(900.0 * X / np.max(np.abs(X))) - 200.0
    path = tmp_path / "can.log"
    path.write_text("\n".join(in_frames(T, steps, form)) + "\n")
    rate, clock = (1.0 / float(T[1] - T[0]), "") if form == "bare" else (None, "t=t,")
    with pytest.raises(InputError, match=r"x=int16_2") as refused:
        read_recording(path, ReadOptions(rate=rate))
    assert "int32be_0" in str(refused.value)
    found = read_recording(path, ReadOptions(columns=f"{clock}x=0.5*int16_2[deg]", rate=rate))
    np.testing.assert_allclose(found["x"], np.deg2rad(0.5 * steps), rtol=1e-9)
    np.testing.assert_allclose(found.t - found.t[0], T, atol=2e-6)
    assert any("Frames of 181 are read, and not those of 701" in note for note in found.notes) == (form == "log")


def test_registers_in_hexadecimal_are_whole_numbers(tmp_path: Path) -> None:
    steps = np.round(900.0 * X / np.max(np.abs(X))).astype(int) + 2000
    rows = [f"{1e3 * t:g},0x{x:04X}" for t, x in zip(T, steps, strict=True)]
    path = tmp_path / "a.csv"
    path.write_text("\n".join(["time_ms,position [mm]", *rows]) + "\n")
    np.testing.assert_allclose(read_recording(path)["x"], 1e-3 * steps, rtol=1e-9)


@pytest.mark.parametrize(("header", "step"), [("dt_ms", 10.0), ("dt [s]", 0.01), ("delta_t_us", 1e4)])
def test_a_column_of_equal_steps_gives_the_rate_of_the_line_to_paste(tmp_path: Path, header: str, step: float) -> None:
    path = written(tmp_path / "a.csv", f"{header},pos_mm", np.full(T.size, step), 1e3 * X)
    with pytest.raises(InputError, match=r"--rate 100(?!\d)"):
        read_recording(path)


def test_an_encoder_that_shows_fractions_may_be_one_of_a_length(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"x=encoder\[mm\]"):
        read_recording(written(tmp_path / "a.csv", "time [s],encoder", T, 1e3 * X + 0.25))


FINE = 0.05 * np.arange(800.0)
SWING = np.exp(-FINE / 20.0) * np.cos(FINE)


@pytest.mark.parametrize("factor", [1000.0, 180.0 / np.pi, -1.0, 7.3])
def test_a_speed_that_is_not_the_slope_of_the_position_is_left_out_and_said(tmp_path: Path, factor: float) -> None:
    v = np.gradient(SWING, FINE)
    path = written(tmp_path / "a.csv", "t,x,v", FINE, SWING, factor * v)
    found = read_recording(path)
    assert list(found.channels) == ["x"]
    assert found.mended[0].startswith("The speed is ")
    words = shlex.split(found.mended[0])
    np.testing.assert_allclose(
        read_recording(path, ReadOptions(columns=words[words.index("--columns") + 1]))["v"], v, rtol=0.01
    )
    assert "v" in read_recording(path, ReadOptions(columns="t=t,x=x,v=v")).channels


@pytest.mark.parametrize("gain", [0.7, 1.0, 1.4])
def test_a_gain_of_a_speed_sensor_is_left_to_the_diagnosis(tmp_path: Path, gain: float) -> None:
    path = written(tmp_path / "a.csv", "t,x,v", FINE, SWING, gain * np.gradient(SWING, FINE))
    assert list(read_recording(path).channels) == ["x", "v"]


def test_what_repeats_with_its_time_is_another_run(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", "t,x,t,x,t,x", T, X, T, 2.0 * X, T, 3.0 * X)
    for run in (1, 2, 3):
        np.testing.assert_allclose(read_recording(path, ReadOptions(run=run))["x"], run * X, rtol=1e-8)
    assert any("holds 3 runs" in note for note in read_recording(path).notes)


def test_rows_with_the_latest_first_are_read_from_the_last(tmp_path: Path) -> None:
    found = read_recording(written(tmp_path / "a.csv", "t,x", T[::-1], X[::-1]))
    np.testing.assert_array_equal(found.t, T)
    np.testing.assert_allclose(found["x"], X, rtol=1e-8)
    assert found.mended == ("Rows stand with the latest first: they are read from the last.",)


@pytest.mark.parametrize("name", ["rig.mat", "rig", "rig.data", "rig.xls"])
def test_rows_of_text_are_read_under_any_name(tmp_path: Path, name: str) -> None:
    np.testing.assert_allclose(read_recording(written(tmp_path / name, "t,x", T, X))["x"], X, rtol=1e-8)


def test_whole_ms_that_were_computed_are_ms(tmp_path: Path) -> None:
    path = tmp_path / "rig.npz"
    np.savez(path, time=0.004 * np.arange(300) * 1e3, pos=0.1 * X)
    np.testing.assert_allclose(read_recording(path).t, 0.004 * np.arange(300), rtol=1e-12)


@pytest.mark.parametrize("unit", ["V", "kg"])
def test_a_unit_of_another_kind_is_asked_for_its_scale(tmp_path: Path, unit: str) -> None:
    path = written(tmp_path / "a.csv", f"t [s],x [{unit}]", T, X)
    with pytest.raises(InputError, match=r"whose scale goes in place of 1. Try: "):
        read_recording(path)
    np.testing.assert_allclose(asked(path)["x"], X, rtol=1e-8)


def test_a_page_of_the_web_is_no_table(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("<!DOCTYPE html>\n<html>404, no such file</html>\n")
    with pytest.raises(InputError, match="a page of the web or XML"):
        read_recording(path)


def test_edges_of_a_pulse_are_turns_when_somebody_says_so(tmp_path: Path) -> None:
    """Of a logic analyser's rows, one for each edge: those that rise, and not the level at the start."""
    up = np.cumsum(np.linspace(0.05, 0.4, 120))
    edges = [f"{t:.9f},1\n{t + 0.002:.9f},0" for t in up]
    path = tmp_path / "digital.csv"
    path.write_text("\n".join(["Time [s],Channel 0", "0.000000000,0", *edges]) + "\n")
    with pytest.raises(InputError, match=r"t='Time \[s\]',x=#0\[rev\]"):
        read_recording(path)
    found = read_recording(path, ReadOptions(columns="t='Time [s]',x=#0[rev]"))
    np.testing.assert_allclose(found.t, up, atol=1e-9)
    np.testing.assert_allclose(found["x"], 2.0 * np.pi * np.arange(120))


def test_turns_of_a_motors_field_are_asked_before_a_gyroscope_that_stands(tmp_path: Path) -> None:
    t, rng = np.arange(500) / 500.0, np.random.default_rng(1)
    erpm = np.round(600.0 * np.exp(-4.0 * t))
    head = "time (us),gyroADC[0],gyroADC[1],eRPM[0]"
    path = written(tmp_path / "log.csv", head, 1e6 * t, *rng.integers(-2, 3, (2, 500)).astype(float), erpm)
    with pytest.raises(InputError, match=r"eRPM\[0\] is of the motor's field.*v='eRPM\[0\]'\[rpm\]"):
        read_recording(path)


def test_a_lone_column_that_falls_to_nought_is_proposed_as_a_speed(tmp_path: Path) -> None:
    """However rough: a GPS's speed of a coasting bicycle."""
    rng = np.random.default_rng(2)
    v = np.abs(np.linspace(29.0, 0.0, 160) * (1.0 + 0.15 * rng.standard_normal(160)))
    path = tmp_path / "coast.csv"
    path.write_text("\n".join(f"{one:.3f}" for one in np.concatenate((v, [0.0]))) + "\n")
    with pytest.raises(InputError, match='--columns "v=#1" --rate HZ'):
        read_recording(path)


@pytest.mark.parametrize("name", ["Wheel Speed", "speed"])
def test_a_speed_beyond_any_of_m_s_is_asked_in_rpm(tmp_path: Path, name: str) -> None:
    path = written(tmp_path / "wheel.txt", f"Time,{name}", T, 35.0 * COAST)
    np.testing.assert_allclose(asked(path)["v"], 35.0 * COAST * np.pi / 30.0, rtol=1e-6)
    assert read_recording(path, ReadOptions(columns=f"t=Time,v={name}")).angular is False


def test_a_force_alone_is_told_to_be_one(tmp_path: Path) -> None:
    path = written(tmp_path / "pull.csv", "Time [s],Fz [N]", T, NOISE)
    with pytest.raises(InputError, match=r"Fz \[N\] is a force, and no motion was recorded with it"):
        read_recording(path)


def test_counts_that_are_stamped_as_they_change_lie_half_way_between(tmp_path: Path) -> None:
    """A logger that writes a row at each edge of an encoder: as they stand the counts lag by half a step."""
    t, step = np.linspace(0.0, 20.0, 400_001), 2.0 * np.pi / 2400.0
    x = 0.3 * np.exp(-0.1 * t) * np.cos(5.0 * t)
    count = np.floor(x / step + 0.5)
    at = np.flatnonzero(np.diff(count)) + 1
    found = read_recording(written(tmp_path / "ticks.csv", "timestamp,angle", t[at], step * count[at]))
    assert "Each stamp is that of a count that changed" in " ".join(found.mended)
    np.testing.assert_allclose(found.t, t[at][1:], atol=1e-9)
    np.testing.assert_allclose(found["x"], x[at][1:], atol=1e-4)
    even = np.arange(0.0, 20.0, 0.01)  # by a clock, a count may well repeat
    clocked = read_recording(written(tmp_path / "even.csv", "t,angle", even, np.round(X[0] + even / step) * step))
    assert not any("count that changed" in said for said in clocked.mended)


def test_a_blank_second_line_is_no_fault(tmp_path: Path) -> None:
    """A title alone above blank cells is how a file of Tracker begins."""
    (tmp_path / "a.txt").write_text("sensor\n\t\t\n\n" + "".join(f"{t},{x:.6f}\n" for t, x in zip(T, X, strict=True)))
    np.testing.assert_allclose(read_recording(tmp_path / "a.txt")["x"], X, atol=1e-6)


def test_a_car_that_rolls_out_is_asked_in_kmh(tmp_path: Path) -> None:
    t = np.arange(120.0)
    path = written(tmp_path / "car.csv", "time,speed", t, 130.0 / (1.0 + t / 60.0))
    with pytest.raises(InputError, match="speed says no unit, and goes too fast or too far for m/s"):
        read_recording(path)
    np.testing.assert_allclose(asked(path)["v"], 130.0 / (1.0 + t / 60.0) / 3.6, rtol=1e-6)


def test_a_swing_too_fast_for_metres_is_asked(tmp_path: Path) -> None:
    t = np.arange(600) / 60.0
    x = 12.0 * np.exp(-0.1 * t) * np.cos(7.7 * t)
    with pytest.raises(InputError, match=r"X says no unit, and goes too fast or too far for m\. Try: "):
        read_recording(written(tmp_path / "track.csv", "T,X,Y", t, x, 3.0 + 0.001 * x))
    found = read_recording(written(tmp_path / "own.csv", "t,x", t, x))
    np.testing.assert_allclose(found["x"], x, rtol=1e-6)


def test_body_parts_of_a_video_are_asked_for_their_scale(tmp_path: Path) -> None:
    """DeepLabCut's three rows of names; pixels, and frames without a rate."""
    x = 320.0 + 200.0 * X
    names = ["scorer,net,net,net", "bodyparts,bob,bob,bob", "coords,x,y,likelihood"]
    rows = [f"{i},{one:.6f},{240.0 + 0.1 * (i % 7):.6f},0.99" for i, one in enumerate(x)]
    path = tmp_path / "trackDLC.csv"
    path.write_text("\n".join([*names, *rows]) + "\n")
    with pytest.raises(InputError, match=r'bob x is what a sensor counts. Try: --columns "x=bob x\[m\]" --rate HZ'):
        read_recording(path)
    found = read_recording(path, ReadOptions(columns="x=0.005*'bob x'[m]", rate=100.0))
    np.testing.assert_allclose(found["x"], 0.005 * x, rtol=1e-6)


def test_a_count_of_few_marks_that_a_clock_samples_is_read_at_its_steps(tmp_path: Path) -> None:
    """A wheel of one mark a turn at 4 turns/s that slows, sampled at 50 Hz: each step within half a sample."""
    t = np.arange(0.0, 60.0, 0.02)
    turns = 4.0 * t - 0.03 * t**2
    found = read_recording(written(tmp_path / "wheel.csv", "time_s,turns [rev]", t, np.floor(turns)))
    np.testing.assert_allclose(found["x"] / (2.0 * np.pi), np.arange(1.0, found.t.size + 1.0), rtol=1e-12)
    assert np.max(np.abs(np.interp(found.t, t, turns) - found["x"] / (2.0 * np.pi))) <= 4.0 * 0.01 * 1.001
    assert any("The count stands at most samples" in note for note in found.mended)
    fine = read_recording(written(tmp_path / "fine.csv", "time_s,turns [rev]", t, np.floor(100.0 * turns) / 100.0))
    assert fine.t.size == t.size


def test_percent_of_a_torque_is_asked_in_newton_metres_and_a_temperature_is_told(tmp_path: Path) -> None:
    v, temperature = np.tile(np.linspace(10.0, 200.0, 10), 2), np.repeat([20.0, 60.0], 10)
    percent = written(tmp_path / "percent.csv", "speed (rpm),torque (%)", v, 5.0 + 0.01 * v)
    with pytest.raises(InputError, match=r"u=1\*'torque \(%\)'\[Nm\]"):
        read_recording(percent)
    warm = written(tmp_path / "warm.csv", "speed [rpm],temperature [degC],torque [Nm]", v, temperature, 5.0 + 0.01 * v)
    assert any("--covariate 'temperature' asks it" in note for note in read_recording(warm).notes)
    asked_for = read_recording(warm, ReadOptions(covariates=("temperature",)))
    assert not any("asks it" in note for note in asked_for.notes)


@pytest.mark.parametrize(
    ("header", "torque", "worth"),
    [
        ("t [s],angle [rad],current [A]", True, "Nm per A"),
        ("t [s],x [mm],Motorstrom [mA]", False, "N per mA"),
        ("t [s],x [mm],iq", False, "N per unit"),
        ("t [s],x [mm],laser [V]", False, ""),
    ],
)
def test_a_current_beside_what_is_driven_is_offered_as_its_force(
    tmp_path: Path, header: str, torque: bool, worth: str
) -> None:
    """The line that is printed reads it, with the torque constant times the gear in place of 1."""
    t = np.arange(0.0, 20.0, 0.01)
    path = written(tmp_path / "motor.csv", header, t, np.sin(3.0 * t), 0.3 * np.sin(3.0 * t + 1.0))
    wanted = classify(read_recording(path)).wanted
    if not worth:
        assert "record the force or current" in wanted
        return
    assert f"with the {worth}, a motor's constant times the gear" in wanted
    columns = wanted.split('--columns "')[1].split('"')[0]
    driven = read_recording(path, ReadOptions(columns=columns.replace("u=1*", "u=2*")))
    np.testing.assert_allclose(driven["u"], 0.6 * np.sin(3.0 * t + 1.0), atol=1e-8)
    assert driven.angular is torque
    assert not classify(driven).wanted


@pytest.mark.parametrize(
    ("below", "scale"), [("s,mm", 1e-3), ("[s],[mm]", 1e-3), ("100,1", 1.0), ("end,of record", 1.0)]
)
def test_units_that_stand_below_the_numbers_are_those_of_the_columns(tmp_path: Path, below: str, scale: float) -> None:
    t = 0.05 * np.arange(300.0)
    path = written(tmp_path / "below.csv", "t,x", t, 30.0 * X)
    path.write_text(path.read_text() + below + "\n")
    found = read_recording(path)
    np.testing.assert_allclose(found["x"][:300], 30.0 * scale * X, rtol=1e-8, atol=1e-9)
    assert found.t.size == (301 if below == "100,1" else 300)

"""What changed between two conditions of a machine: decays in closed form, of which one number is another."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.app.diagnose.change import swinging_alike
from harness.cli.main import run
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.results.compare import ChangeResult

T: FloatArray = np.arange(900) / 60.0


def decay(seed: int, c: float = 0.3, k: float = 100.0, f: float = 0.1, m: float = 1.0, x0: float = 0.1) -> Recording:
    """A slider let go from x0, swing by swing: between its turning points each is a damped cosine about f / k."""
    omega, gamma = math.sqrt(k / m), 0.5 * c / m
    damped = math.sqrt(omega**2 - gamma**2)
    half, x = math.pi / damped, np.full(T.size, np.nan)
    start, now = x0, 0.0
    while now < T[-1] and abs(start) * k > f:
        about = math.copysign(f / k, start)
        inside = (now <= T) & (now + half >= T)
        s = T[inside] - now
        swing = np.exp(-gamma * s) * (np.cos(damped * s) + gamma / damped * np.sin(damped * s))
        x[inside] = about + (start - about) * swing
        start, now = about - (start - about) * math.exp(-gamma * half), now + half
    x[np.isnan(x)] = start
    noise = 3e-5 * np.random.default_rng(seed).standard_normal(T.size)
    return Recording(T, {"x": x + noise}, f"swing-{seed}.csv")


def test_friction_that_is_another_is_told_and_what_stayed_stays() -> None:
    found = harness.change([decay(1), decay(2, x0=0.08)], [decay(3, f=0.15), decay(4, f=0.15, x0=0.09)], zero="spring")
    assert found.changed == ["f_k"]
    number = {one.name: one for one in found.numbers}
    friction = number["f_k"].ratio
    assert friction.value is not None
    assert friction.stderr is not None
    assert friction.value == pytest.approx(1.5, abs=3.0 * friction.stderr)
    assert friction.stderr < 0.03
    for name in ("c", "k"):
        ratio = number[name].ratio
        assert ratio.value == pytest.approx(1.0, abs=3.0 * (ratio.stderr or 0.0))
        assert number[name].before == number[name].after
    assert found.chance < 1e-3 < found.left


def test_a_heavier_slider_is_one_change_and_not_three() -> None:
    found = harness.change([decay(1), decay(2)], [decay(3, m=1.2), decay(4, m=1.2, x0=0.08)], zero="spring")
    assert found.changed == ["inertia"]
    (inertia,) = (one.ratio for one in found.numbers if one.name == "inertia")
    assert inertia.value == pytest.approx(1.2, abs=3.0 * (inertia.stderr or 0.0))


def test_repeats_of_one_condition_are_not_called_different() -> None:
    found = harness.change([decay(1)], [decay(2, x0=0.09)], zero="spring")
    assert found.changed == []
    assert found.chance > 0.05
    assert any("repeats" in line for line in found.warnings)


def written(folder: Path, name: str, recording: Recording) -> str:
    path = folder / name
    np.savetxt(path, np.column_stack((recording.t, recording["x"])), delimiter=",", header="t [s],x [m]", comments="")
    return str(path)


def test_the_command_takes_every_file_behind_each_condition(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = [written(tmp_path, f"b{i}.csv", decay(i)) for i in (1, 2)]
    after = written(tmp_path, "a.csv", decay(3, c=0.6))
    out = tmp_path / "out"
    words = ["diagnose", "--before", *before, "--after", after, "--zero", "spring", "--out", str(out), "--quiet"]
    assert run(words) == 0
    assert sorted(path.name for path in out.iterdir()) == ["log.txt", "report.html", "result.json"]
    capsys.readouterr()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--before", "A"], "--after FILE"),
        (["--after", "A"], "--before FILE"),
        (["A", "--before", "A", "--after", "A"], "behind one of the two"),
        (["--before", "A", "--after", "A", "--together"], "--together"),
        (["--before", "A", "--after", "A"], "sample for sample"),
        (["--before", "A", "--after", "missing.csv"], "no such file"),
    ],
)
def test_conditions_that_say_nothing_are_refused_in_one_line(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, "a.csv", decay(1))
    out = tmp_path / "out"
    assert run(["diagnose", *(path if word == "A" else word for word in words), "--out", str(out)]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") <= 2
    assert not out.exists()


def test_a_decay_and_a_driven_recording_are_not_one_machine() -> None:
    driven = Recording(T, {"x": decay(1)["x"], "u": np.sin(T)}, "driven.csv")
    with pytest.raises(InputError, match="not both"):
        harness.change([decay(1)], [driven])


def coast(seed: int, friction: float, damping: float, v0: float = 20.0) -> Recording:
    """What only slows: v' = -(f + c v), until it stops."""
    t: FloatArray = np.arange(600) / 20.0
    v = np.maximum((v0 + friction / damping) * np.exp(-damping * t) - friction / damping, 0.0)
    return Recording(t, {"v": v + 0.02 * np.random.default_rng(seed).standard_normal(t.size)}, f"coast-{seed}.csv")


def test_run_downs_of_two_conditions() -> None:
    before = [coast(1, 0.8, 0.05), coast(2, 0.8, 0.05, 18.0)]
    found = harness.change(before, [coast(3, 1.2, 0.05), coast(4, 1.2, 0.05, 19.0)])
    assert found.changed == ["f_k"]
    (friction,) = (one.ratio for one in found.numbers if one.name == "f_k")
    assert friction.value == pytest.approx(1.5, abs=3.0 * (friction.stderr or 0.0))


def test_curves_of_two_conditions() -> None:
    """Of a table no mass is told, so that none can have changed."""
    v: FloatArray = np.concatenate((-np.linspace(0.1, 2.0, 12), np.linspace(0.1, 2.0, 12)))

    def curve(seed: int, damping: float) -> Recording:
        u = 0.5 * np.sign(v) + damping * v + 0.004 * np.random.default_rng(seed).standard_normal(v.size)
        return Recording(np.arange(v.size, dtype=np.float64), {"v": v, "u": u}, f"curve-{seed}.csv", steady=True)

    found = harness.change([curve(1, 0.2), curve(2, 0.2)], [curve(3, 0.3), curve(4, 0.3)])
    assert found.changed == ["c"]
    assert [one.name for one in found.numbers] == ["c", "f_k"]


def test_a_decay_and_a_run_down_are_not_one_kind() -> None:
    with pytest.raises(InputError, match="one kind"):
        harness.change([decay(1)], [coast(2, 0.8, 0.05)])


AREA = 40.0


def cylinder(seed: int, pressure: float, friction: float) -> Recording:
    """A piston moved through its stroke: what it takes is 40 N/bar P, friction, 50 N s/m; moving presses the air."""
    t: FloatArray = np.arange(600) / 60.0
    draw = np.random.default_rng(seed)
    a, b = 1.7 + 0.1 * seed, 4.1
    v = 0.03 * np.cos(a * t) + 0.012 * np.cos(b * t + 1.0)
    x = 0.03 / a * np.sin(a * t) + 0.012 / b * np.sin(b * t + 1.0)
    lagged = np.convolve(np.sign(v), np.full(9, 1.0 / 9.0), mode="same")
    p = pressure + 0.02 * lagged + 0.01 * np.sin(0.9 * t)
    u = 50.0 * v + friction * np.sign(v) + AREA * p + 0.1 * draw.standard_normal(t.size)
    noisy = {"P": p + 0.001 * draw.standard_normal(t.size)}
    x_read = x + 1e-5 * draw.standard_normal(t.size)
    return Recording(t, {"x": x_read, "u": u}, f"{pressure:g}bar-{seed}.csv", covariates=noisy)


def pressed(after: float, friction: float) -> ChangeResult:
    """Afterwards at another pressure; no laws are looked for, as there are none."""
    before, later = [cylinder(1, 1.0, 2.0)], [cylinder(2, after, friction)]
    return harness.change(before, later, restoring="none", covariates=["P"], budget=0.1)


def test_a_pressure_that_presses_its_seal_is_told_beside_its_push() -> None:
    found = pressed(5.0, 3.0)
    assert found.changed == ["f_k"]
    (friction,) = (one.ratio for one in found.numbers if one.name == "f_k")
    assert friction.value == pytest.approx(1.5, abs=3.0 * (friction.stderr or 0.0))
    (given,) = found.given
    assert given.before == pytest.approx(1.0, abs=0.02)
    assert given.after == pytest.approx(5.0, abs=0.02)
    assert found.statement.startswith("P went from 1 to 5")


def test_a_pressure_that_only_pushes_changes_nothing() -> None:
    found = pressed(5.0, 2.0)
    assert found.changed == []
    (gain,) = (line.split("gain_P is ")[1].split()[0] for line in found.warnings if "gain_P is " in line)
    assert float(gain) == pytest.approx(-AREA, abs=0.1)


def test_of_decays_no_column_is_taken_beside() -> None:
    plain = [decay(1), decay(2)]
    acting = [replace(one, covariates={"T": np.linspace(20.0, 30.0, T.size)}) for one in plain]
    with pytest.raises(InputError, match="measured force"):
        harness.change(acting[:1], acting[1:], covariates=["T"])


def test_a_pressure_that_is_the_same_throughout_is_no_change() -> None:
    """Its push is fitted whether or not it varies; what the motion presses is then friction, part of it dry."""
    each = [cylinder(seed, 3.0, 2.0) for seed in (1, 2)]
    before, later = (replace(one, covariates={"P": np.full(600, 3.0)}) for one in each)
    found = harness.change([before], [later], restoring="none", covariates=["P"], budget=0.1)
    assert found.changed == []
    (friction,) = (one.before for one in found.numbers if one.name == "f_k")
    assert friction is not None
    assert friction.value is not None
    assert 2.0 < friction.value < 2.0 + 0.02 * AREA


def test_decays_are_compared_from_where_all_swing_alike() -> None:
    """What none swings as far as is cut off, whole half-swings of it; the least keeps all it has."""
    far, near = decay(1, x0=0.1), decay(2, x0=0.06)
    cut, kept = swinging_alike([far, near])
    assert len(kept) == len(near)
    assert float(np.max(np.abs(cut["x"]))) <= float(np.max(np.abs(near["x"])))
    # the height falls by 0.15/s of itself, and by 2 f / k a half-swing
    dry = 2.0 * 0.001 / (0.15 * math.pi / 10.0)
    assert cut.t[0] == pytest.approx(math.log((0.1 + dry) / (0.06 + dry)) / 0.15, abs=2.0 * math.pi / 10.0)
    assert np.array_equal(cut["x"], far["x"][-len(cut) :])

"""Friction curves: tables of speeds that were held and the force that held them. Truths are the formulas themselves."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording

SPEEDS = np.geomspace(0.02, 3.0, 14)
NOISE = 0.01


def table(force: FloatArray, speeds: FloatArray = SPEEDS) -> Recording:
    """A table in the order of nobody; force (n,) at speeds (n,)."""
    random = np.random.default_rng(2)
    mixed = random.permutation(speeds.size)
    noisy = force + NOISE * random.standard_normal(speeds.size)
    return Recording(np.arange(speeds.size, dtype=np.float64), {"v": speeds[mixed], "u": noisy[mixed]}, steady=True)


def both(force: FloatArray, push: float = 0.0) -> Recording:
    """The same in both directions, with a force that pushes besides."""
    return table(np.concatenate((-force[::-1], force)) + push, np.concatenate((-SPEEDS[::-1], SPEEDS)))


def test_viscous_and_coulomb_friction_are_read_off() -> None:
    found = harness.diagnose(both(1.2 + 0.3 * SPEEDS), engines=())
    assert found.verdict == "adequate"
    for name, truth in (("f_k", 1.2), ("c", 0.3)):
        one = found.baseline.parameters[name]
        assert one.value is not None
        assert one.stderr is not None
        assert abs(one.value - truth) < 4.0 * one.stderr


@pytest.mark.parametrize(
    ("name", "force"),
    [
        ("stribeck", 1.2 + 0.3 * SPEEDS + 0.8 * np.exp(-((SPEEDS / 0.15) ** 2))),
        ("quadratic-drag", 1.2 + 0.1 * SPEEDS + 0.25 * SPEEDS**2),
        ("power-law-damping", 0.6 + 1.1 * SPEEDS**0.5),
    ],
)
def test_a_law_of_the_speed_is_named_in_one_direction(name: str, force: FloatArray) -> None:
    found = harness.diagnose(table(force), engines=())
    assert [m.name for m in found.mechanisms] == [name]
    assert any("one direction" in note for note in found.recording.notes)


def test_two_laws_that_a_table_leaves_open_are_told_without_a_release() -> None:
    speeds = np.geomspace(0.023, 4.6, 22)
    noise = 1.0 + 5e-3 * np.random.default_rng(7).standard_normal(speeds.size)
    force = (0.0773 + 0.0121 * speeds + 0.02 * (speeds / 2.48) ** 0.7) * noise
    rows = np.arange(speeds.size, dtype=np.float64)
    found = harness.diagnose(Recording(rows, {"v": speeds, "u": force}, steady=True), engines=())
    assert found.next_experiment.startswith("To tell power-law-damping from")
    assert "release" not in found.next_experiment


def test_an_offset_is_told_where_both_directions_are_and_signs_of_a_resistance_are_too() -> None:
    found = harness.diagnose(both(1.2 + 0.3 * SPEEDS, push=0.4), engines=())
    assert [m.name for m in found.mechanisms] == ["constant-force"]
    turned = harness.diagnose(both(-1.2 - 0.3 * SPEEDS), engines=())
    assert turned.verdict == "adequate"
    assert turned.baseline.parameters["f_k"].value == pytest.approx(1.2, abs=0.02)
    assert any("sign is turned" in note for note in turned.recording.notes)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_every_row_stands_beside_the_law_and_the_base_model(sign: float) -> None:
    force = 1.2 + 0.3 * SPEEDS + 0.8 * np.exp(-((SPEEDS / 0.15) ** 2))
    found = harness.diagnose(both(sign * force), engines=())
    (law,) = found.laws
    assert np.allclose(law.at, np.concatenate((-SPEEDS[::-1], SPEEDS)))
    assert np.allclose(np.abs(law.seen), np.concatenate((force[::-1], force)), atol=5.0 * NOISE)
    assert np.allclose(law.seen, law.fitted, atol=5.0 * NOISE)
    assert law.between is not None
    between = np.abs(law.between.at)
    truth = 1.2 + 0.3 * between + 0.8 * np.exp(-((between / 0.15) ** 2))
    assert np.allclose(np.abs(law.between.fitted), truth, atol=5.0 * NOISE)
    left = found.plot("residual-u", "plotly").data
    assert np.max(np.abs(left[1].y)) < 5.0 * NOISE
    assert np.max(np.abs(left[0].y)) > 0.1


def test_friction_that_falls_with_temperature_is_told_beside_the_law(tmp_path: Path) -> None:
    random, rows = np.random.default_rng(4), ["speed [rad/s],torque [N m],temperature [degC]"]
    for degrees in (20.0, 40.0, 60.0):
        for side in (-1.0, 1.0):
            force = 0.02 * (1.0 - 0.006 * (degrees - 40.0)) + 1e-5 * SPEEDS + 1e-4 * random.standard_normal(SPEEDS.size)
            rows += [f"{side * v:.6g},{side * u:.6g},{degrees:g}" for v, u in zip(SPEEDS, force, strict=True)]
    file = tmp_path / "warm.csv"
    file.write_text("\n".join(rows) + "\n")
    found = harness.diagnose(file, engines=(), covariates=["temperature"])
    assert found.verdict == "adequate"
    for name, truth in (("gain_temperature", -0.006), ("f_k", 0.02)):
        one = found.baseline.parameters[name]
        assert one.value is not None
        assert one.stderr is not None
        assert abs(one.value - truth) < 4.0 * one.stderr
        assert one.stderr < 0.1 * abs(truth)


def test_a_file_without_a_time_needs_no_option_and_leaves_page_trace_and_models(tmp_path: Path) -> None:
    rows = "\n".join(f"{v:.5f},{1.2 + 0.3 * v:.5f}" for v in SPEEDS)
    file = tmp_path / "table.csv"
    file.write_text(f"speed [rad/s],torque [N m]\n{rows}\n")
    found = harness.diagnose(file, out=tmp_path / "left")
    assert found.baseline.parameters["c"].value == pytest.approx(0.3, abs=0.01)
    for name in ("report.html", "trace.rrd", "model/model.json"):
        assert (tmp_path / "left" / name).stat().st_size > 0
    page = (tmp_path / "left" / "report.html").read_text()
    assert page.index("Friction by speed") < page.index("Residual by speed")


def test_a_table_is_identified_under_each_assumption(tmp_path: Path) -> None:
    found = harness.identify(both(1.2 + 0.3 * SPEEDS), out=tmp_path / "left")
    for name, truth in (("f_k", 1.2), ("c", 0.3)):
        one = getattr(found.slowing["both"], name)
        assert abs(one.value - truth) < 4.0 * one.stderr
    alone = harness.identify(both(0.8 * SPEEDS)).slowing["exponential"].c
    assert alone.value == pytest.approx(0.8, abs=4.0 * (alone.stderr or 0.0))
    page = (tmp_path / "left" / "report.html").read_text()
    assert "28 steady speeds from -3 to 3 m/s" in page
    assert " Hz" not in page.partition("</header>")[0]


def test_what_needs_a_motion_is_refused_with_a_table() -> None:
    one = both(1.2 + 0.3 * SPEEDS)
    for asked in ({"restoring": "spring"}, {"validate": one}, {"horizon": 1.0}):
        with pytest.raises(InputError):
            harness.diagnose(one, engines=(), **asked)
    with pytest.raises(InputError):
        harness.diagnose([one, one], engines=())


@pytest.mark.parametrize(
    ("falls", "shape", "at"),
    [(lambda s: np.exp(-s), "exponent", 1.0), (lambda s: 1.0 / (1.0 + s**2), "tail", 1.0)],
    ids=["exponential", "Lorentzian"],
)
def test_stribeck_is_one_name_with_its_form_found(
    falls: Callable[[FloatArray], FloatArray], shape: str, at: float
) -> None:
    v: FloatArray = np.concatenate((-np.linspace(0.1, 10.0, 30), np.linspace(0.1, 10.0, 30)))
    u = np.sign(v) * (0.5 + 0.8 * falls(np.abs(v) / 0.8)) + 0.1 * v
    noisy = u + 0.002 * np.random.default_rng(3).standard_normal(v.size)
    rows = Recording(np.arange(v.size, dtype=np.float64), {"v": v, "u": noisy}, "forms.csv", steady=True)
    (found,) = harness.diagnose(rows, engines=()).mechanisms
    assert found.name == "stribeck"
    assert found.parameters[shape].value == pytest.approx(at, abs=4.0 * (found.parameters[shape].stderr or 0.0))


@pytest.mark.parametrize("exponent", [0.5, 1.0, 2.0])
def test_the_form_of_a_law_is_found_beside_an_offset_of_the_force(exponent: float) -> None:
    falls = 0.6 * np.exp(-((SPEEDS / 0.3) ** exponent))
    found = harness.diagnose(both(1.0 + 0.4 * SPEEDS + falls, push=0.1), engines=())
    told = {m.name: m.parameters for m in found.mechanisms}
    assert told.keys() == {"stribeck", "constant-force"}
    offset = told["constant-force"]["force"]
    assert offset.value is not None
    assert offset.stderr is not None
    # what pushes against the resistance
    assert abs(offset.value + 0.1) < 3.0 * offset.stderr
    form = told["stribeck"].get("exponent")
    if form is not None:
        assert form.value is not None
        assert form.stderr is not None
        assert abs(form.value - exponent) < 3.0 * form.stderr
    else:
        assert exponent == 2.0


@pytest.mark.parametrize(
    ("saturates", "roundness"), [(np.tanh, 0.0), (lambda u: u / np.hypot(u, 1.0), 1.0)], ids=["tanh", "root"]
)
def test_damping_that_saturates_is_a_power_of_the_speed_in_another_form(
    saturates: Callable[[FloatArray], FloatArray], roundness: float
) -> None:
    v: FloatArray = np.concatenate((-np.linspace(0.1, 10.0, 30), np.linspace(0.1, 10.0, 30)))
    u = 0.5 * np.sign(v) + 2.0 * saturates(v / 2.0) + 0.002 * np.random.default_rng(3).standard_normal(v.size)
    rows = Recording(np.arange(v.size, dtype=np.float64), {"v": v, "u": u}, "forms.csv", steady=True)
    (found,) = harness.diagnose(rows, engines=()).mechanisms
    assert found.name == "power-law-damping"
    for name, truth in (("c_p", 2.0), ("v_0", 2.0), ("roundness", roundness)):
        one = found.parameters[name]
        assert one.value == pytest.approx(truth, abs=4.0 * (one.stderr or 0.0))


def test_a_curve_that_is_no_law_of_the_catalogue_gets_no_name_however_short_the_table() -> None:
    along = np.log(SPEEDS / SPEEDS[0]) / np.log(SPEEDS[-1] / SPEEDS[0])
    found = harness.diagnose(both(1.2 + 0.3 * SPEEDS + 0.2 * np.sin(7.0 * along)), engines=())
    assert found.verdict == "unexplained"
    assert not found.mechanisms
    assert found.posterior[0].names == ["unnamed-curve"]


def test_a_law_is_less_sure_where_a_smooth_curve_follows_it_as_well() -> None:
    def named(size: float) -> float:
        found = harness.diagnose(both(1.2 + 0.3 * SPEEDS + size * np.exp(-((SPEEDS / 0.15) ** 2))), engines=())
        return sum(one.probability for one in found.posterior if "stribeck" in one.names)

    assert named(0.03) < 0.97 < named(0.8)

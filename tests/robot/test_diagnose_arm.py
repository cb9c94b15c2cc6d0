"""A log of two joints: friction comes back and goes into the model; what does not go together is said."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from two_joint_arm import ARM, moved

import harness
from harness.app.report import rebuild
from harness.cli.main import run
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.results.diagnosis import DiagnosisResult
from harness.robot.whole_arm.whole import within_sample

F_K, C = (0.8, 0.3), (0.4, 0.1)
COLUMNS = "shoulder.position,shoulder.effort,elbow.position,elbow.effort"


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An arm and a log of 20 s at 250 Hz, torque by inverse dynamics with Coulomb and viscous friction, 1 % noise."""
    folder = tmp_path_factory.mktemp("arm")
    (folder / "arm.xml").write_text(ARM)
    t, q, _, torque = moved(5000, 250.0, F_K, C)
    torque += 0.01 * np.std(torque, axis=0) * np.random.default_rng(5).standard_normal(torque.shape)
    table = np.column_stack((t, q[:, 0], torque[:, 0], q[:, 1], torque[:, 1]))
    np.savetxt(folder / "log.csv", table, delimiter=",", header=f"t,{COLUMNS}", comments="")
    return folder


def test_friction_comes_back_and_goes_into_the_model(case: Path) -> None:
    out = case / "out"
    line = ["diagnose", str(case / "log.csv"), "--robot", str(case / "arm.xml"), "--joint", "elbow"]
    assert run([*line, "--out", str(out), "--json", str(case / "result.json"), "--quiet"]) == 0
    result = json.loads((case / "result.json").read_text())
    assert result["schema"] == "harness.diagnosis/2"
    assert result["robot"]["mode"] == "whole-arm"
    assert [joint["joint"] for joint in result["robot"]["arm"]["joints"]] == ["shoulder", "elbow"]
    for joint, f_k, c in zip(result["robot"]["arm"]["joints"], F_K, C, strict=True):
        assert joint["f_k"]["value"] == pytest.approx(f_k, abs=4.0 * joint["f_k"]["stderr"])
        assert joint["c"]["value"] == pytest.approx(c, abs=4.0 * joint["c"]["stderr"])
        assert joint["f_k"]["value"] == pytest.approx(f_k, rel=0.02)
    assert result["refined"]["parameters"]["f_k"]["value"] == pytest.approx(F_K[1], rel=0.02)
    assert result["verdict"] == "adequate"
    pasted = mujoco.MjModel.from_xml_path(result["files"]["robot_mjcf"])
    line = result["curve"]["line"]
    assert (pasted.dof_frictionloss[1], pasted.dof_damping[1]) == pytest.approx([p["value"] for p in line], rel=1e-9)
    assert [p["value"] for p in line] == pytest.approx((F_K[1], C[1]), rel=0.03)
    assert pasted.dof_frictionloss[0] == 0.0
    left = np.loadtxt(result["files"]["residual_torque"], delimiter=",", skiprows=1)
    assert left.shape[1] == 5
    assert Path(result["files"]["rrd"]).stat().st_size > 1000
    page = Path(result["files"]["report"]).read_text(encoding="utf-8")
    assert "Friction of every joint" in page
    assert result["robot"]["simulated"][0]["engine"] == "mujoco"
    for one in result["robot"]["simulated"]:
        assert one["after"]["x"] < 0.2 * one["before"]["x"]
    _, again = rebuild(Path(result["files"]["rrd"]), case / "again.html")
    assert again.read_text(encoding="utf-8") == page


def test_every_joint_is_told_where_none_is_named(case: Path) -> None:
    """One result, one page, one copy of the model with all of them; --joint all says the same."""
    line = ["diagnose", str(case / "log.csv"), "--robot", str(case / "arm.xml"), "--quiet"]
    assert run([*line, "--out", str(case / "every"), "--json", str(case / "every.json")]) == 0
    result = json.loads((case / "every.json").read_text())
    assert result["robot"]["joint"] == "all"
    # what is too weak to be seen has the rest
    assert result["posterior"][0]["names"] == []
    assert 0.7 < sum(one["probability"] for one in result["posterior"]) < 0.9
    none = result["posterior"][0]["probability"]
    assert f"No other effect is found in all of the arm (P {none:.2f})." in result["statement"]
    pasted = mujoco.MjModel.from_xml_path(result["files"]["robot_mjcf"])
    for i, joint in enumerate(JOINTS):
        told = {one["joint"]: one for one in result["robot"]["arm"]["joints"]}[joint]
        assert pasted.dof_frictionloss[i] == pytest.approx(told["curve"]["line"][0]["value"], rel=1e-9)
        assert result["refined"]["parameters"][f"{joint}.f_k"]["value"] == pytest.approx(F_K[i], rel=0.02)
        assert f"{joint}:" in result["statement"]
        assert f'name="{joint}"' in result["robot"]["paste"]["mjcf"]
    assert [one["joint"] for one in result["robot"]["simulated"]] == list(JOINTS)
    page = Path(result["files"]["report"]).read_text(encoding="utf-8")
    assert all(f"Friction of {joint} over its speed" in page for joint in JOINTS)
    _, again = rebuild(Path(result["files"]["rrd"]), case / "every.html")
    assert again.read_text(encoding="utf-8") == page
    assert harness.diagnose_joint(case / "log.csv", case / "arm.xml", "all").statement == result["statement"]


def test_joints_that_do_not_feel_one_another_are_all_told(tmp_path: Path) -> None:
    """Two upright axes of a machine: of neither the other's motion decides, and both were meant."""
    body = '<body><joint name="{}" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia=".5 .5 .5"/></body>'
    bodies = "".join(body.format(name) for name in ("left", "right"))
    (tmp_path / "axes.xml").write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    t = np.arange(3000) / 250.0
    columns, rng = [t], np.random.default_rng(2)
    for f_k, turn in ((0.8, 2.1), (0.3, 3.3)):
        v, a = 0.8 * turn * np.cos(turn * t), -0.8 * turn**2 * np.sin(turn * t)
        torque = 0.5 * a + f_k * np.sign(v) + 0.1 * v
        columns += [0.8 * np.sin(turn * t), torque + 0.01 * rng.standard_normal(t.size)]
    header = "t,left.position,left.effort,right.position,right.effort"
    np.savetxt(tmp_path / "log.csv", np.column_stack(columns), delimiter=",", header=header, comments="")
    found = harness.diagnose_joint(tmp_path / "log.csv", tmp_path / "axes.xml", "all")
    for joint, f_k in (("left", 0.8), ("right", 0.3)):
        assert found.refined.parameters[f"{joint}.f_k"].value == pytest.approx(f_k, rel=0.03)


def test_an_arm_of_which_anything_is_named_is_not_adequate(tmp_path: Path) -> None:
    """A torque of the elbow .3 % too large, beside noise that remembers: a small part of what the base leaves."""
    (tmp_path / "arm.xml").write_text(ARM)
    t, q, _, torque = moved(5000, 250.0, F_K, C)
    noise = 0.01 * np.std(torque, axis=0) * np.random.default_rng(5).standard_normal(torque.shape)
    torque[:, 1] *= 1.003
    torque += noise
    torque[1:] += 0.2 * noise[:-1]
    table = np.column_stack((t, q[:, 0], torque[:, 0], q[:, 1], torque[:, 1]))
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header=f"t,{COLUMNS}", comments="")
    found = harness.diagnose_joint(tmp_path / "log.csv", tmp_path / "arm.xml", "all")
    assert [(one.name, one.grade) for one in found.mechanisms] == [("motor-constant", "minor")]
    assert found.verdict == "missing_physics"
    assert "Missing: elbow: motor-constant (P" in found.statement


def test_the_library_says_what_the_command_says(case: Path) -> None:
    found = harness.diagnose_joint(case / "log.csv", case / "arm.xml", "shoulder")
    assert found.robot is not None
    assert found.robot.joint == "shoulder"
    assert found.files == {}
    f_k = found.refined.parameters["f_k"].value
    assert f_k == pytest.approx(F_K[0], rel=0.02)


@pytest.mark.parametrize(
    ("delay", "stderr", "held"),
    [(-0.002, 4e-5, True), (-0.0039, 4e-5, True), (0.002, 4e-5, True), (-0.006, 4e-5, False), (0.005, 1e-5, False)],
)
def test_what_lies_within_a_sample_is_no_delay(delay: float, stderr: float, held: bool) -> None:
    """At 250 Hz a hold acts 2 ms after its sample in the mean, and a bus hands on what is up to 4 ms old."""
    assert within_sample(Quantity(delay, stderr, "s"), 250.0) is held


@pytest.mark.parametrize("kind", ["without effort", "still"])
def test_a_joint_that_cannot_be_asked_is_refused_in_one_line(
    kind: str, case: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    rows, names = np.loadtxt(case / "log.csv", delimiter=",", skiprows=1), COLUMNS
    if kind == "still":
        rows[:, 3:] = (0.1, 0.5)
    else:
        rows, names = rows[:, :4], COLUMNS.removesuffix(",elbow.effort")
    path, out = case / f"{kind}.csv", case / kind
    np.savetxt(path, rows, delimiter=",", header=f"t,{names}", comments="")
    line = ["diagnose", str(path), "--robot", str(case / "arm.xml"), "--joint", "elbow", "--out", str(out)]
    assert run([*line, "--quiet"]) == 2
    said = capfd.readouterr().err
    assert said.count("\n") == 1
    assert "elbow" in said
    assert not out.exists()


JOINTS = ("shoulder", "elbow")
LEVELS = (0.8, 0.4)


@pytest.fixture(scope="module")
def motion() -> tuple[np.ndarray, ...]:
    """t, q, torque of 12 s at 125 Hz, with dry friction."""
    t, q, v, torque = moved(1500, 125.0, LEVELS, (0.1, 0.1))
    return t, q, torque + 0.02 * np.random.default_rng(5).standard_normal(v.shape)


def _written(folder: Path, t: np.ndarray, q: np.ndarray, torque: np.ndarray) -> Path:
    (folder / "arm.xml").write_text(ARM)
    names = [f"{joint}.{kind}" for kind in ("position", "effort") for joint in JOINTS]
    rows = np.column_stack((t, q, torque))
    np.savetxt(folder / "log.csv", rows, delimiter=",", header=",".join(["t", *names]), comments="")
    return folder / "log.csv"


@pytest.mark.parametrize(("rate", "counts"), [(300.0, 2**12), (125.0, 2**14)])
def test_what_an_encoder_leaves_of_a_torque_is_noise_as_well(rate: float, counts: int, tmp_path: Path) -> None:
    """Torque as good as exact, positions in steps: what is left is what inertias make of those."""
    t, q, _, torque = moved(int(12.0 * rate), rate, F_K, C)
    torque += 2e-4 * np.std(torque, axis=0) * np.random.default_rng(5).standard_normal(torque.shape)
    step = 2.0 * np.pi / counts
    log = _written(tmp_path, t, np.round(q / step) * step, torque)
    found = harness.diagnose_joint(log, tmp_path / "arm.xml", "all", engines=())
    assert (found.verdict, found.mechanisms) == ("adequate", [])
    assert found.robot is not None
    assert found.robot.arm is not None
    assert all(0.5 < (one.over_noise or 0.0) < 1.3 for one in found.robot.arm.joints)


def test_the_steps_of_a_torque_are_noise_as_well(tmp_path: Path) -> None:
    """A current in whole counts: its error lasts as long as the torque stays on one level."""
    t, q, _, torque = moved(3000, 250.0, F_K, C)
    found = harness.diagnose_joint(
        _written(tmp_path, t, q, np.round(torque / 0.1) * 0.1), tmp_path / "arm.xml", "all", engines=()
    )
    assert (found.verdict, found.mechanisms) == ("adequate", [])
    assert found.robot is not None
    assert found.robot.arm is not None
    assert all((one.over_noise or 2.0) < 1.5 for one in found.robot.arm.joints)


Change = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
CHANGES: dict[str, tuple[Change, str]] = {
    "signs": (lambda q, u: (q, -u), "--gain -1"),
    "millis": (lambda q, u: (q, 1e3 * u), "--gain 0.001"),
    "feet": (lambda q, u: (q, 0.7375621 * u), "--gain 1.355818"),
    "swapped": (lambda q, u: (q[:, ::-1], u[:, ::-1]), "--names shoulder=elbow,elbow=shoulder"),
    "one sign": (lambda q, u: (q, u * (-1, 1)), "--gain shoulder=-1"),
    "turned": (lambda q, u: (q * (1, -1), u * (1, -1)), "--flip elbow"),
    "zero": (lambda q, u: (q - (0, np.pi / 2), u), "--offset elbow=1.5708"),
    "degrees": (lambda q, u: (np.degrees(q), u), "--angle-unit deg"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_a_mismatch_is_said_with_what_mends_it(change: str, motion: tuple[np.ndarray, ...], tmp_path: Path) -> None:
    t, q, torque = motion
    make, option = CHANGES[change]
    log = _written(tmp_path, t, *make(q, torque))
    found = harness.diagnose_joint(log, tmp_path / "arm.xml", "elbow", engines=())
    assert found.verdict == "unexplained"
    assert not found.mechanisms
    assert found.statement.endswith(f"Try: {option}")
    assert found.robot is not None
    assert not found.robot.paste.mjcf
    assert any(option == one.option and one.suspicion for one in found.robot.match)


@pytest.mark.parametrize("g", [(9.81, 0.0, 0.0), (-4.905, 0.0, 8.4957)])
def test_a_base_that_stands_otherwise_is_told_by_the_torques(
    g: tuple[float, float, float], tmp_path: Path, motion: tuple[np.ndarray, ...]
) -> None:
    """On a wall, and nearly upside down; of an arm that moves in a plane another zero of its first joint does alike."""
    t, q, torque = motion
    (tmp_path / "arm.xml").write_text(ARM)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    data, turned = mujoco.MjData(model), np.empty_like(torque)
    for i, place in enumerate(q):
        both = []
        for gravity in (g, (0.0, 0.0, -9.81)):
            model.opt.gravity[:], data.qpos[:] = gravity, place
            mujoco.mj_forward(model, data)
            both.append(np.array(data.qfrc_bias))
        turned[i] = torque[i] + both[0] - both[1]
    found = harness.diagnose_joint(_written(tmp_path, t, q, turned), tmp_path / "arm.xml", "elbow", engines=())
    said = re.search(r"--gravity (\S+) (\S+) ([^\s):]+)", found.statement)
    assert said is not None
    x, y, z = map(float, said.groups())
    assert (x, y, z) == pytest.approx(g, abs=0.1)
    mended = harness.diagnose_joint(tmp_path / "log.csv", tmp_path / "arm.xml", "elbow", gravity=(x, y, z), engines=())
    assert mended.baseline.parameters["f_k"].value == pytest.approx(LEVELS[1], rel=0.05)


def test_the_option_mends_it_and_amperes_are_told_by_joint(motion: tuple[np.ndarray, ...], tmp_path: Path) -> None:
    t, q, torque = motion
    log = _written(tmp_path, t, q, torque / (11.0, 4.0))
    model = tmp_path / "arm.xml"
    found = harness.diagnose_joint(log, model, "elbow", engines=())
    assert "current in A" in found.statement
    option = found.statement.partition("Try: ")[2].split()
    gains = {name: float(gain) for name, _, gain in (one.partition("=") for one in option[1].split(","))}
    assert gains == {"shoulder": pytest.approx(11.0, rel=0.02), "elbow": pytest.approx(4.0, rel=0.02)}
    line = ["diagnose", str(log), "--robot", str(model), "--joint", "elbow", "--quiet", *option]
    assert run([*line, "--out", str(tmp_path / "out"), "--json", str(tmp_path / "result.json")]) == 0
    mended = DiagnosisResult.model_validate_json((tmp_path / "result.json").read_text())
    assert mended.baseline.parameters["f_k"].value == pytest.approx(LEVELS[1], rel=0.05)
    assert mended.robot is not None
    for one in mended.robot.match:
        assert one.correlation == pytest.approx(1.0, abs=0.01)
        assert not one.suspicion


def test_currents_alone_are_asked_for_their_gains_which_the_model_tells(
    motion: tuple[np.ndarray, ...], tmp_path: Path
) -> None:
    t, q, torque = motion
    log = _written(tmp_path, t, q, torque / (11.0, 4.0))
    log.write_text(log.read_text().replace(".effort", ".current"))
    said = harness.diagnose_joint(log, tmp_path / "arm.xml", engines=()).statement
    gains = dict(one.split("=") for one in said.partition("Try: --gain ")[2].split(","))
    assert {name: float(gain) for name, gain in gains.items()} == {
        "shoulder": pytest.approx(11.0, rel=0.02),
        "elbow": pytest.approx(4.0, rel=0.02),
    }
    for part in ("current", "unknown"):
        if part == "unknown":
            log.write_text(log.read_text().replace(".current", ".other"))
        else:
            _written(tmp_path, t, q, torque)
            log.write_text(log.read_text().replace(".effort", ".current"))
        with pytest.raises(InputError, match="currents, and no efforts" if part == "current" else "no joint's effort"):
            harness.diagnose_joint(log, tmp_path / "arm.xml", engines=())


def test_rotors_that_no_model_has_leave_nothing_unexplained(motion: tuple[np.ndarray, ...], tmp_path: Path) -> None:
    """Of an inertia that the nuisance of masses takes up as well, little is left to be explained by its name."""
    t, q, v, torque = moved(3000, 250.0, LEVELS, (0.1, 0.1))
    a = np.gradient(np.gradient(q, t, axis=0), t, axis=0)
    noise = 0.02 * np.random.default_rng(5).standard_normal(v.shape)
    log = _written(tmp_path, t, q, torque + (0.15, 0.06) * a + noise)
    found = harness.diagnose_joint(log, tmp_path / "arm.xml", "all", engines=())
    assert found.verdict != "unexplained"
    rotors = {one.name for one in found.mechanisms}
    assert rotors == {"armature-error"}


def _thousandfold(found: re.Match[str]) -> str:
    return f'{found[1]}{" ".join(str(1e3 * float(x)) for x in found[2].split())}"'


@pytest.mark.parametrize("what", ["lengths in mm", "masses in g"])
def test_a_model_in_thousandths_is_no_current(what: str, motion: tuple[np.ndarray, ...], tmp_path: Path) -> None:
    t, q, torque = motion
    log = _written(tmp_path, t, q, torque)
    scaled = {"lengths in mm": r'((?:pos|fromto)=")([^"]*)"', "masses in g": r'(mass=")([^"]*)"'}[what]
    (tmp_path / "arm.xml").write_text(re.sub(scaled, _thousandfold, ARM))
    found = harness.diagnose_joint(log, tmp_path / "arm.xml", "elbow", engines=())
    assert "lengths are in mm, or its masses in g" in found.statement
    assert "--gain" not in found.statement


STRANGE: dict[str, Change] = {
    "another robot": (lambda q, u: (q, np.roll(u, 600, axis=0))),
    "no torque of an arm": (lambda q, u: (q, 40.0 * np.sin(np.arange(u.size) / 11.0).reshape(u.shape))),
}


@pytest.mark.parametrize("change", STRANGE)
def test_a_torque_that_nothing_explains_is_refused_without_an_option(
    change: str, motion: tuple[np.ndarray, ...], tmp_path: Path
) -> None:
    t, q, torque = motion
    log = _written(tmp_path, t, *STRANGE[change](q, torque))
    found = harness.diagnose_joint(log, tmp_path / "arm.xml", "elbow", engines=())
    assert not found.mechanisms
    assert "does not follow the model's" in found.statement
    assert "Try" not in found.statement


def test_a_torque_that_chatters_between_samples_says_nothing_against_its_model(
    motion: tuple[np.ndarray, ...], tmp_path: Path
) -> None:
    """What a controller does between samples is as large in them, and moves a joint by its mean alone."""
    t, q, torque = motion
    chatter = 30.0 * np.std(torque, axis=0) * np.random.default_rng(2).standard_normal(torque.shape)
    found = harness.diagnose_joint(
        _written(tmp_path, t, q, torque + chatter), tmp_path / "arm.xml", "elbow", engines=()
    )
    assert "its mean is not logged" in found.statement
    assert "another model" not in found.statement

"""Model files: numbers from a slider or a model, as MJCF and URDF, alone in the engines, and what they leave out."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
from lxml import etree

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, StoreError
from harness.core.slider import PAPER, Slider
from harness.engines import model_files, models
from harness.engines.joint_words import GRAVITY, coefficient
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import TERMS

ODD = Slider(2.4213579246, 4.7912345678, 2310.9876543, 0.35123456789, 0.5)


def boxes(file: Path) -> dict[str, tuple[float, ...]]:
    """Full sizes of the boxes of a model by material or name."""
    tree = etree.parse(str(file))
    if file.suffix == ".urdf":
        found = {}
        for visual in tree.iter("visual"):
            box = visual.find("geometry/box")
            if box is not None:
                found[visual.find("material").get("name")] = tuple(map(float, box.get("size").split()))
        return found
    return {
        geom.get("material"): tuple(2.0 * float(half) for half in geom.get("size").split())
        for geom in tree.iter("geom")
        if geom.get("type") == "box"
    }


def test_one_geometry_in_all_four_files() -> None:
    files = [models.path(name, suffix) for name in models.NAMES for suffix in ("xml", "urdf")]
    first = boxes(files[0])
    assert set(first) >= {"slider", "frame", "mark"}
    for file in files[1:]:
        other = boxes(file)
        assert set(other) == set(first)
        for material, size in first.items():
            if material != "mark":
                assert other[material] == pytest.approx(size), (file, material)


def test_numbers_of_a_slider_reach_the_urdf_exactly() -> None:
    tree = models.urdf(ODD)
    assert float(tree.find("link[@name='slider']/inertial/mass").get("value")) == ODD.m
    dynamics = tree.find("joint[@name='slide']/dynamics")
    assert float(dynamics.get("damping")) == ODD.c
    assert float(dynamics.get("friction")) == ODD.f_k


def test_exported_files_are_read_again_with_the_same_numbers(tmp_path: Path) -> None:
    written = models.export(ODD, tmp_path / "model")
    assert sorted(written) == ["slider.urdf", "slider.xml", "slider_on_floor.urdf", "slider_on_floor.xml"]
    assert sorted(file.name for file in (tmp_path / "model").iterdir()) == sorted(written)
    model = mujoco.MjModel.from_xml_path(str(written["slider.xml"]))
    assert model.jnt_stiffness[0] == ODD.k
    assert model.dof_damping[0] == ODD.c
    assert model.dof_frictionloss[0] == ODD.f_k
    assert model.body("slider").mass[0] == pytest.approx(ODD.m, rel=1e-15)
    data = mujoco.MjData(model)
    data.qpos[0] = 1.0
    mujoco.mj_forward(model, data)
    assert data.qacc[0] == pytest.approx(-(ODD.k - ODD.f_k) / ODD.m, rel=1e-6)
    floor = mujoco.MjModel.from_xml_path(str(written["slider_on_floor.xml"]))
    assert floor.geom("floor").friction[0] == pytest.approx(coefficient(ODD), rel=1e-15)


def test_a_format_says_what_it_leaves_out() -> None:
    said = models.cannot_say(ODD, "slider_on_floor", "urdf")
    assert any("no spring (k = 2310.99 N/m)" in line for line in said)
    assert any("no coefficient of friction" in line for line in said)
    assert any("no break-away force" in line for line in said)
    assert models.cannot_say(PAPER, "slider", "xml") == ()


def test_models_are_found_inside_an_installed_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "site" / "harness"
    (package / "engines").mkdir(parents=True)
    monkeypatch.setattr(models, "__file__", str(package / "engines" / "models.py"))
    with pytest.raises(StoreError, match="models: not found"):
        models.folder()
    (package / "_models").mkdir()
    (package / "_models" / "slider.xml").write_bytes(b"")
    assert models.folder() == package / "_models"


BASE = Model(2.0, 1.5, 100.0, 3.0, x0=0.8)

IN_MJCF = [
    ModelTerm(term, term.example) for term in TERMS if term.elements is not None and term.elements(term.example, BASE.k)
]


def compiled(model: Model) -> mujoco.MjModel:
    read = mujoco.MjModel.from_xml_string(model_files.mjcf(model).decode())
    read.dof_frictionloss[:] = 0.0
    return read


@pytest.mark.parametrize("entry", IN_MJCF, ids=lambda entry: entry.term.key)
def test_a_term_with_native_words_accelerates_as_in_the_reference(entry: ModelTerm) -> None:
    model = BASE.with_terms(entry)
    read = compiled(model)
    data = mujoco.MjData(read)
    for x, v in [(0.6, 0.0), (-0.7, 1.2), (0.03, -0.4), (0.45, 2.0)]:
        smooth = Model(2.0, 1.5, 100.0, 0.0, x0=x, v0=v, terms=model.terms)
        data.qpos[0], data.qvel[0] = x, v
        mujoco.mj_forward(read, data)
        exact = simulate(smooth, np.array([0.0, 1e-3])).a[0]
        assert data.qacc[0] == pytest.approx(exact, rel=1e-9, abs=1e-9)
    assert not [line for line in model_files.cannot_say(model, "xml") if entry.term.name in line]
    assert [line for line in model_files.cannot_say(model, "urdf") if entry.term.name in line]


def test_what_no_format_can_say_is_listed() -> None:
    model = BASE.with_terms(
        ModelTerm.named("presliding", sigma0=3000.0, sigma1=5.0), ModelTerm.named("sensor-bias", bias=0.5)
    )
    said = model_files.cannot_say(model, "xml")
    assert "xml: no presliding (sigma0 = 3000, sigma1 = 5)" in said
    assert "xml: no sensor that shows sensor-bias (bias = 0.5)" in said
    assert "xml: no release (x0 = 0.8 m, v0 = 0 m/s)" in said
    # the bristle is the friction; the joint's own would come on top
    joint = etree.fromstring(model_files.mjcf(model)).find(".//joint[@name='slide']")
    assert joint.get("frictionloss") == "0"
    pendulum = Model(1.0, 1.0, 100.0, 0.1, restoring=Restoring.PENDULUM)
    # gravity about a hinge says k sin x
    assert model_files.cannot_say(pendulum, "xml") == ("xml: no release (x0 = 0 rad, v0 = 0 rad/s)",)


def test_files_are_written_whole_with_the_list_beside_them(tmp_path: Path) -> None:
    model = BASE.with_terms(ModelTerm.named("stribeck", f_s=5.0, v_s=0.5))
    written = model_files.export(model, tmp_path / "model")
    assert sorted(file.name for file in (tmp_path / "model").iterdir()) == sorted(written)
    assert "urdf: no spring (k = 100 N/m)" in written["not_said.txt"].read_text()
    mass = etree.parse(str(written["slider.urdf"])).find("link[@name='slider']/inertial/mass")
    assert float(mass.get("value")) == 2.0
    free = Model(1.0, 1.0, 0.0, 3.0, restoring=Restoring.NONE, v0=1.0)
    assert compiled(free).jnt_stiffness[0] == 0.0


def test_bad_formats_and_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="model format: 'sdf'; expected one of xml, urdf"):
        model_files.cannot_say(BASE, "sdf")
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="cannot write the models"):
        model_files.export(BASE, tmp_path / "file" / "model")


SWING = Model(0.02, 0.004, 0.9, 0.008, restoring=Restoring.PENDULUM, x0=1.3)
TORSION = Model(0.02, 0.004, 0.9, 0.008, x0=1.3)
SPAN, STEP = 2.0, 2e-4


def in_mujoco(file: Path, x0: float) -> FloatArray:
    """The angle (n,) at every step of the file alone."""
    model = mujoco.MjModel.from_xml_path(str(file))
    model.opt.timestep, model.opt.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.dof_solref[:] = (2.0 * STEP, 1.0)
    data = mujoco.MjData(model)
    data.qpos[0] = x0
    shown = [x0]
    for _ in range(round(SPAN / STEP)):
        mujoco.mj_step(model, data)
        shown.append(float(data.qpos[0]))
    return np.array(shown)


def in_pybullet(file: Path, x0: float) -> FloatArray:
    """As a user of PyBullet loads it: gravity set, friction held by the motor, no damping of the world's."""
    pybullet = pytest.importorskip("pybullet")
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setGravity(0, 0, -GRAVITY, physicsClientId=client)
        pybullet.setTimeStep(STEP, physicsClientId=client)
        body = pybullet.loadURDF(str(file), useFixedBase=True, physicsClientId=client)
        for link in (-1, 0):
            pybullet.changeDynamics(body, link, linearDamping=0, angularDamping=0, physicsClientId=client)
        friction = pybullet.getJointInfo(body, 0, physicsClientId=client)[7]
        pybullet.setJointMotorControl2(
            body, 0, pybullet.VELOCITY_CONTROL, targetVelocity=0.0, force=friction, physicsClientId=client
        )
        pybullet.resetJointState(body, 0, x0, physicsClientId=client)
        shown = [x0]
        for _ in range(round(SPAN / STEP)):
            pybullet.stepSimulation(physicsClientId=client)
            shown.append(pybullet.getJointState(body, 0, physicsClientId=client)[0])
        return np.array(shown)
    finally:
        pybullet.disconnect(client)


def exact(model: Model) -> FloatArray:
    return simulate(model, np.linspace(0.0, SPAN, round(SPAN / STEP) + 1)).x


@pytest.mark.parametrize(
    "model",
    [SWING, TORSION, TORSION.with_terms(ModelTerm.named("cubic-stiffness", k3=0.3))],
    ids=["pendulum", "torsion", "hardening"],
)
def test_the_file_alone_moves_in_mujoco_as_the_model(model: Model, tmp_path: Path) -> None:
    files = model_files.export(model, tmp_path, angular=True)
    assert np.abs(in_mujoco(files["pendulum.xml"], model.x0) - exact(model)).max() < 5e-3 * model.x0


def test_the_file_alone_moves_in_pybullet_as_the_model(tmp_path: Path) -> None:
    files = model_files.export(SWING, tmp_path)
    assert np.abs(in_pybullet(files["pendulum.urdf"], SWING.x0) - exact(SWING)).max() < 5e-3 * SWING.x0


def test_what_runs_down_is_no_pendulum_by_its_file(tmp_path: Path) -> None:
    files = model_files.export(Model(0.2, 0.01, 0.0, 0.05, v0=40.0, restoring=Restoring.NONE), tmp_path, angular=True)
    assert {"rotor.xml", "rotor.urdf"} <= files.keys()


def test_what_a_hinge_cannot_say_is_said_in_radians() -> None:
    said = model_files.cannot_say(SWING, "urdf")
    assert "urdf: gravity is the reader's to set, 9.81 m/s^2 along -z" in said
    assert "urdf: no release (x0 = 1.3 rad, v0 = 0 rad/s)" in said
    assert not [line for line in model_files.cannot_say(SWING, "xml") if "sin" in line or "spring" in line]
    assert "urdf: no torsion spring (k = 0.9 N m/rad), and gravity is to be none" in model_files.cannot_say(
        TORSION, "urdf", angular=True
    )

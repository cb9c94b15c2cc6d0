"""The model files: one geometry in all, numbers from a Slider, found from a checkout and from a wheel."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
from lxml import etree

from harness.core.errors import InputError, StoreError
from harness.core.slider import PAPER, Slider
from harness.engines import models
from harness.engines.joint_words import coefficient

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


@pytest.mark.parametrize("name", models.NAMES)
def test_spring_rail_light_and_camera_are_there(name: str) -> None:
    spec = models.mjcf(PAPER, name)
    assert spec.tendon("spring") is not None
    assert spec.geom("rail_left") is not None
    assert len(spec.lights) >= 1
    assert len(spec.cameras) >= 1
    drawn = [material.get("name") for material in models.urdf(PAPER, name).iter("material")]
    assert drawn.count("spring") > 5
    assert drawn.count("steel") >= 2


def test_numbers_of_a_slider_reach_the_compiled_model_exactly() -> None:
    model = models.mjcf(ODD).compile()
    assert model.jnt_stiffness[0] == ODD.k
    assert model.dof_damping[0] == ODD.c
    assert model.dof_frictionloss[0] == ODD.f_k
    assert model.body("slider").mass[0] == pytest.approx(ODD.m, rel=1e-15)
    floor = models.mjcf(ODD, "slider_on_floor").compile()
    assert floor.geom("box").friction[0] == pytest.approx(ODD.f_k / (ODD.m * 9.81), rel=1e-15)


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


def test_unknown_names_and_unwritable_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="model: 'cart'; one of slider, slider_on_floor, pendulum is accepted"):
        models.path("cart", "xml")
    with pytest.raises(InputError, match="model format: 'sdf'; one of xml, urdf is accepted"):
        models.path("slider", "sdf")
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="cannot write the models"):
        models.export(PAPER, tmp_path / "file" / "model")


def test_models_are_found_inside_an_installed_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "site" / "harness"
    (package / "engines").mkdir(parents=True)
    monkeypatch.setattr(models, "__file__", str(package / "engines" / "models.py"))
    with pytest.raises(StoreError, match="models: not found"):
        models.folder()
    (package / "_models").mkdir()
    (package / "_models" / "slider.xml").write_bytes(b"")
    assert models.folder() == package / "_models"


def test_pictures_of_the_models_differ_where_the_slider_is() -> None:
    """The spring is drawn from the anchor to the slider wherever that is."""
    model = models.mjcf(PAPER).compile()
    data = mujoco.MjData(model)
    lengths = []
    for x in (-1.0, 0.0, 1.0):
        data.qpos[0] = x
        mujoco.mj_kinematics(model, data)
        mujoco.mj_tendon(model, data)
        lengths.append(float(data.ten_length[0]))
    assert np.diff(lengths) == pytest.approx([1.0, 1.0])

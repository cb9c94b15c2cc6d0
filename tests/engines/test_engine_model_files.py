"""Models as MJCF and URDF: what the files say is what the laws are, and what they leave out is said."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
from lxml import etree

from harness.core.errors import InputError, StoreError
from harness.engines import model_files
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import TERMS

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


def test_several_terms_share_a_joint() -> None:
    model = BASE.with_terms(ModelTerm.named("cubic-stiffness", k3=-40.0), ModelTerm.named("backlash", gap=0.05))
    read = compiled(model)
    assert read.jnt_stiffness[0] == 0.0
    data = mujoco.MjData(read)
    data.qpos[0] = 0.5
    mujoco.mj_forward(read, data)
    assert -data.qfrc_passive[0] == pytest.approx(100.0 * 0.45 - 40.0 * 0.5**3)


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
    with pytest.raises(InputError, match="model format: 'sdf'; one of xml, urdf is accepted"):
        model_files.cannot_say(BASE, "sdf")
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="cannot write the models"):
        model_files.export(BASE, tmp_path / "file" / "model")

"""Settings for one joint of a robot: better than the file's own, and text that goes into the file."""

from pathlib import Path

import mujoco
import pytest
from lxml import etree

from harness.app.sweep.tune import TuneJoint, tune_joint
from harness.core.errors import InputError
from harness.engines.models import folder
from harness.fidelity import tune as room
from harness.robot.own_model import loosened

FILE = folder() / "arm" / "arm.xml"


@pytest.mark.full
def test_it_beats_the_file_in_poses_that_were_not_searched_in(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "STARTS", 1)
    result = tune_joint("mujoco", TuneJoint(FILE, "elbow"))
    assert result.dt_s == 0.002
    assert result.score_after < 0.05 * result.score_before
    assert result.robot is not None
    assert result.robot.joint == "elbow"
    assert len(result.robot.inertia) == len(result.sliders["searched_on"] + result.sliders["scored_on"])
    root = etree.fromstring(f"<all>{result.paste}</all>")
    option, joint = root.find("option"), root.find("joint")
    assert joint.get("name") == "elbow"
    tree = etree.fromstring(FILE.read_bytes())
    own = next(one for one in tree.iter("joint") if one.get("name") == "elbow")
    own.attrib.update(joint.attrib)
    tree.find("option").attrib.update(option.attrib)
    pasted = mujoco.MjModel.from_xml_string(etree.tostring(tree).decode())
    assert tuple(pasted.dof_solref[2]) == pytest.approx(result.settings["solreffriction"])


@pytest.mark.parametrize("by", [0.5, 1.0, 2.0])
def test_a_softer_impedance_has_that_much_more_regularisation(by: float) -> None:
    d = 0.9
    found = loosened({"solimpfriction": (d, 0.95, 0.001, 0.5, 2.0), "solver": "CG"}, by)
    soft, *others = found["solimpfriction"]
    assert (1.0 - soft) / soft == pytest.approx(by * (1.0 - d) / d)
    assert others == [0.95, 0.001, 0.5, 2.0]
    assert found["solver"] == "CG"


def test_a_joint_without_dry_friction_is_refused_in_one_line(tmp_path: Path) -> None:
    file = tmp_path / "arm.xml"
    file.write_text(FILE.read_text().replace('frictionloss="0.3"', ""))
    with pytest.raises(InputError, match="no dry friction"):
        tune_joint("mujoco", TuneJoint(file, "elbow"))

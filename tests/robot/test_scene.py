"""A body of the user's own scene: what of its motion dry friction would not do, and the options that mend it."""

import json
import math
import shutil
import subprocess
from pathlib import Path

import jsonschema
import mujoco
import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import harness
from harness.app.report import rebuild
from harness.core.errors import InputError
from harness.results import generate

GRAVITY = 9.81


def slope(option: str = "", load: float = 0.5, mu: float = 0.5, condim: int = 3, shape: str = "") -> str:
    """A body on a level floor; gravity is tilted so that it asks for ``load`` of its friction."""
    geom = shape or 'type="box" size=".1 .1 .05" mass="1"'
    return f"""<mujoco>
  <option {option} gravity="{load * mu * GRAVITY!r} 0 -{GRAVITY}"/>
  <worldbody>
    <geom name="floor" type="plane" size="50 50 1" condim="{condim}" friction="{mu} .005 .0001"/>
    <body name="block" pos="0 0 .05"><freejoint/><geom {geom} condim="{condim}" friction="{mu} .005 .0001"/></body>
  </worldbody>
</mujoco>
"""


def ball(option: str = "", mu_r: float = 0.002, radius: float = 0.05, speed: float = 1.0) -> str:
    """A ball that rolls; mu_r in m."""
    geom = f'type="sphere" size="{radius}" mass="1" condim="6" friction="1 .005 {mu_r}"'
    return f"""<mujoco>
  <option {option}/>
  <worldbody>
    <geom type="plane" size="50 50 1" condim="6" friction="1 .005 {mu_r}"/>
    <body name="ball" pos="0 0 {radius}"><freejoint/><geom {geom}/></body>
  </worldbody>
  <keyframe><key name="rolling" qpos="0 0 {radius} 1 0 0 0" qvel="{speed} 0 0 0 {speed / radius} 0"/></keyframe>
</mujoco>
"""


def pinch(option: str = "", force: float = 10.0, shape: str = "box", mu: float = 1.0, contact: str = "") -> str:
    """Two fingers that press a body of 0.2 kg between them, each with ``force`` N."""
    size = {"box": ".02 .02 .02", "cylinder": ".02 .02", "sphere": ".02"}[shape]
    return f"""<mujoco>
  <option {option}/>
  <default><geom friction="{mu} .005 .0001"/></default>
  <worldbody>
    <body name="left" pos="-.03 0 .2">
      <joint name="l" type="slide" axis="1 0 0" damping="5"/>
      <geom name="left" type="box" size=".01 .02 .02" mass=".1"/>
    </body>
    <body name="right" pos=".03 0 .2">
      <joint name="r" type="slide" axis="-1 0 0" damping="5"/>
      <geom name="right" type="box" size=".01 .02 .02" mass=".1"/>
    </body>
    <body name="held" pos="0 0 .2"><freejoint/><geom name="held" type="{shape}" size="{size}" mass=".2"/></body>
  </worldbody>
  {contact}
  <actuator><motor joint="l"/><motor joint="r"/></actuator>
  <keyframe><key name="grip" qpos="0 0 0 0 .2 1 0 0 0" ctrl="{force} {force}"/></keyframe>
</mujoco>
"""


def written(folder: Path, text: str, name: str = "scene.xml") -> Path:
    """A file with this text."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def creep_of(path: Path, body: str, seconds: float = 2.0) -> float:
    """Mean speed of a body over the later half, m/s, by mj_step of the file itself."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    places, steps = [], round(seconds / model.opt.timestep)
    for _ in range(steps + 1):
        mujoco.mj_step(model, data)
        places.append(data.body(body).xipos.copy())
    half = steps // 2
    return float(np.linalg.norm(places[-1] - places[half]) / ((steps - half) * model.opt.timestep))


RESTS = 1e-5
"""m/s."""
ELLIPTIC = 'cone="elliptic"'
FINGER = '<worldbody><body name="finger" mocap="true" pos="9 9 9"><geom size=".1"/></body>'
MESH = '<asset><mesh name="m" file="no.stl"/></asset><worldbody>'


@pytest.mark.parametrize(
    ("option", "condim", "creep"),
    [
        # on a pyramid creep grows with condim, on an elliptic cone it falls as 1/impratio
        ("", 3, 859.2),
        ("", 6, 1416.0),
        (ELLIPTIC, 3, 638.7),
        pytest.param(f'{ELLIPTIC} impratio="10"', 4, 63.87, marks=pytest.mark.full),  # test_bodies has it as well
    ],
)
def test_a_block_on_a_slope_creeps_as_its_options_have_it(
    tmp_path: Path, option: str, condim: int, creep: float
) -> None:
    """um/s at half of the friction there is, a box of 1 kg, mu 0.5, steps of 2 ms; measured by mj_step of the file."""
    found = harness.run_scene(written(tmp_path, slope(option, condim=condim)), "block", duration=0.6)
    assert found.creep_m_s * 1e6 == pytest.approx(creep, rel=1e-3)
    assert found.moved == ["slide"]
    assert found.expected.rests
    assert found.expected.cone_use == pytest.approx(0.5, abs=1e-3)
    assert found.changed is not None
    assert found.changed.mends
    assert found.changed.creep_m_s < RESTS


@pytest.mark.parametrize("shape", ["box", pytest.param("sphere", marks=pytest.mark.full)])
def test_a_pinch_grip_holds_with_what_is_to_be_pasted(tmp_path: Path, shape: str) -> None:
    """The changed file is stepped here, by mj_step, and the diff of the two is what was printed."""
    file = written(tmp_path, pinch(shape=shape))
    found = harness.run_scene(file, "held", duration=0.6, out=tmp_path / "out")
    assert found.creep_m_s == pytest.approx(creep_of(file, "held", 0.6), rel=0.02)
    assert found.moved[0] == "slide"
    assert found.proved
    changed = Path(found.files["mjcf"])
    assert creep_of(changed, "held", 0.6) < RESTS
    added = [line[1:] for line in found.change.splitlines() if line.startswith("+") and not line.startswith("+++")]
    assert all(line in changed.read_text(encoding="utf-8").splitlines() for line in added)
    assert harness.run_scene(changed, "held", duration=0.6).moved == []


def test_a_solver_that_is_cut_off_is_given_its_iterations(tmp_path: Path) -> None:
    """An elliptic cone of ratio 10 lets go with one iteration and four steps of its line search; with more it holds."""
    file = written(tmp_path, pinch(f'{ELLIPTIC} impratio="1000" iterations="1" ls_iterations="4"', shape="cylinder"))
    found = harness.run_scene(file, "held", duration=0.6)
    assert found.moved
    assert found.changed is not None
    assert found.changed.mends
    assert set(found.changed.options) <= {"iterations", "ls_iterations"}


def test_noslip_beside_a_ratio_on_a_pyramid_is_worse_than_the_ratio_alone(tmp_path: Path) -> None:
    """86 um/s without it."""
    file = written(tmp_path, slope('impratio="10" noslip_iterations="10"'))
    found = harness.run_scene(file, duration=0.6)
    assert found.creep_m_s > 4.0 * 86e-6
    assert found.changed is not None
    assert found.changed.mends


def test_noslip_is_said_to_be_worse_where_it_is(tmp_path: Path) -> None:
    """On a pyramid and near the limit of the grip; on an elliptic cone it helps."""
    found = harness.run_scene(written(tmp_path, pinch(force=1.0)), "held", duration=1.0)
    noslip = {one.options.get("cone", "pyramidal"): one for one in found.tried if "noslip_iterations" in one.options}
    assert noslip["pyramidal"].creep_m_s > found.creep_m_s
    assert not noslip["pyramidal"].mends
    assert noslip["elliptic"].creep_m_s < RESTS
    assert found.changed is not None
    assert found.changed.options == {"cone": "elliptic", "noslip_iterations": 10}


def test_a_ball_slows_down_as_its_rolling_friction_has_it(tmp_path: Path) -> None:
    """mu_r g/(1.4 r); a pyramid takes too little, and an elliptic cone mends it."""
    exact = 0.002 * 9.81 / (1.4 * 0.05)
    right = harness.run_scene(written(tmp_path, ball(ELLIPTIC)))
    assert right.deceleration_m_s2 == pytest.approx(exact, rel=1e-3)
    assert right.moved == []
    assert right.start == "rolling"
    wrong = harness.run_scene(written(tmp_path, ball(), "pyramid.xml"))
    assert wrong.deceleration_m_s2 is not None
    assert wrong.deceleration_m_s2 < 0.9 * exact
    assert wrong.moved == ["motion"]
    assert wrong.expected.deceleration_m_s2 == pytest.approx(exact, rel=1e-3)
    assert wrong.changed is not None
    assert wrong.changed.options == {"cone": "elliptic"}


@settings(max_examples=3, deadline=None, derandomize=True, phases=[Phase.generate])
@given(
    load=st.one_of(st.floats(0.1, 0.9), st.floats(1.15, 1.6)),
    mu=st.floats(0.2, 0.5),
    half=st.floats(0.05, 0.2),
    mass=st.floats(0.1, 10.0),
)
def test_what_friction_holds_is_told_from_what_it_does_not(
    tmp_path_factory: pytest.TempPathFactory, load: float, mu: float, half: float, mass: float
) -> None:
    """At random coefficients, sizes and masses; low, so that no block tips."""
    shape = f'type="box" size="{half} {half} {0.2 * half}" mass="{mass}"'
    text = slope(load=load, mu=mu, shape=shape).replace('pos="0 0 .05"', f'pos="0 0 {0.2 * half}"')
    found = harness.run_scene(written(tmp_path_factory.mktemp("random"), text), duration=0.6)
    assert found.expected.rests is (load < 1.0)
    if load < 1.0:
        assert found.moved
        assert found.changed is not None
        assert found.changed.creep_m_s < RESTS
        assert found.expected.cone_use == pytest.approx(load, rel=0.02)
    else:
        assert found.moved == []
        assert found.deceleration_m_s2 == pytest.approx(-(load - 1.0) * mu * 9.81, rel=0.02)


TABLE = '<worldbody><geom name="table" type="plane" size="1 1 1"/>'


@pytest.mark.parametrize(("mu", "leaves"), [(0.09, True), (0.11, False)])
def test_a_grip_with_too_little_friction_lets_go_under_dry_friction_too(
    tmp_path: Path, mu: float, leaves: bool
) -> None:
    """Two fingers of 10 N hold 0.2 kg from a coefficient of 0.2 g/20 = 0.0981 on; below it falls on a table."""
    text = pinch(mu=mu).replace("<worldbody>", TABLE)
    found = harness.run_scene(written(tmp_path, text), "held", duration=1.0)
    assert set(found.bearers) == {"left", "right"}
    assert (found.expected.lost_s is not None) is leaves
    assert found.expected.rests is not leaves
    if leaves:
        assert (found.moved, found.change) == ([], "")
        assert "so it would under dry friction. It takes all the friction there is" in found.conclusions[0]
    else:
        assert found.expected.cone_use == pytest.approx(0.0981 / mu, rel=0.02)


@pytest.mark.parametrize(("mu", "slides"), [(0.8, False), (0.05, True)])
def test_a_wheel_that_rolls_off_a_ramp_takes_a_part_of_the_friction(tmp_path: Path, mu: float, slides: bool) -> None:
    """A cylinder rolls down 20 degrees without sliding where mu is above tan(20 deg)/3 = 0.121; rolling friction of
    5 mm is at its limit all the while, and adds (2/3) 5/50 to it: 0.23 of 0.8.
    """
    wheel = f"""<mujoco><worldbody><geom type="box" size=".5 .3 .02" euler="0 20 0"/>
    <body name="wheel" pos="-0.2579 0 0.1684"><freejoint/>
    <geom type="cylinder" size=".05 .02" euler="90 0 0" mass="1" condim="6" friction="{mu} .005 .005" priority="1"/>
    </body></worldbody></mujoco>"""
    found = harness.run_scene(written(tmp_path, wheel), "wheel", duration=1.2)
    assert found.expected.lost_s is not None
    assert found.expected.cone_use == pytest.approx(
        1.0 if slides else (math.tan(math.radians(20)) + 0.2) / 2.4, rel=0.1
    )
    assert ("all the friction there is" in found.conclusions[0]) is slides


def test_what_a_solver_that_is_cut_off_lets_fall_on_a_table_is_let_go(tmp_path: Path) -> None:
    """It rests there, which is no rest in the grip."""
    cut = f'{ELLIPTIC} impratio="20" iterations="1" ls_iterations="4"'
    text = pinch(cut, shape="cylinder").replace("<worldbody>", TABLE)
    found = harness.run_scene(written(tmp_path, text), "held", duration=1.0)
    assert found.moved == ["lets go"]
    assert found.lost_s is not None
    assert "is let go by left and right" in found.conclusions[0]
    assert found.changed is not None
    assert found.changed.mends
    assert found.changed.lost_s is None


def test_a_block_that_slides_is_left_alone_whatever_its_hops(tmp_path: Path) -> None:
    """A tall one at 1.2 of its friction hops by millimetres, with every ratio otherwise."""
    shape = 'type="box" size=".1 .1 .05" mass="1"'
    found = harness.run_scene(written(tmp_path, slope(load=1.2, shape=shape)), duration=2.0)
    assert (found.moved, found.lost_s) == ([], None)


@pytest.mark.skipif(shutil.which("patch") is None, reason="needs patch")
@pytest.mark.parametrize("ending", ["", "\n", "\r\n"])
def test_what_is_to_be_pasted_is_a_diff_that_patch_takes(tmp_path: Path, ending: str) -> None:
    """Of a file in another folder too, and without a line's end at the end of the file."""
    (tmp_path / "parts").mkdir()
    head, _, rest = slope().partition("\n  <worldbody>")
    option = head.removeprefix("<mujoco>\n  ")
    written(tmp_path / "parts", f"<mujocoinclude>{option}</mujocoinclude>{ending}", "option.xml")
    text = f'<mujoco><include file="parts/option.xml"/><worldbody>{rest}'.rstrip()
    file = written(tmp_path, text)
    found = harness.run_scene(file, duration=0.2)
    assert found.change.startswith("--- parts/option.xml\n")
    done = subprocess.run(["patch", "-p0", "--binary"], input=found.change.encode(), cwd=tmp_path, check=False)
    assert done.returncode == 0
    assert creep_of(file, "block", 0.6) < RESTS


def test_of_several_options_the_one_that_rules_is_changed(tmp_path: Path) -> None:
    text = slope().replace("<worldbody>", '<option cone="pyramidal"/><worldbody>')
    found = harness.run_scene(written(tmp_path, text), duration=0.2)
    assert found.proved
    assert '+  <option cone="elliptic"' in found.change


def test_a_contact_says_whose_friction_it_has(tmp_path: Path) -> None:
    """A pair's own before a geom's priority, before the larger of both."""
    pair = '<contact><pair geom1="held" geom2="left" condim="4" friction="1.5 1.5 .01 .0001 .0001"/></contact>'
    text = pinch(ELLIPTIC, contact=pair).replace('name="right" type="box"', 'name="right" priority="1" type="box"')
    found = harness.run_scene(written(tmp_path, text), "held", duration=0.2)
    rules = {one.other: one for one in found.touches}
    assert rules["left"].rule == "the pair's own"
    assert (rules["left"].condim, rules["left"].friction[0]) == (4, 1.5)
    assert rules["right"].rule == "that of right, by priority"


def test_a_contact_of_condim_1_holds_nothing(tmp_path: Path) -> None:
    found = harness.run_scene(written(tmp_path, slope(condim=1)), duration=0.6)
    assert not found.expected.rests
    assert found.moved == []
    assert found.deceleration_m_s2 == pytest.approx(-0.25 * 9.81, rel=1e-3)


def test_a_sparse_jacobian_is_held_against_a_dense_one_where_the_version_calls_for_it(tmp_path: Path) -> None:
    sparse = harness.run_scene(written(tmp_path, slope('jacobian="sparse"')), duration=0.2)
    dense = harness.run_scene(written(tmp_path, slope('jacobian="dense"')), duration=0.2)
    assert (sparse.dense_differs_m is not None) == (mujoco.__version__ == "4.0.0")
    assert dense.dense_differs_m is None


def test_the_result_is_valid_and_its_page_is_made_again_from_the_trace(tmp_path: Path) -> None:
    found = harness.run_scene(written(tmp_path, slope()), duration=0.2, out=tmp_path / "out")
    schema = json.loads((generate.FOLDER / "harness.scene-1.json").read_text(encoding="utf-8"))
    jsonschema.validate(json.loads(Path(found.files["result"]).read_text(encoding="utf-8")), schema)
    _, page = rebuild(Path(found.files["rrd"]), tmp_path / "again.html")
    assert page.read_text(encoding="utf-8") == Path(found.files["report"]).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "body", "says"),
    [
        (pinch(), "hold", "left, right, held. Try: --body held"),
        (slope().replace("<worldbody>", FINGER), "finger", "has block. Try: --body block"),
        (slope().replace("<freejoint/>", "<joint/>"), None, "block. Try: --body block"),
        ("<mujoco><worldbody><body/></worldbody></mujoco>", None, "no body with a name that moves"),
        ('<robot name="r"><link name="l"/></robot>', "l", "harness run --robot"),
        (slope(shape='type="mesh" mesh="m"').replace("<worldbody>", MESH), None, "no.stl"),
        (slope().replace("</worldbody>", "<composite type='cable'/></worldbody>"), None, "no rigid body"),
    ],
)  # fmt: skip
def test_what_cannot_be_watched_is_said(tmp_path: Path, text: str, body: str | None, says: str) -> None:
    with pytest.raises(InputError) as error:
        harness.run_scene(written(tmp_path, text), body)
    assert says in str(error.value)

"""Search of settings: from scratch at least as good as what is known, on sliders it was not searched on."""

import json
import subprocess
import sys
from typing import Any

import mujoco
import pytest
from jsonschema import Draft202012Validator

import harness
from harness.engines import registry
from harness.fidelity import tune as room
from harness.fidelity.paste import paste
from harness.fidelity.tune import HELD_OUT, SHIPPED, Trial, search, space, tunable
from harness.results.generate import schema_text
from harness.results.sweep import TuneResult

KNOWN: dict[str, list[dict[str, Any]]] = {
    "mujoco": [
        {
            "integrator": "RK4",
            "solreffriction": (-1.0, -1.9 * 0.9999 / 4e-3),
            "solimpfriction": (0.9999, 0.9999, 0.001, 0.5, 2.0),
        },
        {"integrator": "RK4", "solreffriction": (8e-3, 1.0), "solimpfriction": (0.9999, 0.9999, 0.001, 0.5, 2.0)},
    ],
    "pybullet": [{"linearDamping": 0.0, "angularDamping": 0.0}],
}
"""Settings that were found by hand, at a step of 4 ms."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.full if name == "mujoco" else ()) for name in sorted(KNOWN)]
)
def test_it_finds_settings_at_least_as_good_as_those_found_by_hand(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # the short form: one start
    monkeypatch.setattr(room, "STARTS", 1)
    found = space(name, "joint")
    assert found is not None
    trial = Trial(registry.load(name), "joint", 4e-3)
    changed = trial.changed(found, search(trial, found, None))
    outcome = trial.score(changed, HELD_OUT)
    for known in KNOWN[name]:
        assert outcome <= trial.score(known, HELD_OUT)
    assert outcome < 0.1 * trial.score({}, HELD_OUT)


def test_what_costs_too_much_is_not_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "STARTS", 1)
    monkeypatch.setattr(Trial, "cost", lambda self, changed: 4.0 if changed.get("integrator") == "RK4" else 1.1)
    found = space("mujoco", "law")
    assert found is not None
    engine = registry.load("mujoco")
    assert search(Trial(engine, "law", 2e-3), found, 5.0)["integrator"] == "RK4"
    assert search(Trial(engine, "law", 2e-3), found, 1.5)["integrator"] != "RK4"
    # nothing is as cheap as half of what ships
    assert search(Trial(engine, "law", 2e-3), found, 0.5) == found.shipped()


def test_result_obeys_its_schema_and_says_what_to_paste(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "STARTS", 1)
    result = harness.tune("mujoco", route="law", dt=2e-3)
    data = json.loads(result.model_dump_json(by_alias=True))
    Draft202012Validator(json.loads(schema_text("harness.tune/1", TuneResult))).validate(data)
    assert result.changed == {"integrator": "RK4"}
    assert result.paste == '<option timestep="0.002" integrator="RK4"/>'
    assert result.score_after < result.score_before
    assert result.cost > 1.0


def test_pasted_joint_settings_are_what_mujoco_compiles() -> None:
    found = space("mujoco", "joint")
    assert found is not None
    choice = found.shipped() | {"integrator": "RK4", "rate": 1.9, "impedance": 0.9999, "noslip_iterations": 5}
    settings = found.settings(choice, 2e-3)
    text = paste("mujoco", "joint", {"dt": 2e-3}, settings)
    option, _, joint = text.splitlines()
    joint = joint.replace("<joint ", '<joint type="slide" axis="1 0 0" frictionloss="3" ')
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco>{option}<worldbody><body>{joint}<geom size=".1"/></body></worldbody></mujoco>'
    )
    assert model.opt.timestep == 2e-3
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
    assert model.opt.noslip_iterations == 5
    assert model.dof_solref[0] == pytest.approx(settings["solreffriction"], rel=1e-9)
    assert model.dof_solimp[0] == pytest.approx(settings["solimpfriction"])


def test_pasted_contact_settings_are_what_mujoco_compiles() -> None:
    found = space("mujoco", "contact")
    assert found is not None
    choice = found.shipped() | {"cone": "elliptic", "impratio": 100.0, "steps": 4.0, "impedance": 0.9}
    text = paste("mujoco", "contact", {"dt": 1e-3}, found.settings(choice, 1e-3))
    option, _, pair = text.splitlines()
    pair = pair.replace("<pair ", '<pair geom1="a" geom2="b" ')
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco>{option}<worldbody><geom name="a" type="plane" size="1 1 1"/>'
        f'<body><freejoint/><geom name="b" size=".1"/></body></worldbody><contact>{pair}</contact></mujoco>'
    )
    assert model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert model.opt.impratio == 100.0
    assert model.pair_solref[0] == pytest.approx([4e-3, 1.0])
    assert model.pair_solimp[0][:2] == pytest.approx([0.9, 0.9])


def test_pasted_calls_are_python() -> None:
    changed = {"linearDamping": 0.0, "frictionAnchor": True, "numSolverIterations": 500, "leapfrog": True}
    text = paste("pybullet", "contact", {"dt": 1e-3}, changed)
    compile(text, "pasted", "exec")
    assert "p.setPhysicsEngineParameter(fixedTimeStep=0.001, numSolverIterations=500)" in text
    assert "p.changeDynamics(body, link, linearDamping=0, frictionAnchor=1)" in text
    assert "leapfrog" in text
    compile(paste("dart", "joint", {"dt": 1e-3}, {"leapfrog": True}), "pasted", "exec")


def installed(name: str) -> pytest.MarkDecorator:
    return pytest.mark.skipif(registry.available().get(name) is not None, reason=f"{name} is not installed")


@installed("rapier")
def test_pasted_attributes_are_rapiers() -> None:
    import rapier3d

    changed = {"num_solver_iterations": 1, "friction_model": "COULOMB", "own_spring": False, "leapfrog": True}
    text = paste("rapier", "contact", {"dt": 2e-3}, changed)
    world = rapier3d.PhysicsWorld()
    exec(compile(text, "pasted", "exec"), {"world": world, "rapier3d": rapier3d})
    given = world.integration_parameters
    assert (given.dt, given.num_solver_iterations) == (pytest.approx(2e-3), 1)
    assert given.friction_model == rapier3d.FrictionModel.COULOMB
    assert "push with -k*x - c*v" in text
    assert "leapfrog" in text


@installed("drake")
def test_pasted_calls_are_drakes() -> None:
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, DiscreteContactApproximation
    from pydrake.systems.framework import DiagramBuilder

    text = paste("drake", "contact", {"dt": 2e-3}, {"contact_approximation": "kTamsi", "stiction_tolerance": 1e-6})
    known: dict[str, Any] = {
        "AddMultibodyPlantSceneGraph": AddMultibodyPlantSceneGraph,
        "DiscreteContactApproximation": DiscreteContactApproximation,
        "builder": DiagramBuilder(),
    }
    exec(compile(text, "pasted", "exec"), known)
    assert known["plant"].time_step() == 2e-3
    assert known["plant"].get_discrete_contact_approximation() == DiscreteContactApproximation.kTamsi


@installed("physx")
def test_pasted_attributes_are_those_of_the_stage_that_the_adapter_makes() -> None:
    code = "from harness.engines.physx_world import _STAGE; print(_STAGE)"
    stage = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    attributes = {line.split(" = ")[0].strip() for line in stage.splitlines() if " = " in line}
    changed = {
        "solverType": "PGS",
        "enableExternalForcesEveryIteration": False,
        "solverPositionIterationCount": 1,
        "solverVelocityIterationCount": 0,
    }
    lines = [line for line in paste("physx", "joint", {"dt": 1e-3}, changed).splitlines() if not line.startswith("#")]
    assert len(lines) == len(changed)
    assert {line.split(" = ")[0] for line in lines} <= attributes
    assert 'uniform token physxScene:solverType = "PGS"' in lines


def test_pasted_words_are_newtons() -> None:
    changed = {"integrator": "rk4", "solreffriction": (-1.0, -1900.0), "solimpfriction": (0.9, 0.9, 0.001, 0.5, 2.0)}
    text = paste("newton", "joint", {"dt": 1e-3}, changed)
    compile(text, "pasted", "exec")
    assert "SolverMuJoCo(model, integrator='rk4')" in text
    assert "'mujoco:solreffriction': [(-1.0, -1900.0)]" in text


@pytest.mark.parametrize("entry", tunable())
def test_every_choice_of_every_space_is_a_setting_the_engine_has(entry: str) -> None:
    name, _, rest = entry.partition(" (")
    if registry.available().get(name) is not None:
        pytest.skip(f"{name} is not installed")
    for route in rest.rstrip(")").split(", "):
        found = space(name, route)  # type: ignore[arg-type]
        assert found is not None
        shipped = registry.load(name).presets(route, "as-shipped", 1e-3)  # type: ignore[arg-type]
        assert Trial(registry.load(name), route, 1e-3).changed(found, found.shipped()) == {}  # type: ignore[arg-type]
        for axis in found.axes:
            if axis.name in shipped:
                assert axis.values[0] == shipped[axis.name]
            else:
                assert axis.values[0] == SHIPPED

"""What every installed engine must do, one table of tests over all of them."""

import hashlib
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from engine_cases import GENTLE, INSTALLED, OFF_FLOOR, TABLE, decay, engine, short, sliders

from harness.core.errors import InputError, SimulationError
from harness.core.events import Mode
from harness.core.scenario import Belt, Harmonic, Hold, Scenario
from harness.core.slider import PAPER, Slider
from harness.core.trajectory import Trajectory
from harness.engines.base import PRESETS, ROUTES, Task
from harness.exact.decay import free_decay
from harness.fidelity.kind import OWN, kind_of, suite
from harness.fidelity.laws import TOLD, WORD
from harness.fidelity.row import measure_row

ALL = [(name, route, preset) for name, route in TABLE for preset in PRESETS]
each = pytest.mark.parametrize(("name", "route", "preset"), ALL)
each_route = pytest.mark.parametrize(("name", "route"), TABLE)
each_off_floor = pytest.mark.parametrize(("name", "route"), OFF_FLOOR)
each_engine = pytest.mark.parametrize("name", INSTALLED)


def run(name: str, task: Task) -> Trajectory:
    return engine(name).simulate(task)


def digest(trace: Trajectory) -> str:
    arrays = [trace.t, trace.x, trace.v, trace.a, *(trace.extra[key] for key in sorted(trace.extra))]
    return hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest()


@each
def test_first_sample_is_the_start(name: str, route: str, preset: str) -> None:
    scenario = Scenario("start", GENTLE, -0.07, 0.3, 0.2)
    trace = run(name, Task(scenario, route, preset))  # type: ignore[arg-type]
    assert trace.t[0] == 0.0
    assert trace.x[0] == pytest.approx(-0.07, abs=1e-15)
    assert trace.v[0] == pytest.approx(0.3, abs=1e-15)
    assert trace.duration == pytest.approx(0.2, abs=trace.source.dt)
    assert trace.duration >= 0.2 - 1e-12


@each
def test_samples_are_one_step_apart_and_settings_are_told(name: str, route: str, preset: str) -> None:
    trace = run(name, short(route, preset=preset, dt=5e-4))
    assert trace.source.dt == 5e-4
    assert np.allclose(np.diff(trace.t), 5e-4, rtol=1e-9)
    assert trace.source.name == name
    assert trace.source.preset == preset
    assert trace.source.version
    expected = set(engine(name).presets(route, preset)) | {"route", "restoring"}  # type: ignore[arg-type]
    assert set(trace.source.settings) == expected


@each
def test_same_inputs_give_the_same_bits(name: str, route: str, preset: str) -> None:
    first = run(name, short(route, preset=preset))
    run(name, short(route, preset=preset, dt=3e-3))
    assert digest(run(name, short(route, preset=preset))) == digest(first)


_FRESH = """
import sys
sys.path[:0] = {folders!r}
from engine_cases import engine, short
from test_engine_conformance import digest
for name, route, preset in {table!r}:
    print(name, route, preset, digest(engine(name).simulate(short(route, preset=preset))))
"""


def test_same_inputs_give_the_same_bits_in_a_fresh_process(request: pytest.FixtureRequest) -> None:
    here = [f"{n} {route} {preset} {digest(run(n, short(route, preset=preset)))}" for n, route, preset in ALL]
    code = _FRESH.format(folders=[str(request.path.parent), str(request.path.parents[1] / "support")], table=ALL)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == here
    assert done.stderr == ""


@each
def test_every_sample_obeys_newtons_second_law(name: str, route: str, preset: str) -> None:
    task = short(route, preset=preset)
    trace = run(name, task)
    slider, dt = task.scenario.slider, trace.source.dt
    assert dt is not None
    rest = slider.m * trace.a + slider.c * trace.v + slider.k * trace.x + trace.extra["friction_force"]
    # what remains is damping taken at the end of a step, and the engine's own drag (0.04 v, PyBullet as shipped)
    drag = 0.05 * slider.m * np.abs(trace.v).max() if preset == "as-shipped" else 0.0
    assert np.abs(rest[1:]).max() <= slider.c * np.abs(trace.a).max() * dt + drag + 1e-9


@each
def test_friction_stays_within_its_limit(name: str, route: str, preset: str) -> None:
    trace = run(name, short(route, preset=preset))
    limit = np.full(len(trace), GENTLE.f_k)
    if route == "contact":
        limit = GENTLE.f_k / (GENTLE.m * 9.81) * trace.extra["normal_force"]
    assert np.all(np.abs(trace.extra["friction_force"]) <= limit * (1.0 + 1e-5) + 1e-9)


@each_off_floor
def test_tuned_follows_the_exact_decay_of_random_sliders(name: str, route: str) -> None:
    for slider in sliders(seed=11, count=6):
        period = 2.0 * np.pi / slider.omega_n
        scenario = decay(slider, 1.0, 8.0 * period)
        trace = run(name, Task(scenario, route, "tuned", period / 600.0))  # type: ignore[arg-type]
        exact = free_decay(scenario, trace.t)
        assert np.abs(trace.x - exact.x).max() < 2e-3, slider


@each_off_floor
def test_energy_only_falls(name: str, route: str) -> None:
    trace = run(name, Task(decay(), route, "tuned"))  # type: ignore[arg-type]
    energy = 0.5 * PAPER.m * trace.v**2 + 0.5 * PAPER.k * trace.x**2
    # between samples the speed of half a step to either side differs: allow for the spring's work over one step
    slack = 0.5 * PAPER.k * np.abs(trace.v).max() * 1e-3 * np.abs(trace.x).max()
    assert np.all(np.diff(energy) <= slack)
    assert energy[-1] < 1e-3 * energy[0]


@each_off_floor
def test_mode_says_stick_at_rest_and_the_direction_while_sliding(name: str, route: str) -> None:
    trace = run(name, Task(decay(), route, "tuned"))  # type: ignore[arg-type]
    assert trace.mode is not None
    assert trace.mode[-1] == Mode.STICK
    fast = np.abs(trace.v) > 0.2
    assert np.array_equal(trace.mode[fast], np.sign(trace.v[fast]))


@pytest.mark.parametrize("share", [0.5, 0.97])
@each_route
def test_tuned_holds_a_static_load(name: str, route: str, share: float) -> None:
    slider = Slider(1.0, 1.0, 100.0, 0.3)
    scenario = Scenario("hold", slider, 0.0, 0.0, 0.3, Hold(share * slider.f_k))
    trace = run(name, Task(scenario, route, "tuned"))  # type: ignore[arg-type]
    creep = (trace.x[-1] - trace.x[150]) / (trace.t[-1] - trace.t[150])
    assert abs(creep) < 1e-6
    assert trace.extra["friction_force"][-1] == pytest.approx(share * slider.f_k, rel=1e-3)


@each_off_floor
def test_break_away_above_sliding_friction_gives_the_stick_slip_period(name: str, route: str) -> None:
    # the exact period of this belt is 0.6658 s
    scenario = Scenario("belt", Slider(1.0, 0.2, 100.0, 3.0, 4.0), 0.0, 0.1, 5.0, Belt(0.1))
    trace = run(name, Task(scenario, route, "tuned", 1e-3))  # type: ignore[arg-type]
    assert trace.mode is not None
    stuck = trace.mode == Mode.STICK
    leaves = trace.t[np.flatnonzero(stuck[:-1] & ~stuck[1:])]
    leaves = leaves[np.diff(leaves, prepend=0.0) > 0.1]
    assert np.mean(np.diff(leaves[1:])) == pytest.approx(0.6658, abs=1.5e-3)
    assert np.abs(trace.v[stuck & (trace.t > 2.0)] - 0.1).max() < 2e-3


@each_route
def test_curves_of_friction_give_the_stick_slip_period(name: str, route: str) -> None:
    told = next((one for one in TOLD if one.engine == name), None)
    for scenario in suite(route, OWN, "laws").values():  # type: ignore[arg-type]
        task = engine(name).task(scenario, route, "tuned", 2e-3)  # type: ignore[arg-type]
        if told is not None and route == "joint" and "polynomial" in scenario.name:
            assert (told.polynomial == WORD) == (task.words is not None)
        found, exact = measure_row(run(name, task), scenario), kind_of(scenario).answers(scenario)
        # the level is that of a step's start; a force as a whole is held over the step
        assert found["period_s"] == pytest.approx(exact["period_s"], rel=2.5e-3)
        assert found["stick_fraction"] == pytest.approx(exact["stick_fraction"], abs=3e-3)
        assert found["stick_deviation_m_s"] < 3e-4 * 0.1  # type: ignore[operator]


@each_off_floor
def test_harmonic_forcing_without_friction_reaches_the_linear_amplitude(name: str, route: str) -> None:
    slider, drive = Slider(1.0, 4.0, 100.0, 0.0), Harmonic(20.0, 8.0, 0.4)
    trace = run(name, Task(Scenario("forced", slider, 0.0, 0.0, 12.0, drive), route, "tuned"))  # type: ignore[arg-type]
    response = drive.amplitude / (slider.k - slider.m * drive.omega**2 + 1j * slider.c * drive.omega)
    steady = np.real(response * np.exp(1j * (drive.omega * trace.t + drive.phase)))
    late = trace.t > 8.0
    assert np.abs(trace.x - steady)[late].max() < 2e-4 * abs(response)


def test_a_route_an_engine_does_not_have_is_refused() -> None:
    lacking = [(name, route) for name in INSTALLED for route in ROUTES if (name, route) not in TABLE]
    for name, route in lacking:
        with pytest.raises(SimulationError, match=f"{name}: no {route} route; there is {engine(name).routes[0]}"):
            run(name, short(route))


BAD: list[tuple[dict[str, Any], str]] = [
    ({"dt": 0.0}, "dt: 0; expected a number above 0 s"),
    ({"dt": -1e-3}, "dt: -0.001; expected a number above 0 s"),
    ({"dt": float("nan")}, "dt: nan; expected a finite number"),
    ({"route": "glue"}, "route: 'glue'; expected one of joint, contact, law"),
    ({"preset": "best"}, "preset: 'best'; expected one of as-shipped, tuned"),
    ({"settings": {"stickiness": 1.0}}, "setting stickiness: unknown; expected one of "),
    ({"settings": {"dt": 1.0}}, "the step is given as dt itself"),
]


@pytest.mark.parametrize(("bad", "message"), BAD)
@each_engine
def test_bad_input_is_refused_in_one_line(name: str, bad: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        engine(name).simulate(Task(decay(), **({"route": engine(name).routes[-1]} | bad)))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@each_engine
def test_a_setting_of_a_wrong_type_is_refused(name: str) -> None:
    route = engine(name).routes[0]
    settings = engine(name).presets(route, "tuned")
    for key, value in settings.items():
        if key != "dt":
            wrong = 3 if isinstance(value, str | tuple) else "much"
            with pytest.raises(InputError, match=f"{name} setting {key}: "):
                engine(name).simulate(Task(decay(), route, settings={key: wrong}))


@each_engine
def test_a_run_leaves_both_streams_alone(name: str, capfd: pytest.CaptureFixture[str]) -> None:
    engine(name).simulate(short(engine(name).routes[0]))
    captured = capfd.readouterr()
    assert captured.out == ""
    assert captured.err == ""

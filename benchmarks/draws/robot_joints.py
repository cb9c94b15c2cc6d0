"""Logs of a robot's joint whose friction is known: one that sticks and slips, and what is pasted of one that swings."""

import math
import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import harness
from benchmarks.draws.shared import Answer
from harness.core.arrays import FloatArray
from harness.core.errors import HarnessError
from harness.results.diagnosis import DiagnosisResult

_STEP, _EVERY, _SECONDS = 2e-4, 20, 20.0
_NOISE = (2e-5, 0.02)
"""rad and N m of what is logged, at 250 Hz."""
_BROKEN = 0.06
"""Share to which break-away is read, or within three of its errors."""
_ERRORS = 2.0
_LINE = {"f_k": "dry friction", "c": "damping"}
Friction = Callable[[float, float], float]
"""N m at a speed, rad/s, above nought, and under a load, N m."""


@dataclass(frozen=True, slots=True)
class _Joint:
    """inertia : kg m^2. gravity : N m when level, 0 about an upright axis. held : N m, break-away."""

    inertia: float
    gravity: float
    stiff: float
    damped: float
    held: float
    friction: Friction

    def logged(self, rng: np.random.Generator, way: FloatArray) -> FloatArray:
        """t, q, torque (n, 3) of a servo along a way (3, k): amplitudes, rad, frequencies, Hz, phases; level at 0."""
        size, turn, phase = way[0], 2.0 * math.pi * way[1], way[2]
        times = np.arange(round(_SECONDS / _STEP)) * _STEP
        angle = np.outer(times, turn) + phase
        wanted, speeds = np.sin(angle) @ size, np.cos(angle) @ (size * turn)
        q, v = float(wanted[0]), float(speeds[0])
        rows = np.empty((times.size // _EVERY, 3))
        for i, (t, q_wanted, v_wanted) in enumerate(zip(times, wanted, speeds, strict=True)):
            load = self.gravity * math.cos(q)
            torque = self.stiff * (q_wanted - q) + self.damped * (v_wanted - v) + load
            if i % _EVERY == 0:
                rows[i // _EVERY] = t, q, torque
            free = torque - load
            if v == 0.0 and abs(free) <= self.held:
                continue
            after = v + _STEP * (free - math.copysign(self.friction(abs(v), abs(load)), v or free)) / self.inertia
            v = 0.0 if v * after < 0.0 and abs(free) <= self.held else after
            q += _STEP * v
        rows[:, 1:] += np.array(_NOISE) * rng.standard_normal((rows.shape[0], 2))
        return rows

    def model(self, f: float = 0.0, c: float = 0.0) -> str:
        """MJCF with friction f, N m, and damping c, N m s/rad."""
        arm = self.gravity / (9.81 * 2.0)
        turning = self.inertia - 2.0 * arm**2
        axis = "0 -1 0" if self.gravity else "0 0 1"
        return (
            '<mujoco><option gravity="0 0 -9.81" timestep="0.002" integrator="implicitfast"/><worldbody><body>'
            f'<joint name="j" axis="{axis}" frictionloss="{f:.6g}" damping="{c:.6g}"/><inertial pos="{arm} 0 0"'
            f' mass="2" diaginertia="{turning} {turning} {turning}"/></body></worldbody></mujoco>'
        )


def _asked(rows: FloatArray, model: str, engines: tuple[str, ...]) -> DiagnosisResult:
    with tempfile.TemporaryDirectory() as folder:
        log, file = Path(folder) / "log.csv", Path(folder) / "joint.xml"
        file.write_text(model)
        np.savetxt(log, rows, "%.8g", ",", header="t,j.position,j.effort", comments="")
        return harness.diagnose_joint(log, file, "j", engines=engines)


def slips(seed: int, number: int) -> Answer:
    """A joint that stands still most of the time: never adequate, its break-away read."""
    rng = np.random.default_rng((seed, number))
    sliding, more = float(rng.uniform(0.4, 1.2)), float(rng.uniform(1.0, 2.5))
    speed, c = float(rng.uniform(0.05, 0.2)), float(rng.uniform(0.0, 0.2))
    held = sliding + more
    joint = _Joint(
        float(rng.uniform(0.2, 0.6)),
        float(rng.uniform(2.0, 10.0)) * 0.6,
        float(rng.uniform(40.0, 80.0)),
        float(rng.uniform(1.0, 2.0)),
        held,
        lambda v, load: sliding + more * math.exp(-v / speed) + c * v,
    )
    way = np.array([[rng.uniform(0.1, 0.16)], [rng.uniform(0.06, 0.1)], [0.0]])
    rows = joint.logged(rng, way)
    try:
        found = _asked(rows, joint.model(), ())
    except HarnessError as error:
        return Answer(False, str(error))
    broken = [one.parameters["f_s"] for one in found.mechanisms if one.name == "static-friction"]
    said = f"{held:.3g} N m; {found.verdict}; {[(one.value, one.stderr) for one in broken]}"
    right = found.verdict != "adequate" and bool(broken)
    for one in broken:
        off = abs((one.value or 0.0) - held)
        right = right and (off < _BROKEN * held or off < 3.0 * (one.stderr or 0.0))
    return Answer(right, said)


FRICTION = ("none", "weak", "Coulomb", "viscous", "both", "Stribeck", "load", "quadratic", "concave")


def pastes(seed: int, number: int) -> Answer:
    """What is pasted moves better than the file did, or is said not to; nothing below two errors is pasted."""
    rng = np.random.default_rng((seed, number))
    kind = FRICTION[number % len(FRICTION)]
    f, c = float(np.exp(rng.uniform(-1.0, 1.0))), float(np.exp(rng.uniform(-1.5, 1.0)))
    s, v_s = float(rng.uniform(0.3, 1.0)), float(rng.uniform(0.1, 0.3))
    laws: dict[str, Friction] = {
        "none": lambda v, load: 0.0,
        "weak": lambda v, load: 0.005,
        "Coulomb": lambda v, load: f,
        "viscous": lambda v, load: c * v,
        "both": lambda v, load: f + c * v,
        "Stribeck": lambda v, load: f * (1.0 + s * math.exp(-v / v_s)) + c * v,
        "load": lambda v, load: f + 0.15 * load + c * v,
        "quadratic": lambda v, load: f + c * v * v,
        "concave": lambda v, load: f + c * math.sqrt(v),
    }
    law = laws[kind]
    gravity = float(rng.uniform(2.0, 8.0)) * float(rng.integers(2))
    inertia = 0.3 + float(rng.uniform(0.0, 0.3))
    stiff = float(np.exp(rng.uniform(math.log(60.0), math.log(400.0))))
    joint = _Joint(inertia, gravity, stiff, 1.2 * math.sqrt(stiff * inertia), law(0.0, 0.7 * gravity), law)
    way = np.stack((rng.uniform(0.1, 0.5, 3), rng.uniform(0.1, 0.8, 3), rng.uniform(0.0, 2.0 * math.pi, 3)))
    times = float(rng.choice((0.0, 0.0, 1.0, 2.0)))
    rows = joint.logged(rng, way)
    try:
        found = _asked(rows, joint.model(times * f, times * c), ("mujoco",))
    except HarnessError as error:
        return Answer(False, f"{kind}: {error}")
    assert found.robot is not None
    ran = [(one.before["x"], one.after["x"]) for one in found.robot.simulated if "x" in one.after]
    worse, told = any(after > before for before, after in ran), "Do not paste" in found.statement
    low = [name for name, value in _pasted(found).items() if value > 0.0 and not _sure(found, name, value)]
    said = f"{kind}, file {times:g}: {_pasted(found)}, {found.verdict}, forward {ran}, told {told}, below {low}"
    nothing = not any(_pasted(found).values())
    return Answer((bool(ran) or nothing) and worse == told and not low, said)


def _pasted(found: DiagnosisResult) -> dict[str, float]:
    """f_k and c as they stand in the element."""
    assert found.robot is not None
    words = dict(re.findall(r'(\w+)="([^"]*)"', found.robot.paste.mjcf))
    return {"f_k": float(words.get("frictionloss", 0.0)), "c": float(words.get("damping", 0.0))}


def _sure(found: DiagnosisResult, name: str, value: float) -> bool:
    """Whether a fitted number of this value stands two errors above none."""
    line = re.search(rf"{_LINE[name]} (\S+) \+- (\S+) N m", found.statement.partition("nearest:")[2])
    if line:
        return float(line[1]) >= _ERRORS * float(line[2])
    own = found.refined.parameters[name]
    return math.isclose(own.value or 0.0, value, rel_tol=1e-6) and value >= _ERRORS * (own.stderr or 0.0)

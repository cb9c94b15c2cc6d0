"""From a seed and a place in the plan to the files of a recording and its answer."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.proof.paths import joints, simulated
from harness.proof.paths.arms import Arm, draw_arm
from harness.proof.paths.files import packed, written
from harness.proof.paths.forms import (
    ARM,
    AXIS,
    CURVE,
    DECAY,
    DOWN,
    FIRST,
    FORMS,
    JOINT,
    NEEDS_BOTH,
    PATHS,
    SERVO,
    SHAKEN,
    SHAPES,
    SIMULATED,
    SLOW,
    SPRING,
    SWING,
    TOGETHER,
    Form,
    Rng,
    _between,
    numbers,
    unknown,
)  # fmt: skip
from harness.proof.paths.rigs import BARE, BRAKE, NONE, Rig, draw_rig, effective, laws_of, loss, shown, spoiled

FORM, CONTROL, UNKNOWN = "path", "path-control", "path-unknown"
GROUPS = (FORM, CONTROL, UNKNOWN)
LOSSES = 0.5, 3e4
"""Between which the strength of an effect is drawn: what it is worth in effective samples."""
MOST = 4.0
"""Times the moderate strength that no effect exceeds; a gas, a magnet and a blow are no stronger on real machines."""
LEAST, TRIES, TURNS = 0.1, 12, 8
KNOWN = 0.8
"""Share of an unknown effect from which it is the law that it projects on."""
_HELD = dict.fromkeys((DECAY, TOGETHER, SPRING, SIMULATED), "spring")
_HELD |= {SWING: "pendulum", SHAKEN: "pendulum", AXIS: "none", SLOW: "none"}


def forms_of(path: str) -> list[str]:
    """Names of the forms that are hidden on a way."""
    return [name for name, form in FORMS.items() if path in form.paths]


def shapes_of(path: str) -> list[str]:
    """Shapes of the unknown effects that a way can show."""
    if path == SERVO:
        return ["f(x)", "g(x) sgn v"]
    if path in (CURVE, DOWN):
        return ["f(v)"]
    return [shape for shape in SHAPES if path not in (AXIS, SLOW, JOINT, ARM) or shape != "f(t)"]


@dataclass(frozen=True, slots=True)
class Made:
    """The files of a recording as one, and its answer."""

    recording: bytes
    answer: dict[str, Any]


def made(seed: int, index: int, path: str, group: str, form: str) -> Made:
    """A recording. form : what is hidden, of its group; "" of a control. Raises SimulationError where none came out."""
    rng = np.random.default_rng([seed, 5, index])
    for _ in range(TRIES):
        # one direction of a curve does not tell that two are unlike
        both = form in NEEDS_BOTH or (path == CURVE and form.startswith("valve"))
        rig = draw_arm(rng) if path == ARM else draw_rig(path, rng, both)
        tables, p = NONE, BARE
        if group == CONTROL:
            return _logged(rng, rig, p, tables, {**_about(form, group), "loss": 0.0, "right": []})
        scales = rig.scales(rig.run(BARE))
        if group == FORM:
            one = FORMS[form]
            p = numbers(one.numbers(scales, rng), scales)
            worth = _scaled(rng, rig, p, one, tables)
            right, taken = rig.right(one.right) if isinstance(rig, Arm) else list(one.right), {}
        else:
            p, tables = unknown(form, scales, rng)
            worth = _scaled(rng, rig, p, None, tables)
            of_law = _laws(rig, p, tables) if worth > LEAST and path != SERVO else {}
            taken = {n: part for n, part in of_law.items() if part > KNOWN}
            right = sorted(taken, key=lambda name: -taken[name])
        if worth > LEAST:
            about = {**_about(form, group), "loss": worth, "right": right, "projects": taken}
            return _logged(rng, rig, p, tables, about)
    raise SimulationError(f"{path}, {form}: no draw in {TRIES} tries")


def _about(form: str, group: str) -> dict[str, Any]:
    return {"group": group, "form": form}


def _worth(rig: Rig | Arm, p: FloatArray, tables: FloatArray) -> float:
    return rig.loss(p, tables) if isinstance(rig, Arm) else loss(rig, p, tables)


def _laws(rig: Rig | Arm, p: FloatArray, tables: FloatArray) -> dict[str, float]:
    if isinstance(rig, Rig):
        return laws_of(rig, p, tables)
    return {name: part for law, part in rig.laws_of(p, tables).items() for name in rig.right((law,))}


def _scaled(rng: Rng, rig: Rig | Arm, p: FloatArray, form: Form | None, tables: FloatArray) -> float:
    """Make an effect as strong as a drawn loss asks for, in place; the loss that it comes to."""
    from harness.proof.paths.plant import UNKNOWN as OF_NONE

    place = OF_NONE if form is None else form.strength
    limit, wanted = MOST * p[place], _between(rng, *LOSSES)
    power, before = 2.0, (0.0, 0.0)
    for _ in range(TURNS):
        worth = _worth(rig, p, tables)
        if 0.8 < worth / wanted < 1.25 or (worth < wanted and p[place] == limit):
            return worth
        if not math.isfinite(worth):
            p[place] *= 0.3
            continue
        here = math.log(p[place]), math.log(max(worth, 1e-6))
        if before[1] and here[0] != before[0]:
            power = min(max((here[1] - before[1]) / (here[0] - before[0]), 0.5), 12.0)
        before = here
        p[place] = min(p[place] * min(max((wanted / max(worth, 1e-6)) ** (1.0 / power), 0.02), 50.0), limit)
    return _worth(rig, p, tables)


def _logged(rng: Rng, rig: Rig | Arm, p: FloatArray, tables: FloatArray, about: Mapping[str, Any]) -> Made:
    if isinstance(rig, Arm):
        return _of_arm(rng, rig, p, tables, about)
    rigs = [rig]
    if rig.path == TOGETHER:
        several = int(rng.integers(3, 6))
        rigs = [replace(rig, start=(rig.start[0] * f, 0.0), zero=rig.zero * rng.uniform(-1.0, 1.0))
                for f in (1.0, *rng.uniform(0.6, 1.0, several - 1))]  # fmt: skip
        about = {**about, "loss": sum(loss(one, p, tables) for one in rigs) if about["right"] or about["loss"] else 0.0}
    files, total, r2 = {}, 0, 1.0
    for number, one in enumerate(rigs):
        run = one.run(p, tables)
        clean = shown(one, run, p)
        channels = spoiled(one, clean, rng)
        before = round(one.rest / one.dt)
        if before:
            channels = {
                c: np.concatenate((np.repeat(y[:1] if c != "a" else 0.0, before), y)) for c, y in channels.items()
            }
            channels = {c: _stirred(rng, one, c, y, before) for c, y in channels.items()}
        n = len(next(iter(channels.values())))
        t = None if one.path == CURVE else one.dt * np.arange(float(n))
        name = "recording.csv" if len(rigs) == 1 else f"repetition-{number + 1}.csv"
        turning = bool(one.b[4]) or one.path == "run-down"
        if t is not None and one.path in (JOINT, SERVO):
            files[name] = joints.log(rng, t, channels, one)
        else:
            files[name] = written(rng, t, channels, turning)
        total += n
        first = clean[one.channels[-1] if one.driven or one.path == CURVE else one.channels[0]]
        sigma = one.sigma[2] if one.driven or one.path == CURVE else one.sigma[1 if one.channels == "a" else 0]
        size = float(np.var(first)) * first.size
        r2 = max(1.0 - 2.0 * about["loss"] / effective(one) * sigma**2 / max(size, 1e-300), 0.0)
    free = bool(rng.random() < 0.5)
    arguments = []
    if not free and rig.path in _HELD:
        arguments = ["--restoring", _HELD[rig.path]]
        sprung = _HELD[rig.path] == "spring"
        arguments += ["--zero", "free" if rig.zero else "spring"] if sprung else []
    if rig.path in (JOINT, SERVO):
        model, arguments = joints.described(rng, rig, free)
        files |= model
    if rig.path == SIMULATED:
        noise = max(rig.sigma[0] if "x" in rig.channels else 0.0, rig.count) / abs(rig.start[0])
        own, told, changes = simulated.beside(rng, rig.b, rig.start[0], total * rig.dt, noise)
        files |= own
        arguments = [*arguments, *told]
        about = {**about, "changes": changes}
    m, c, k, f_k, _ = map(float, rig.b)
    base = {"mass": m, "c": c, "f_k": f_k} | ({"k": k} if k else {})
    if k:
        base |= {"omega_n": math.sqrt(k / m), "zeta": c / (2.0 * math.sqrt(k * m)), "x_k": f_k / k}
    if rig.path == SERVO:
        # without a model torques have no scale
        base = {} if free else {"f_k": f_k, "c": c - BRAKE}
    return _answered(rig, files, p, about, points=total, arguments=arguments, told=not free, base=base, base_r2=[r2])


def _of_arm(rng: Rng, arm: Arm, p: FloatArray, tables: FloatArray, about: Mapping[str, Any]) -> Made:
    files, arguments, told = arm.files(rng, p, tables)
    each = zip(arm.names, arm.b, strict=True)
    base = {f"{name}.{number}": float(b[at]) for name, b in each for number, at in (("c", 1), ("f_k", 3))}
    n = -(-len(arm.goal) // arm.every)
    return _answered(arm, files, p, about, points=n, arguments=arguments, told=told, base=base, base_r2=[])


def _answered(rig: Rig | Arm, files: Mapping[str, str], p: FloatArray, about: Mapping[str, Any], **more: Any) -> Made:
    return Made(packed(files), {
        **about, "mechanisms": about["right"][:1], "source": "path", "setting": rig.path, "channels": rig.channels,
        **more, "base_chi2_excess": 2.0 * about["loss"],
        "numbers": {str(i): float(value) for i, value in enumerate(p) if value},
    })  # fmt: skip


def _stirred(rng: Rng, rig: Rig, channel: str, y: FloatArray, before: int) -> FloatArray:
    """A channel with the sensor's noise in the rest before it is let go."""
    if rig.count and channel == "x":
        return y
    sigma = rig.sigma[0 if channel == "x" else 1]
    held = np.mean(y[before : before + 1]) if channel == "x" else 0.0
    return np.concatenate((held + sigma * rng.standard_normal(before), y[before:]))


def ways(count: int, rng: Rng, of: int = FIRST) -> list[tuple[str, str, str]]:
    """Way, group and form of each recording: half controls, an eighth unknown; every way as often as any other.

    of : how many of ``PATHS``, from the first.
    """
    found, turn = [], 0
    for group, many in ((CONTROL, count // 2), (UNKNOWN, count // 8), (FORM, count - count // 2 - count // 8)):
        order = [PATHS[int(i)] for i in rng.permutation(of)]
        deck: dict[str, list[str]] = {}
        for number in range(many):
            path = order[number % len(order)]
            names = [""] if group == CONTROL else shapes_of(path) if group == UNKNOWN else forms_of(path)
            if not deck.get(path):
                deck[path] = [names[int(i)] for i in rng.permutation(len(names))]
            found.append((path, group, deck[path].pop()))
            turn += 1
    return found

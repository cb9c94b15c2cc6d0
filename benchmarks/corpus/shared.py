"""Recordings and commands that are not the project's: a folder holds them, and without it they are left out."""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import harness
from benchmarks.corpus.case import Case, Truth


def _options(words: list[str]) -> dict[str, Any]:
    """Keywords of harness.diagnose from options of the command."""
    return {key.lstrip("-"): value for key, value in zip(words[::2], words[1::2], strict=True)}


def _diagnosed(name: str, kind: str, path: Path, truth: Truth | None, **options: Any) -> Case:
    reading = {k: options.pop(k) for k in ("columns", "skip_rows", "rate", "start", "stop") if k in options}

    def ask() -> Any:
        recording: Any = harness.load(path, **reading) if reading else path
        return harness.diagnose(recording, engines=(), **options)

    return Case(name, kind, ask, truth)


def _scored(folder: Path) -> Iterator[Case]:
    for name, truth in json.loads((folder / "messy/truth.json").read_text()).items():
        dominant = truth["dominant"]
        known = (
            Truth("small effects only", quiet=True)
            if dominant is None
            else None
            if dominant.startswith("alien")
            else Truth(f"{dominant}, {100 * truth['share']:.0f} %", (dominant,))
        )
        yield _diagnosed(f"messy/{name[:-4]}", "messy", folder / "messy" / name, known, **_options(truth["options"]))
    for name, truth in json.loads((folder / "concealed/truth.json").read_text()).items():
        names = tuple(truth["mechanisms"])
        known = Truth(" and ".join(names) or "nothing is missing", names, quiet=not names)
        yield _diagnosed(f"concealed/{name[:-4]}", "concealed", folder / "concealed" / name, known, zero="spring")


def _machines(folder: Path) -> Iterator[Case]:
    at = folder / "recordings"
    columns = "t=t,x=qm[m],u=35.15*vir[N]"
    yield _diagnosed(
        "emps/fit",
        "machine",
        at / "emps/DATA_EMPS.mat",
        Truth(
            "95.11 kg and a direction-dependent viscous friction or an offset",
            numbers={"refined.parameters.mass": (95.11, 0.02)},
        ),
        columns=columns,
        restoring="none",
    )
    for number in (1, 2, 3):
        quiet = Truth("a control: viscous and Coulomb friction and little else", quiet=True) if number == 3 else None
        yield _diagnosed(
            f"rotary/{number:02}",
            "machine",
            at / f"rotary-pendulum/pendulum_free_swing_data_{number:02}.txt",
            quiet,
            columns="x=#1[deg]",
            skip_rows=2,
            rate=1000.0,
            restoring="pendulum",
        )
    for name in ("radial", "axial"):
        known = Truth("nothing that is sure", quiet=True) if name == "radial" else None
        yield _diagnosed(f"wheel/{name}", "machine", at / f"machines/wheel/resonance_wheel_{name}.csv", known)
    for name in ("jlefebvre_q2", "tylertian_lab1"):
        yield _diagnosed(
            f"pendulum/{name}",
            "machine",
            at / f"machines/pendulums/{name}.csv",
            Truth("quadratic drag", ("quadratic-drag",)),
            restoring="pendulum",
        )
    for path in sorted((at / "machines/pneumatic").glob("*.csv")):
        yield _diagnosed(f"pneumatic/{path.stem}", "machine", path, None)
    for path in sorted((at / "xl330-pendulum").glob("*.json"))[:2]:
        yield _diagnosed(f"xl330/{path.stem}", "machine", path, None)


_CREEP, _DIVERGES = "as_it_is.0.creep", (5.0, 10.0)
_LEVEL, _SHIPPED = 0.4905, 5.21
"""Torque of gravity, N m, and softness of friction as shipped, N m s/rad, of a link of these files that lies level."""
_ENGINE = {
    "cap-implicitfast": Truth(
        "diverges; kp at most 2880, or a step of 2.4 ms",
        numbers={"servo.cure.kp": (2880.0, 0.01), "servo.cure.step_s": (2.4e-3, 0.01)},
    ),
    "cap-rk4": Truth("diverges: h omega = 6.03", numbers={"servo.diverges_after": _DIVERGES}),
    "creep-with-damping": Truth("2.75 deg/s", numbers={_CREEP: (_LEVEL / (_SHIPPED + 5.0), 0.02)}),
    "dcmotor-lugre": Truth(
        "breaks away at 0.8 N m, slides at 0.6",
        numbers={"as_it_is.0.break_away": (0.8, 1e-6), "as_it_is.0.friction": (0.6, 1e-6)},
    ),
    "flag-frictionloss": Truth("it falls, 1.41 rad/s", numbers={_CREEP: (1.41, 0.02)}),
    "floating-base": Truth("0.289 deg/s at 0.15 N m", numbers={_CREEP: (0.194 / 0.15 * math.radians(0.289), 0.03)}),
    "gravcomp": Truth("holds; 0.539 deg/s", numbers={_CREEP: (0.1 * _LEVEL / _SHIPPED, 0.02)}),
    "noslip-damping": Truth("2.87 s to stop", numbers={"as_it_is.0.stop.time_s": (2.87, 0.01)}),
    "pid-elsewhere": Truth("5.4 deg/s", numbers={_CREEP: (_LEVEL / _SHIPPED, 0.02)}),
    "pybullet-damping": Truth("joint damping diverges", numbers={"as_it_is.1.diverges_after": _DIVERGES}),
    "tendon-servo": Truth(
        "200 N m/rad; diverges", numbers={"servo.stiffness": (200.0, 1e-6), "servo.diverges_after": _DIVERGES}
    ),
}


def _robots(folder: Path) -> Iterator[Case]:
    at = folder / "recordings/machines"
    cases = [
        *((at / f"dfki-double-pendulum/dfki_double_{n}.csv", at / "dfki-double-pendulum/double_pendulum.urdf")
          for n in ("20220812-060143", "20220812-060329")),
        (at / "ur10/ur10_exciting_trajectory.db3", at / "ur10/ur10.urdf"),
    ]  # fmt: skip
    joints = {"dfki": ("joint1", "joint2"), "ur10": ("shoulder_pan_joint", "elbow_joint", "wrist_3_joint")}
    for log, robot in cases:
        for joint in joints[log.stem[:4]]:
            yield Case(
                f"robot/{log.stem}:{joint}",
                "robot",
                lambda log=log, robot=robot, joint=joint: harness.diagnose_joint(log, robot, joint, engines=()),  # type: ignore[misc]
            )
    for path in sorted((at / "so101").glob("*.csv")):
        yield _diagnosed(f"so101/{path.stem}", "bad log", path, None)
    cases_at = folder / "engine-cases"
    yield Case(
        "robot/stairs",
        "robot",
        lambda: harness.diagnose_joint(cases_at / "stairs.csv", cases_at / "shoulder.xml", "j", engines=()),
        # what holds it is more than what slides: either name says so, and its break-away is that of the slips
        Truth(
            "stick-slip: break-away at 2.9 N m; 'adequate' is false",
            names=("static-friction", "stribeck"),
            either=True,
            numbers={"mechanisms.0.parameters.f_s": (2.9, 0.03)},
        ),
    )
    for path in sorted([*cases_at.glob("*.xml"), *cases_at.glob("*.urdf")]):
        joint = {"noslip-damping": "spin", "floating-base": "hip"}.get(path.stem, "j")
        if path.stem == "shoulder":
            continue
        yield Case(
            f"engine/{path.stem}",
            "engine",
            lambda path=path, joint=joint: harness.run_joint(path, joint, preset="as-shipped"),  # type: ignore[misc]
            _ENGINE.get(path.stem),
        )


def _field(folder: Path) -> Iterator[Case]:
    at = folder / "field"
    repetitions = [at / f"together/rep{n}.csv" for n in range(1, 6)]
    drag = Truth("quadratic drag of 1.8", ("quadratic-drag",))
    for path in repetitions:
        yield _diagnosed(f"together/{path.stem}", "several", path, drag)
    yield Case("together/all", "several", lambda: harness.diagnose(repetitions, engines=()), drag)
    yield Case("together/two", "several", lambda: harness.diagnose(repetitions[:2], engines=()), drag)
    for name, names in (
        ("rec_both", ("stribeck", "quadratic-drag")),
        ("rec_drag", ("quadratic-drag",)),
        ("rec_same", ()),
        ("rec_stribeck", ("stribeck",)),
    ):
        truth = Truth(" and ".join(names) or "nothing is missing", names, quiet=not names)
        path = at / f"simulation/{name}.csv"
        yield _diagnosed(f"simulation/{name}", "simulation", path, truth)
        yield Case(
            f"simulation/{name}:sim",
            "simulation",
            lambda path=path: harness.diagnose(path, sim=at / "simulation/sim.csv", engines=()),  # type: ignore[misc]
            truth,
        )
    yield Case(
        "hang/lag",
        "own pair",
        lambda: harness.diagnose(at / "hang/lag.csv", zero="spring", engines=()),
        Truth("a constant force and a late sensor", ("constant-force", "sensor-lag")),
    )
    for path in sorted([*(at / "formats").glob("*.csv"), *(at / "formats").glob("*.txt")]):
        yield _diagnosed(f"formats/{path.stem}", "bad log", path, Truth("is read", read=True))
    cases_at = folder / "engine-cases"
    yield _diagnosed(
        "tanh10", "own single", cases_at / "tanh10.csv", Truth("regularised friction", ("regularised-friction",)),
        restoring="spring",
    )  # fmt: skip
    yield Case(
        "compare/unit", "compare", lambda: harness.compare(cases_at / "unit-sim.csv", cases_at / "unit-real.csv"),
        Truth("damping is 180/pi times too large", verdict=("different",)),
    )  # fmt: skip
    yield Case(
        "compare/rec_both", "compare",
        lambda: harness.compare(at / "simulation/sim.csv", at / "simulation/rec_both.csv"),
        Truth("another frequency and friction", verdict=("different",)),
    )  # fmt: skip


def cases(folder: Path) -> Iterator[Case]:
    """All of a folder's; none where it is not there."""
    if (folder / "messy/truth.json").is_file():
        for part in (_scored, _machines, _robots, _field):
            yield from part(folder)

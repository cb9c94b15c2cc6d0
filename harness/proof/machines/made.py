"""From a job of the plan to a recording and its answer: both follow from the seed and the job's place alone."""

import math
from dataclasses import dataclass
from io import StringIO
from typing import Any

import numpy as np

from harness.core.errors import SimulationError
from harness.proof.machines.cases import Messy, draw, with_sums
from harness.proof.machines.effects import EFFECTS, FAMILY, STATIC, table
from harness.proof.machines.kinds import KINDS
from harness.proof.machines.plan import Job, possible
from harness.proof.machines.sealed import Sealed
from harness.proof.machines.shares import relative

_DEGREE, _MILLI = 180.0 / np.pi, 1e3


def units(case: Messy) -> dict[str, tuple[str, float]]:
    """Unit of each column and its number in the SI unit; degrees and millimetres where the machine is of that kind."""
    t = ("s", 1.0)
    if case.rig.kind.angular:
        if case.rig.kind.name in ("encoder-pendulum", "torsion-wheel"):
            return {"t": t, "x": ("deg", _DEGREE), "v": ("deg/s", _DEGREE)}
        return {"t": t, "x": ("rad", 1.0), "v": ("rad/s", 1.0)}
    if case.rig.kind.name in ("rubber-stage", "cylinder"):
        return {"t": t, "x": ("mm", _MILLI), "a": ("m/s^2", 1.0), "u": ("N", 1.0)}
    return {"t": t, "x": ("m", 1.0), "a": ("m/s^2", 1.0), "u": ("N", 1.0)}


def csv_text(case: Messy) -> str:
    """t, the channels, and u where driven, with nine significant digits."""
    known = units(case)
    names = [name for name in ("t", "x", "v", "a", "u") if name in case.recorded]
    table = np.column_stack([case.recorded[name] * known[name][1] for name in names])
    text = StringIO()
    header = ",".join(f"{name} [{known[name][0]}]" for name in names)
    np.savetxt(text, table, fmt="%.9g", delimiter=",", header=header, comments="")
    return text.getvalue()


MAY_NAME = 0.6
"""Share from which a law that is in a control may be named: fitted freely it takes that much off."""


def truth(case: Messy) -> dict[str, Any]:
    """Main effect and what it makes of the misfit, the small ones, what the user would say, nuisances, the machine.

    share : of the misfit beyond noise, measured by the base fit of the recording with and without the main effect.
    minor : what each other effect alone leaves over what the base leaves of all. may_name, sums_up : laws in a control,
    and others, that take more than ``MAY_NAME`` off when they are fitted. plant : parameters, SI.
    table : the true curve of a static law of no catalogue, over the swept range.
    """
    rig, base = case.rig, case.rig.base
    swept = slice(int(np.searchsorted(rig.t, rig.free_from)), None)
    period = 2.0 * math.pi / base.omega_n
    said: dict[str, Any] = {
        "dominant": case.main or None,
        "family": EFFECTS[case.main].families[0] if case.main else None,
        "families": list(EFFECTS[case.main].families) if case.main else [],
        "kind": rig.kind.name,
        "channels": rig.channels,
        "options": rig.arguments(),
        "nuisances": _nuisances(case),
        "share": case.share,
        "minor": dict(case.small),
        "may_name": sorted(n for n, part in case.fitted.items() if n in FAMILY and part > MAY_NAME),
        "sums_up": {n: part for n, part in case.summed.items() if part > MAY_NAME},
        "plant": {name: dict(values) for name, values in case.effects.items()},
        "base_rel_rmse": relative(rig, case.whole),
        "base_rmse": {c: math.sqrt(m) for c, m in case.whole.misfit.items()},
        "weights": dict(case.weight),
        "noise": dict(case.noise.total),
        "base_r2": [1.0 - m / float(np.var(case.whole.clean[c])) for c, m in case.whole.misfit.items()],
        "measured_by": "force" if rig.kind.driven else "motion",
        "m": base.m,
        "omega_n": base.omega_n,
        "zeta": base.zeta,
        "x_k": base.x_k,
        "x0": base.x0,
        "samples": rig.t.size,
        "cycles": (float(rig.t[-1]) - rig.free_from) / period,
        "per_cycle": (rig.t.size - 1) * period / float(rig.t[-1]),
        "free_from_s": rig.free_from,
    }
    if case.main not in STATIC:
        return said
    x, v = ((float(y[swept].min()), float(y[swept].max())) for y in (case.whole.run.x, case.whole.run.v))
    return {**said, "table": table(case.main, case.effects[case.main], base, x, v)}


def _nuisances(case: Messy) -> dict[str, Any]:
    rig, noise = case.rig, case.noise
    said: dict[str, Any] = {"release": rig.release, "stamps": rig.clock, "noise": noise.style}
    if rig.zero != 0.0:
        said["zero"] = rig.zero
    if noise.style == "coloured":
        said["correlation"] = noise.noise.correlation
    if noise.noise.step:
        said["step"] = dict(noise.noise.step)
    if rig.clock == "jitter":
        said["jitter_s"] = float(np.std(rig.t - rig.stamps))
    for name, value in (("lowpass_s", rig.delay), ("gain", rig.gain)):
        if value:
            said[name] = dict(value)
    if rig.hand.fades:
        said["gives_way_s"] = rig.hand.fades
    if rig.hand.shift:
        said["moved"] = rig.hand.shift
    if rig.cut:
        said["clock_s"] = rig.cut
    return said


ATTEMPTS = 4
"""Times a job is drawn before it is given up; from the second on with another effect of its group."""


@dataclass(frozen=True, slots=True)
class Made:
    """A recording as CSV, and its answer."""

    recording: str
    answer: dict[str, Any]


def made(seed: int, job: Job, sealed: Sealed | None = None) -> Made:
    """A recording and all of its answer; raises SimulationError when nothing came out.

    sealed : what its answer says that fits decide.
    """
    case, rng = _drawn(seed, job, sealed)
    return _told(job, with_sums(case, rng))


def made_quickly(seed: int, job: Job) -> Made:
    """The same, but that the answer of a control does not say which laws sum it up."""
    return _told(job, _drawn(seed, job)[0])


def _told(job: Job, case: Messy) -> Made:
    return Made(csv_text(case), {"group": job.group, **truth(case)})


def _drawn(seed: int, job: Job, sealed: Sealed | None = None) -> tuple[Messy, np.random.Generator]:
    """A case, and the chance that goes on from it."""
    kind, reason = KINDS[job.kind], ""
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, 1, job.index, attempt])
        names = possible(kind, job.group)
        main = names[int(rng.integers(len(names)))] if attempt else job.main
        try:
            return draw(kind, main, rng, sealed), rng
        except SimulationError as error:
            reason = str(error)
    raise SimulationError(reason)

"""From a job of the plan to a recording and its answer: both follow from the seed and the job's place alone."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.errors import SimulationError
from harness.proof.machines.cases import Messy, Sealed, draw, with_sums
from harness.proof.machines.kinds import Job, Kind, possible
from harness.proof.machines.shares import relative
from harness.proof.plant.cases import as_csv
from harness.proof.plant.effects import EFFECTS, OF_MACHINES, STATIC

_DEGREE, _MILLI = 180.0 / np.pi, 1e3


def units(kind: Kind) -> dict[str, tuple[str, float]]:
    """Unit of each column and its number in the SI unit; degrees and millimetres where the machine is of that kind."""
    if kind.name in ("encoder-pendulum", "torsion-wheel"):
        return {"t": ("s", 1.0), "x": ("deg", _DEGREE), "v": ("deg/s", _DEGREE)}
    if kind.angular:
        return {"t": ("s", 1.0), "x": ("rad", 1.0), "v": ("rad/s", 1.0)}
    x = ("mm", _MILLI) if kind.name in ("rubber-stage", "cylinder") else ("m", 1.0)
    return {"t": ("s", 1.0), "x": x, "a": ("m/s^2", 1.0), "u": ("N", 1.0)}


def csv_text(case: Messy) -> str:
    """t, the channels, and u where driven."""
    known = units(case.rig.kind)
    names = [name for name in ("t", "x", "v", "a", "u") if name in case.recorded]
    return as_csv({f"{name} [{known[name][0]}]": case.recorded[name] * known[name][1] for name in names})


MAY_NAME = 0.6
"""Share from which a law that is in a control may be named: fitted freely it takes that much off."""
TABLE_POINTS = 201


def truth(case: Messy) -> dict[str, Any]:
    """Main effect and what it makes of the misfit, the small ones, what the user would say, nuisances, the machine.

    share : of the misfit beyond noise, measured by the base fit of the recording with and without the main effect.
    minor : what each other effect alone leaves over what the base leaves of all. may_name, sums_up : laws in a control,
    and others, that take more than ``MAY_NAME`` off when they are fitted. plant : parameters, SI.
    table : the true curve of a static law of no catalogue, over the swept range.
    """
    rig, base = case.rig, case.rig.base
    period = 2.0 * math.pi / base.omega_n
    families = EFFECTS[case.main].families if case.main else ()
    return {
        "dominant": case.main or None,
        "family": families[0] if families else None,
        "families": list(families),
        "kind": rig.kind.name,
        "channels": rig.channels,
        "options": rig.arguments(),
        "nuisances": _nuisances(case),
        "share": case.share,
        "minor": dict(case.small),
        "may_name": sorted(n for n, part in case.fitted.items() if n in OF_MACHINES and part > MAY_NAME),
        "sums_up": {n: part for n, part in case.summed.items() if part > MAY_NAME},
        "plant": {name: dict(values) for name, values in case.effects.items()},
        "base_rel_rmse": relative(rig, case.whole),
        "base_rmse": {c: math.sqrt(m) for c, m in case.whole.misfit.items()},
        "weights": dict(case.weight),
        "noise": dict(case.noise.total),
        "base_r2": [1.0 - m / float(np.var(case.whole.clean[c])) for c, m in case.whole.misfit.items()],
        "measured_by": "force" if rig.kind.driven else "motion",
        **{name: getattr(base, name) for name in ("m", "omega_n", "zeta", "x_k", "x0")},
        "samples": rig.t.size,
        "cycles": (float(rig.t[-1]) - rig.free_from) / period,
        "per_cycle": (rig.t.size - 1) * period / float(rig.t[-1]),
        "free_from_s": rig.free_from,
        **({"table": _table(case)} if case.main in STATIC else {}),
    }


def _table(case: Messy) -> dict[str, Any]:
    """The true curve over the swept range of x (m) or v (m/s); the force in N."""
    known = STATIC[case.main].curve
    assert known is not None
    form, make = known
    run, rig = case.whole.run, case.rig
    swept = (run.v if form == "f(v)" else run.x)[int(np.searchsorted(rig.t, rig.free_from)) :]
    at: list[float] = np.linspace(float(swept.min()), float(swept.max()), TABLE_POINTS).tolist()
    curve = make(case.effects[case.main], rig.base)
    return {"form": form, "at": at, "force": [curve(one) for one in at]}


def _nuisances(case: Messy) -> dict[str, Any]:
    rig, noise = case.rig, case.noise
    said: dict[str, Any] = {"release": rig.release, "stamps": rig.clock, "noise": noise.style}
    given = {
        "zero": rig.zero,
        "correlation": noise.noise.correlation,
        "step": dict(noise.noise.step or {}),
        "jitter_s": float(np.std(rig.t - rig.stamps)) if rig.clock == "jitter" else 0.0,
        "lowpass_s": dict(rig.delay),
        "gain": dict(rig.gain),
        "gives_way_s": rig.hand.fades,
        "moved": rig.hand.shift,
        "clock_s": rig.cut,
    }
    return said | {name: value for name, value in given.items() if value}


ATTEMPTS = 4
"""Times a job is drawn before it is given up; from the second on with another effect of its group."""


@dataclass(frozen=True, slots=True)
class Made:
    """A recording as CSV, and its answer."""

    recording: str
    answer: dict[str, Any]


def made(seed: int, job: Job, sealed: Sealed | None = None, sums: bool = True) -> Made:
    """A recording and its answer; raises SimulationError when nothing came out.

    sealed : what its answer says that fits decide. sums : whether the answer of a control says which laws sum it up,
    most of the time that it takes.
    """
    reason = ""
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, 1, job.index, attempt])
        names = possible(job.kind, job.group)
        main = names[int(rng.integers(len(names)))] if attempt else job.main
        try:
            case = draw(job.kind, main, rng, sealed)
        except SimulationError as error:
            reason = str(error)
            continue
        case = with_sums(case, rng) if sums else case
        return Made(csv_text(case), {"group": job.group, **truth(case)})
    raise SimulationError(reason)

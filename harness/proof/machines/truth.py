"""The answer of a recording as it is written down."""

import math
from typing import Any

import numpy as np

from harness.proof.machines.cases import Messy
from harness.proof.machines.catalogue import FAMILY, families
from harness.proof.machines.laws import CURVES, table
from harness.proof.machines.shares import relative

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
        "family": families(case.main)[0] if case.main else None,
        "families": list(families(case.main)) if case.main else [],
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
    if case.main not in CURVES:
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

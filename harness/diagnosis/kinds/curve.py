"""The steps of a friction curve, whose force is in proportion to most of what is fitted."""

from dataclasses import replace

import numpy as np

from harness.core.errors import InputError
from harness.diagnosis.covariates.following import enter
from harness.diagnosis.explain.force_map import ForceMap, measured_map
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.kind import Kind
from harness.diagnosis.motion import Motion
from harness.diagnosis.outcome import Holdout
from harness.diagnosis.parameters import free_of
from harness.diagnosis.problems.curve import Curve
from harness.diagnosis.search.search import search
from harness.diagnosis.stages import Based, Found, Judged
from harness.kernels.solve import Scales
from harness.model.model import Model, Restoring


class Curves(Kind[Curve]):
    """See Kind."""

    of = Curve

    def fit_base(self, problem: Curve) -> Based[Curve]:
        """From the nearest that neither friction nor damping is below 0. Raises InputError where nothing slows."""
        from scipy.optimize import nnls  # where it is needed: it is slow to import

        table = np.column_stack((problem.v, np.sign(problem.v)))
        (c, f_k), _ = nnls(table, problem.channels["u"])
        if c == 0.0 and f_k == 0.0:
            raise InputError("recording", "a force that slows nothing", "a force against the speed")
        start = Model(problem.mass or 1.0, float(c), 0.0, float(f_k), restoring=Restoring.NONE)
        found = fit(start, problem, free_of(start, ("c", "f_k")), problem.scales)
        if problem.acting:
            entered = enter(found, problem, problem.scales)
            problem = replace(problem, acting=entered.acting, enters=problem.enters or entered.said)
            found = entered.fit
        return Based(problem, problem, found, problem.scales)

    def search(self, based: Based[Curve], other: Judge | None) -> Found:
        """As of any recording."""
        found = search(based.problem, based.fit, based.scales)
        return Found(found, based.scales, found)

    def hold_out(self, judged: Judged) -> Holdout:
        """None: each row stands by itself."""
        return Holdout.none()

    def left_over(self, problem: Curve, base: Fit, scales: Scales, wander: float | None = None) -> ForceMap:
        """What is left of the force, over speed."""
        left = (problem.channels["u"] - base.shown.y["u"]) / base.model.m
        motion = Motion(base.shown.x, problem.v, problem.v == 0.0, scales.omega)
        return measured_map(problem.t, left, problem.noise["u"].sigma / base.model.m, motion)

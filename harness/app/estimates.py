"""Estimates of the estimators' room in the form of the results."""

from collections.abc import Mapping

from harness.estimate.result import Estimate, Estimation
from harness.results.common import P
from harness.results.run import Estimates


def estimates_of(estimation: Estimation) -> dict[str, Estimates]:
    """Every method's estimate by its name."""
    return {method: _of(estimate) for method, estimate in estimation.methods.items()}


def _of(estimate: Estimate) -> Estimates:
    return Estimates(
        omega_n=P.of(estimate.omega_n),
        zeta=P.of(estimate.zeta),
        x_k=P.of(estimate.x_k),
        reversals=estimate.reversals,
        per_reversal=[reversal.as_dict() for reversal in estimate.per_reversal],
        guard_s=estimate.guard,
        lead_s=None if estimate.lead is None else P.of(estimate.lead),
        notes=list(estimate.notes),
    )


def refused_everywhere(methods: Mapping[str, Estimate]) -> str | None:
    """The reason when no method gives a single figure, else None."""
    figures = [q for estimate in methods.values() for q in (estimate.omega_n, estimate.zeta, estimate.x_k)]
    if any(figure.value is not None for figure in figures):
        return None
    return next((figure.why for figure in figures if figure.why), "no method gives a figure")

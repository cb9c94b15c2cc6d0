"""Estimates of the estimators' room in the form of the results."""

from collections.abc import Container, Mapping

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


WHOLE = {"acceleration": ("a", "v"), "displacement": ("x",)}
"""Methods that know both viscous and dry friction, with the channels they read; where they fail, nothing else holds."""


def why_no_decay(methods: Mapping[str, Estimate], channels: Container[str]) -> str | None:
    """The reasons why no method of the whole model gives a figure from these channels; None when one does."""
    tried = [methods[name] for name, wanted in WHOLE.items() if any(channel in channels for channel in wanted)]
    if any(estimate.zeta.value is not None and estimate.x_k.value is not None for estimate in tried):
        return None
    return "; ".join(dict.fromkeys(estimate.x_k.why or "" for estimate in tried))

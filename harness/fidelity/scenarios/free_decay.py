"""The paper's case: a release with viscous and dry friction."""

from harness.fidelity import figure
from harness.fidelity.figure import Figure
from harness.fidelity.kinds.decay import DecayKind

SCENARIO = DecayKind(
    name="free-decay",
    place=0,
    duration=3.5,
    shown=3.0,
    figures=(
        Figure("position", "max_error_m", figure.release, "position error, over the release; at best the integrator's"),
        Figure("x_k wide", "x_k_rel_error", figure.one, "friction as read outside a guard at each reversal"),
        Figure("x_k narrow", "x_k_local_rel_error", figure.one, "friction as read at the reversal itself"),
        Figure("zeta", "zeta_rel_error", figure.one, "damping ratio as the estimator reads it"),
        Figure("lead", "reversal_lead_s", figure.period, "friction reverses before the speed, over the period"),
        Figure("rest", "rest_error_m", figure.x_k, "place of rest, over x_k"),
        Figure("energy", "energy_error", figure.one, "largest error of the energy balance, over the start's"),
        Figure("lift", "lift_m", figure.release, "contact: height over the floor, over the release"),
    ),
)

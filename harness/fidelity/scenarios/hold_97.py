"""A load of 97 % of break-away."""

from harness.fidelity.figure import Figure
from harness.fidelity.kinds.hold import HoldKind, creep_scale

SCENARIO = HoldKind(
    name="hold-97",
    place=3,
    share=0.97,
    figures=(Figure("creep 97 %", "creep_m_s", creep_scale, "creep in one period at 97 % of break-away, over x_k"),),
)

"""A load of half of break-away."""

from harness.fidelity.figure import Figure
from harness.fidelity.kinds.hold import HoldKind, creep_scale

SCENARIO = HoldKind(
    name="hold-50",
    place=2,
    share=0.5,
    figures=(Figure("creep 50 %", "creep_m_s", creep_scale, "creep in one period at half of break-away, over x_k"),),
)

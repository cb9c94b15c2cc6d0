"""The scale of the displacement is curved: the perspective of a camera, a sensor that is not linear."""

from harness.core.arrays import FloatArray
from harness.model.term import Parameter, Probe, Sensor, Shown, Slot, Term, always


def read(values: Probe, t: FloatArray, y: FloatArray, rate: FloatArray) -> Shown:
    """x is read as x + q x^2, x from where the restoring force is nil."""
    return Shown(y + values[0] * y**2, 1.0 + 2.0 * values[0] * y, (y**2,))


TERM = Term(
    "sensor-curvature",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("q", "1/m", none=0.0),),
    "The scale of the displacement is curved, as perspective curves a camera's: x is read as x + q x^2, q = {q}.",
    amplitude=0,
    channels=("x",),
    needs=("returns", "spring"),
    example=(0.05,),
    place=always("large-displacement", "as x^2"),
    sensor=Sensor("x", read),
    order=275,
)

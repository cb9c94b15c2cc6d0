"""What is simulated: a slider, how it starts, what drives it, for how long."""

from dataclasses import dataclass

from harness.core.checks import finite, positive
from harness.core.slider import PAPER, Slider


@dataclass(frozen=True, slots=True)
class Harmonic:
    """A driving force amplitude * cos(omega t + phase), N."""

    amplitude: float
    omega: float
    phase: float = 0.0

    def __post_init__(self) -> None:
        finite("drive: amplitude", self.amplitude)
        positive("drive: omega", self.omega, "rad/s")
        finite("drive: phase", self.phase)


@dataclass(frozen=True, slots=True)
class Hold:
    """A constant load on a slider at rest with its spring relaxed: force in N."""

    force: float

    def __post_init__(self) -> None:
        finite("hold: force", self.force)


@dataclass(frozen=True, slots=True)
class Belt:
    """The floor under the slider moves at this speed, m/s."""

    speed: float

    def __post_init__(self) -> None:
        positive("belt: speed", self.speed, "m/s")


@dataclass(frozen=True, slots=True)
class Scenario:
    """A run that can be done by the reference and by any engine.

    x0 : start in m. v0 : start in m/s. duration : s. action : what acts besides the slider's own forces.
    """

    name: str
    slider: Slider
    x0: float = 1.0
    v0: float = 0.0
    duration: float = 3.0
    action: Harmonic | Hold | Belt | None = None

    def __post_init__(self) -> None:
        finite("scenario: x0", self.x0)
        finite("scenario: v0", self.v0)
        positive("scenario: duration", self.duration, "s")

    @property
    def omega(self) -> float:
        """Of its swing, rad/s."""
        return self.slider.omega_n


FREE_DECAY = Scenario("free-decay", PAPER)
"""The paper's numerical example, long enough to watch it rest."""

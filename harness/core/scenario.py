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
class CurveBelt(Belt):
    """A belt whose friction is a curve over the sliding speed u = v - speed.

    A level f_k + (f_s - f_k) exp(-(u/v_s)^2) of the slider's f_k and f_s, which is all that holds it at u = 0, and
    c_2 u|u| + c_3 u^3 beside it. v_s : m/s. c_2 : N s^2/m^2. c_3 : N s^3/m^3.
    """

    v_s: float = 0.05
    c_2: float = 0.0
    c_3: float = 0.0

    def __post_init__(self) -> None:
        super(CurveBelt, self).__post_init__()  # with slots the class is not the one that super() knows
        positive("belt: v_s", self.v_s, "m/s")
        finite("belt: c_2", self.c_2)
        finite("belt: c_3", self.c_3)


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid body with all six freedoms under gravity, in place of the slider on its spring: m and f_k are its own.

    place : "slope" (gravity is tilted along x), "grip" (between two fingers), "floor" (rolls along x, or spins about z
    at a rim speed of v0). shape : box, cylinder (standing) or sphere; size : its half height and radius, m. mu :
    coefficient of sliding friction. mu_t, mu_r : torsional and rolling, m. condim : which of them act, in MuJoCo's
    count (1 none, 3 sliding, 4 and torsional, 6 and rolling). load : what is asked of friction, over what there is.
    pair : the contact's friction is said of the pair, not of both geoms. spins : it spins. x is the way along the
    slope, down, along the floor, or the rim's.
    """

    place: str
    shape: str = "box"
    size: float = 0.05
    mu: float = 0.5
    mu_t: float = 0.005
    mu_r: float = 0.002
    condim: int = 3
    load: float = 0.0
    pair: bool = False
    spins: bool = False

    def __post_init__(self) -> None:
        for name in ("size", "mu", "mu_t", "mu_r"):
            positive(f"body: {name}", getattr(self, name), "")


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
    action: Harmonic | Hold | Belt | Body | None = None

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

"""The closed form against 50 digits, the paper's printed figures, the cases that have no reversal; batches of it."""

import math

import mpmath as mp
import numpy as np
import pytest
from exact_mp import HighPrecisionDecay

from benchmarks.exact_batch import fill_batch, stack
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.events import EventKind, Mode
from harness.core.scenario import FREE_DECAY, Hold, Scenario
from harness.core.slider import PAPER, Slider
from harness.exact.decay import Decay, fill_at, fill_uniform, free_decay, never_sticks, schedule

PAPER_TURNING_POINTS = [
    1, -0.7988338562165538, 0.6269438451936182, -0.48006934964594244, 0.35456980889888967, -0.24733448074343986,
    0.15570533583856455, -0.07741117345368495, 0.01051132548594804,
]  # fmt: skip


def draw(rng: np.random.Generator, kind: str) -> Decay:
    """A random slider of one kind; scales of length and time vary over orders of magnitude."""
    omega_n = 10 ** rng.uniform(-1, 3)
    x0 = 10 ** rng.uniform(-4, 2) * rng.choice([-1, 1])
    zeta = {
        "undamped": 0.0,
        "light": rng.uniform(0, 0.1),
        "damped": rng.uniform(0.1, 0.99),
        "critical": 1.0,
        "near": 1.0 + rng.choice([-1, 1]) * 10 ** rng.uniform(-15, -2),
        "over": rng.uniform(1, 20),
    }[kind]
    x_k = abs(x0) * (rng.uniform(0.004, 0.3) if rng.random() < 0.8 else 0.0)
    x_s = x_k * (1.0 if rng.random() < 0.5 else rng.uniform(1, 2))
    v0 = 0.0 if rng.random() < 0.4 else omega_n * x0 * rng.normal() * 2
    return Decay(omega_n, zeta, x_k, x0, v0, x_s)


def scale(decay: Decay) -> float:
    """X_0: the largest displacement the start can lead to."""
    return max(abs(decay.x0), abs(decay.v0) / decay.omega_n, decay.x_k)


def away_from_events(truth: HighPrecisionDecay, t: FloatArray) -> FloatArray:
    begins = np.array([float(p.begin) for p in truth.pieces])
    kept: FloatArray = t[np.min(np.abs(t[:, None] - begins[None, :]), axis=1) > 1e-9]
    return kept


def worst(decay: Decay, truth: HighPrecisionDecay, t: FloatArray) -> float:
    """Largest error over x, v, a in units of X_0, X_0 omega_n, X_0 omega_n^2, alone and among many other samples."""
    exact = [truth(float(time)) for time in t]
    unit = scale(decay)
    many = np.sort(np.concatenate((t, np.linspace(0.0, t[-1], 700))))
    error = 0.0
    for times in (t, many):
        x, v, a = np.empty((3, times.size))
        fill_at(decay, times, x, v, a)
        for j, e in zip(np.searchsorted(times, t), exact, strict=True):
            error = max(
                error,
                abs(float(x[j] - e[0])) / unit,
                abs(float(v[j] - e[1])) / (unit * decay.omega_n),
                abs(float(a[j] - e[2])) / (unit * decay.omega_n**2),
            )
    return error


def decidable(truth: HighPrecisionDecay) -> bool:
    """No turning point so close to x_s that rounding decides whether it sticks."""
    return all(abs(abs(x) - truth.x_s) > 1e-12 * max(1, abs(truth.turning[0])) for x in truth.turning)


@pytest.mark.parametrize("draws", [60, pytest.param(2000, marks=pytest.mark.full)])
@pytest.mark.parametrize("kind", ["undamped", "light", "damped", "critical", "near", "over"])
def test_random_sliders_agree_with_fifty_digits(kind: str, draws: int) -> None:
    rng = np.random.default_rng(20260101)
    for _ in range(draws):
        decay = draw(rng, kind)
        truth = HighPrecisionDecay(*decay.arguments, pieces=60)
        if not decidable(truth):
            continue
        end = float(min(truth.pieces[-1].begin * 1.1 + 2 / decay.omega_n, truth.pieces[-1].end))
        t = away_from_events(truth, np.sort(rng.uniform(0, end, 25)))
        assert worst(decay, truth, t) < 1e-12, decay


def test_mass_damping_and_stiffness_lose_nothing_on_the_way() -> None:
    """From m, c, k, f_k, f_s in 50 digits: rounding of omega_n and zeta stays below the accuracy promised."""
    rng = np.random.default_rng(8)
    for _ in range(60):
        m, k = 10 ** rng.uniform(-2, 2, 2)
        c, f_k = 2 * math.sqrt(k * m) * rng.choice([0.0, 0.02, 0.3, 1.0, 4.0]), k * rng.uniform(0.005, 0.1)
        slider = Slider(m, c, k, f_k, f_k * rng.uniform(1, 1.5))
        decay = Decay.of(slider, rng.choice([-1.0, 1.0]), rng.normal() * slider.omega_n)
        with mp.workdps(50):
            root = mp.sqrt(mp.mpf(slider.k) / mp.mpf(slider.m))
            ratio = mp.mpf(slider.c) / (2 * mp.sqrt(mp.mpf(slider.k) * mp.mpf(slider.m)))
            levels = [mp.mpf(force) / mp.mpf(slider.k) for force in (slider.f_k, slider.break_away)]
        truth = HighPrecisionDecay(root, ratio, levels[0], levels[1], decay.x0, decay.v0, pieces=120)
        if decidable(truth):
            end = float(min(truth.pieces[-1].begin + 2 / decay.omega_n, truth.pieces[-1].end))
            t = away_from_events(truth, np.sort(rng.uniform(0, end, 25)))
            assert worst(decay, truth, t) < 1e-12, slider


@pytest.mark.parametrize(("zeta", "x_k"), [(0.0, 0.0), (0.0, 4e-4), (1e-4, 2e-4)])
def test_a_thousand_half_cycles_keep_eleven_digits(zeta: float, x_k: float) -> None:
    decay = Decay(37.7, zeta, x_k, -1.0, 20.0)
    truth = HighPrecisionDecay(*decay.arguments, pieces=1100)
    assert len(truth.pieces) > 1000
    t = np.sort(np.random.default_rng(4).uniform(0, 1001 * math.pi / decay.omega_n, 200))
    assert worst(decay, truth, away_from_events(truth, t)) < 1e-11


@pytest.mark.parametrize("kind", ["undamped", "light", "damped", "critical", "near", "over"])
def test_uniform_grid_equals_the_samples_at_its_times(kind: str) -> None:
    rng = np.random.default_rng(7)
    for _ in range(40):
        decay = draw(rng, kind)
        n = int(rng.integers(1, 3000))
        t0, dt = rng.uniform(-1, 3) / decay.omega_n, rng.uniform(1e-3, 0.1) / decay.omega_n
        t = t0 + np.arange(n, dtype=np.float64) * dt
        x, v, a, x1, v1, a1 = np.empty((6, n))
        fill_uniform(decay, t0, dt, x, v, a)
        fill_at(decay, t, x1, v1, a1)
        unit = scale(decay)
        assert np.max(np.abs(x - x1)) < 1e-12 * unit
        assert np.max(np.abs(v - v1)) < 1e-12 * unit * decay.omega_n
        starts = schedule(decay, max(float(t[-1]), 0.0)).start
        far = np.min(np.abs(t[:, None] - starts), axis=1) > 1e-12 * (1 + abs(t))
        assert np.all(np.abs(a - a1)[far] < 1e-12 * unit * decay.omega_n**2)


def test_the_papers_case_to_fifteen_digits() -> None:
    plan = schedule(Decay.of(PAPER, 1.0))
    truth = HighPrecisionDecay(*Decay.of(PAPER, 1.0).arguments)
    np.testing.assert_allclose(plan.turning_points, PAPER_TURNING_POINTS, rtol=0, atol=1e-15)
    np.testing.assert_allclose(plan.turning_points, [float(x) for x in truth.turning], rtol=0, atol=1e-15)
    assert plan.stick_time == pytest.approx(float(truth.stick_time or 0), rel=1e-15)
    assert plan.stick_time == pytest.approx(2.51642, abs=5e-6)
    run = free_decay(FREE_DECAY, np.linspace(0, 3, 3001))
    assert run.x[-1] == pytest.approx(0.010511325485945064, abs=1e-14)
    assert run.v[-1] == run.a[-1] == 0.0


def test_events_of_the_papers_case() -> None:
    events = schedule(Decay.of(PAPER, 1.0)).events
    assert list(events.kind) == [EventKind.REVERSAL] * 7 + [EventKind.STICK]
    jump = np.abs(events.a_after - events.a_before)[:-1]
    np.testing.assert_allclose(jump, 2 * 0.03 * 100, rtol=1e-13)  # 2 x_k omega_n^2, eq. 11
    assert events.a_after[-1] == 0.0
    np.testing.assert_allclose(np.diff(events.t), math.pi / PAPER.omega_d, rtol=1e-13)


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.7, 1.0, 3.0])
def test_mirror_symmetry(zeta: float) -> None:
    t = np.linspace(0, 3, 301)
    one = free_decay(Decay(10, zeta, 0.02, 0.7, -3.0, 0.03), t)
    two = free_decay(Decay(10, zeta, 0.02, -0.7, 3.0, 0.03), t)
    assert one.mode is not None
    assert two.mode is not None
    for first, second in ((one.x, two.x), (one.v, two.v), (one.a, two.a), (one.mode, two.mode)):
        np.testing.assert_array_equal(first, -second)


def test_energy_lost_is_the_work_of_friction() -> None:
    plan = schedule(Decay(10.0, 0.0, 0.02, 1.0, 5.0))
    energy = 0.5 * plan.v**2 + 50.0 * plan.x**2
    np.testing.assert_allclose(-np.diff(energy), 2.0 * np.abs(np.diff(plan.x)), rtol=1e-12)


@pytest.mark.parametrize(
    "decay",
    [
        Decay(10, 0.05, 0.0, 1.0),
        Decay(10, 0.0, 0.0, 1.0, x_s=0.5),
        Decay(10, 1.0, 0.03, 1.0),
        Decay(10, 2.0, 0.03, -1.0),
        Decay(10, 1.5, 0.03, 1.0, 30.0),
        Decay(10, 1.5, 0.03, 1.0, -5.0),
    ],
)
def test_what_never_sticks(decay: Decay) -> None:
    assert never_sticks(decay)
    plan = schedule(decay, 50.0)
    assert plan.stick_time is None
    assert len(plan.events.of(EventKind.STICK)) == 0


def test_overdamped_release_tends_to_the_kinetic_level() -> None:
    run = free_decay(Decay(10, 2.0, 0.03, -1.0), np.array([0.0, 20.0]))
    assert run.x[-1] == pytest.approx(-0.03, abs=1e-15)
    assert run.mode is not None
    assert list(run.mode) == [Mode.SLIP_POSITIVE] * 2


def test_overdamped_knock_turns_once_and_sticks() -> None:
    plan = schedule(Decay(10, 2.0, 0.03, 0.0, 1.0))
    assert list(plan.direction) == [1, 0]
    assert 0.0 < plan.x[-1] <= 0.03
    assert plan.stick_time == plan.start[-1]


@pytest.mark.parametrize("x0", [0.05, -0.05, 0.0])
def test_stuck_from_the_start(x0: float) -> None:
    run = free_decay(Decay(10, 0.1, 0.03, x0, x_s=0.05), np.linspace(-1, 1, 5))
    assert np.all(run.x == x0)
    assert np.all(run.v == 0.0)
    assert np.all(run.mode == Mode.STICK)
    assert schedule(Decay(10, 0.1, 0.03, x0, x_s=0.05)).stick_time == 0.0
    assert list(run.events.kind) == [EventKind.STICK]


def test_held_before_the_start() -> None:
    run = free_decay(Decay(10, 0.1, 0.03, 1.0), np.array([-0.5, -1e-9, 0.0, 0.1]))
    assert list(run.x[:3]) == [1.0, 1.0, 1.0]
    assert run.a[1] == 0.0
    assert run.a[2] == pytest.approx(-100 * 0.97)
    assert list(run.mode if run.mode is not None else []) == [0, 0, -1, -1]


def test_higher_break_away_sticks_earlier_at_the_same_turning_points() -> None:
    base, sticky = schedule(Decay.of(PAPER, 1.0)), schedule(Decay.of(Slider(1, 1, 100, 3, 16), 1.0))
    n = sticky.turning_points.size
    assert n == 7
    np.testing.assert_array_equal(sticky.turning_points, base.turning_points[:n])


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Decay(0, 0.1, 0.1), "decay: omega_n: 0; expected a number above 0 rad/s"),
        (lambda: Decay(1, -0.1, 0.1), "decay: zeta: -0.1; expected 0 or more"),
        (lambda: Decay(1, 0.1, 0.1, x_s=0.05), "decay: x_s: 0.05 m, below x_k = 0.1 m; expected x_s >= x_k"),
        (lambda: Decay(1, 0.1, 0.1, math.nan), "decay: x0: nan; expected a finite number"),
        (
            lambda: schedule(Decay(1, 0.1, 0.0)),
            "schedule: until: none, for a slider that never sticks; expected a time in s",
        ),
        (lambda: schedule(Decay(1, 0.1, 0.1), -1.0), "schedule: until: -1.0; expected a time of 0 s or more"),
        (
            lambda: schedule(Decay(1, 0.0, 0.0), 1e9),
            "free decay: more than ten million half-cycles; expected a shorter time",
        ),
        (lambda: free_decay(Decay(1, 0.1, 0.1), np.array([0.0, 0.0])), "free decay: t, row 2: time 0 s does not come"),
        (
            lambda: free_decay(Scenario("hold", PAPER, action=Hold(1.0)), np.array([0.0, 1.0])),
            "scenario hold: an acting force or belt; expected a free decay",
        ),
    ],
)
def test_bad_input(build: object, message: str) -> None:
    assert callable(build)
    with pytest.raises(InputError) as caught:
        build()
    assert str(caught.value).startswith(message)


def sliders(n: int) -> list[Decay]:
    rng = np.random.default_rng(3)
    return [
        Decay(rng.uniform(1, 50), rng.uniform(0, 1.3), rng.uniform(0, 0.1), rng.normal(), rng.normal(), 0.1)
        for _ in range(n)
    ]


@pytest.mark.parametrize("threads", [None, 1, 2, 5])
def test_every_row_is_bitwise_the_single_decay(threads: int | None) -> None:
    decays = sliders(23)
    x, v, a = np.empty((3, len(decays), 157))
    fill_batch(stack(decays), -0.1, 0.01, x, v, a, threads)
    for i, decay in enumerate(decays):
        one = np.empty((3, 157))
        fill_uniform(decay, -0.1, 0.01, *one)
        np.testing.assert_array_equal(one, np.stack([x[i], v[i], a[i]]))


def test_the_row_that_is_no_slider_is_named() -> None:
    parameters = stack(sliders(4))
    parameters[2, 1] = -0.5
    with pytest.raises(InputError, match=r"^batch, row 3, decay: zeta: -0.5; expected 0 or more$"):
        fill_batch(parameters, 0.0, 0.1, *np.empty((3, 4, 5)))


def test_shapes_are_checked() -> None:
    with pytest.raises(InputError, match=r"batch: parameters: shape \(4, 5\)"):
        fill_batch(np.ones((4, 5)), 0.0, 0.1, *np.empty((3, 4, 5)))
    with pytest.raises(InputError, match=r"contiguous float64 of shape \(4, 5\)"):
        fill_batch(stack(sliders(4)), 0.0, 0.1, np.empty((4, 5)), np.empty((4, 5)), np.empty((3, 5)))

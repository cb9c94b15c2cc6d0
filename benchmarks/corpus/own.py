"""Own draws: decays of each kind of effect, pairs, controls, pendulums, driven sliders, logs that hold no motion."""

import math
import zlib
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

import harness
from benchmarks.corpus.case import Case, Truth
from benchmarks.corpus.plant import Floats, Sensor, Slider

SEED = 20261127
_EFFECTS: Mapping[str, tuple[str, Callable[[float, float, float], Mapping[str, float]]]] = {
    # each as a share of what the base does at the first swing: omega, amplitude, decrement of friction x_k
    "stribeck": ("x", lambda w, x, d: {"f_s": 1.9 * w * w * d, "v_s": 0.45 * w * x}),
    "position-dependent-friction": ("x", lambda w, x, d: {"f_slope": 0.8 / x}),
    "quadratic-drag": ("x", lambda w, x, d: {"drag": 0.06 / x}),
    "asymmetric-viscous": ("xa", lambda w, x, d: {"asymmetric": 0.03 * w}),
    "power-law-damping": ("xa", lambda w, x, d: {"power": 0.02 * w * math.sqrt(w * x), "exponent": 0.5}),
    "cubic-stiffness": ("x", lambda w, x, d: {"k3": 0.12 * (w / x) ** 2}),
    "quadratic-stiffness": ("x", lambda w, x, d: {"k2": 0.10 * w * w / x}),
    "end-stop": ("x", lambda w, x, d: {"gap_stop": 0.75 * x, "k_stop": 0.8 * w * w}),
    "backlash": ("x", lambda w, x, d: {"gap_play": 0.03 * x}),
    "stiffness-drift": ("x", lambda w, x, d: {"k_drift": 0.0016 * w}),
    "constant-force": ("x", lambda w, x, d: {"force": 0.04 * w * w * x}),
    "force-ripple": ("xa", lambda w, x, d: {"ripple": 0.03 * w * w * x, "ripple_period": 0.22 * x}),
    "harmonic-force": ("x", lambda w, x, d: {"hum": 0.05 * w * w * x, "hum_omega": 2.7 * w}),
    "impulse": ("x", lambda w, x, d: {"knock_t": 17.3 / w, "knock": 0.15 * w * x}),
    "friction-drift": ("x", lambda w, x, d: {"f_drift": 0.02 * w}),
    "normal-load-variation": ("xa", lambda w, x, d: {"f_depth": 0.6, "f_omega": 0.37 * w}),
}
_SENSED: Mapping[str, Callable[[float, float], Mapping[str, float]]] = {
    "sensor-lag": lambda w, x: {"lag": 0.03 / w},
    "sensor-gain": lambda w, x: {"gain": 1.04},
    "sensor-bias": lambda w, x: {"bias": 0.02 * w * w * x},
    "sensor-drift": lambda w, x: {"drift": 0.002 * w * x},
    "sensor-clipping": lambda w, x: {"clip": 0.75 * w * w * x},
}
_PAIRS = (
    ("quadratic-drag", "stribeck"),
    ("cubic-stiffness", "quadratic-drag"),
    ("constant-force", "sensor-lag"),
    ("cubic-stiffness", "sensor-gain"),
    ("quadratic-drag", "constant-force"),
    ("end-stop", "quadratic-drag"),
    ("harmonic-force", "cubic-stiffness"),
    ("stiffness-drift", "sensor-bias"),
)


def _draw(name: str) -> np.random.Generator:
    return np.random.default_rng([SEED, zlib.crc32(name.encode())])


def recording(name: str, effects: tuple[str, ...], quiet: Mapping[str, float] | None = None) -> harness.Recording:
    """A decay with some effects; the same name gives the same samples. quiet : nuisances of the sensor."""
    draw = _draw(name)
    omega, x0 = float(draw.uniform(4.0, 40.0)), float(10.0 ** draw.uniform(-2.3, 0.0))
    x_k, zeta = x0 * float(draw.uniform(0.004, 0.012)), float(draw.uniform(0.002, 0.012))
    numbers = {"omega2": omega**2, "c": 2.0 * zeta * omega, "f_k": omega**2 * x_k}
    sensed: dict[str, float] = {}
    channels = "x"
    for effect in effects:
        if effect in _SENSED:
            sensed |= _SENSED[effect](omega, x0)
            channels = "xa"
        else:
            needed, law = _EFFECTS[effect]
            numbers |= law(omega, x0, x_k)
            channels = "xa" if needed == "xa" else channels
    noise = float(draw.uniform(2e-4, 8e-4))
    levels = {"x": noise * x0, "a": 4.0 * noise * omega**2 * x0}
    sensor = Sensor({c: levels[c] for c in channels}, **sensed, **(quiet or {}))
    t = np.arange(12 * 70, dtype=np.float64) * (2.0 * math.pi / omega / 70.0)
    return _recorded(name, Slider(numbers, x0), sensor, t, draw)


def _recorded(name: str, slider: Slider, sensor: Sensor, t: Floats, draw: np.random.Generator) -> harness.Recording:
    shown = sensor.read(t, *slider.motion(t), draw)
    shown.pop("t")
    if slider.u is not None:
        shown["u"] = slider.u
    return harness.Recording(t, shown, file=name)


def _driven(name: str, effects: Mapping[str, float]) -> harness.Recording:
    """A unit mass on a spring under a held force of three tones."""
    draw = _draw(name)
    t = np.arange(6000, dtype=np.float64) * 2e-3
    u = np.zeros_like(t)
    for size, hertz in ((9.0, 0.35), (6.0, 0.9), (3.0, 2.3)):
        u += size * np.sin(2.0 * math.pi * hertz * t + draw.uniform(0.0, 6.0))
    slider = Slider({"omega2": 60.0, "c": 0.8, "f_k": 1.2, **effects}, 0.0, u=u)
    return _recorded(name, slider, Sensor({"x": 2e-5}), t, draw)


def _pendulum(name: str, effects: Mapping[str, float]) -> harness.Recording:
    draw = _draw(name)
    omega = float(draw.uniform(4.0, 8.0))
    t = np.arange(1200, dtype=np.float64) * (2.0 * math.pi / omega / 60.0)
    numbers = {"omega2": omega**2, "c": 0.008 * omega, "f_k": 0.004 * omega**2, "pendulum": 1.0, **effects}
    found = _recorded(name, Slider(numbers, 0.9), Sensor({"x": 5e-4}), t, draw)
    return harness.Recording(found.t, found.channels, file=name, units={"x": "rad"}, angular=True)


def _still(name: str, kind: str) -> harness.Recording:
    draw = _draw(name)
    t = np.arange(1000, dtype=np.float64) * 5e-3
    x = draw.normal(0.0, 1e-3, t.size)
    if kind == "stuck":
        x = np.where(t < 0.4, np.exp(-t) * np.cos(20.0 * t), 0.3) + 0.01 * x
    return harness.Recording(t, {"x": x}, file=name)


def cases() -> Iterator[Case]:
    """All of them, in an order that stays."""

    def decay(name: str, kind: str, truth: Truth, made: Callable[[], harness.Recording], **options: Any) -> Case:
        return Case(name, kind, lambda: harness.diagnose(made(), engines=(), **options), truth, own=True)

    for effect in (*_EFFECTS, *_SENSED):
        for number in (1, 2):
            name = f"own/{effect}-{number}"
            yield decay(
                name,
                "own single",
                Truth(effect, (effect,)),
                lambda name=name, effect=effect: recording(name, (effect,)),  # type: ignore[misc]
                zero="spring",
            )
    for pair in _PAIRS:
        name = f"own/{pair[0]}+{pair[1]}"
        yield decay(
            name,
            "own pair",
            Truth(" and ".join(pair), pair),
            lambda name=name, pair=pair: recording(name, pair),  # type: ignore[misc]
            zero="spring",
        )
    nuisances: tuple[Mapping[str, float], ...] = ({}, {"phi": 0.8}, {"step": 1e-3}, {"zero": 0.02})
    for number in range(12):
        name, quiet = f"own/control-{number}", nuisances[number % len(nuisances)]
        yield decay(
            name,
            "own control",
            Truth("nothing is missing", quiet=True),
            lambda name=name, quiet=quiet: recording(name, (), quiet),  # type: ignore[misc]
        )
    swung: tuple[tuple[Mapping[str, float], tuple[str, ...]], ...] = (
        ({}, ()),
        ({"drag": 0.05}, ("quadratic-drag",)),
        ({"f_slope": 0.5}, ("position-dependent-friction",)),
    )
    for number, (effects, names) in enumerate(swung):
        name = f"own/pendulum-{number}"
        yield decay(
            name,
            "own pendulum",
            Truth(" ".join(names) or "nothing is missing", names, quiet=not names),
            lambda name=name, effects=effects: _pendulum(name, effects),  # type: ignore[misc]
            restoring="pendulum",
        )
    driven: tuple[tuple[Mapping[str, float], tuple[str, ...]], ...] = (
        ({}, ()),
        ({"f_k": 2.0, "c": 0.4}, ()),
        ({"f_k": 0.5, "c": 2.0}, ()),
        ({"f_s": 2.4, "v_s": 0.08}, ("stribeck",)),
        ({"drag": 0.9}, ("quadratic-drag",)),
        ({"k3": 180.0}, ("cubic-stiffness",)),
    )
    for number, (effects, names) in enumerate(driven):
        name = f"own/driven-{number}"
        yield decay(
            name,
            "own driven",
            Truth(" ".join(names) or "nothing is missing", names, quiet=not names),
            lambda name=name, effects=effects: _driven(name, effects),  # type: ignore[misc]
            mass=1.0,
        )
    for number, kind in enumerate(("noise", "noise", "stuck")):
        name = f"own/no-motion-{number}"
        yield Case(
            name,
            "bad log",
            lambda name=name, kind=kind: harness.diagnose(_still(name, kind), engines=()),  # type: ignore[misc]
            Truth("no motion that tells friction", verdict=("error", "unexplained")),
            own=True,
        )
    for number in range(4):
        name = f"own/identify-{number}"
        yield Case(name, "own identify", lambda name=name: harness.identify(recording(name, ())), None, own=True)  # type: ignore[misc]

"""The paper's experiment, simulated, in the form of its Table 1: ``python -m benchmarks.table1``.

The slider of the paper's section 4 is released five times from slightly different places. The accelerometer leads the
displacement sensor by the paper's 0.216 rad and both have white noise. What the paper measured is not known to us;
noise and sampling are ours and are printed, so the spread is to be compared between methods, not with the paper.
"""

import math
import sys
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.slider import EXPERIMENT, Slider
from harness.estimate.channel import fit_channel
from harness.estimate.every import estimate_all
from harness.estimate.paper import by_differences, by_sums, mean_of
from harness.estimate.result import Estimate, quantity
from harness.estimate.reversals import Kind
from harness.estimate.tied import value_at

PHASE = 0.216
"""Lead of the accelerometer before the displacement sensor, rad (Liang, section 4.3)."""


@dataclass(frozen=True, slots=True)
class Setup:
    """What is simulated. rate : Hz. noise_a : m/s^2. noise_x : m. starts : releases, m. seed : of the noise."""

    rate: float = 1000.0
    noise_a: float = 0.05
    noise_x: float = 2e-5
    starts: tuple[float, ...] = (5.0e-3, 5.2e-3, 5.4e-3, 5.1e-3, 5.3e-3)
    seed: int = 1


def release(
    slider: Slider, start: float, setup: Setup, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """t, x, a of one release from ``start`` m: held for 0.2 s, free, then at rest; x late by the sensors' phase."""
    sigma, omega, omega_n = slider.zeta * slider.omega_n, slider.omega_d, slider.omega_n
    turning, count = start, 0
    while abs(turning) > slider.x_s:
        turning = -slider.q * turning + (1.0 + slider.q) * slider.x_k * math.copysign(1.0, turning)
        count += 1
    begin = 0.2
    t = np.arange(0.0, begin + (count + 4) * math.pi / omega, 1.0 / setup.rate)
    theta = np.array([sigma, omega, omega_n**2 * slider.x_k, omega_n**2 * (start - slider.x_k), begin, 0.0])
    late = theta.copy()
    late[4] += PHASE / omega
    x = value_at(t, Kind.DISPLACEMENT, late, 1, count)
    x[np.isnan(x) & (t < late[4])] = start
    x[np.isnan(x)] = turning
    a = np.nan_to_num(value_at(t, Kind.ACCELERATION, theta, 1, count))
    return t, x + setup.noise_x * rng.standard_normal(t.size), a + setup.noise_a * rng.standard_normal(t.size)


def displacement_paper(
    t: FloatArray, x: FloatArray, edges: FloatArray, omega_d: tuple[float, float], unit: str = "m"
) -> Estimate:
    """The displacement decrement as the paper used it: largest samples, eqs. 7 and 8 and then 6, first period
    dropped, averaged.

    Arguments as for acceleration_paper, x (n,) in m. Kept for the table that compares with the paper's.
    """
    half = math.pi / omega_d[0]
    times = edges[edges > edges[0] + 1.5 * half]
    turning = []
    for time in times:
        part = x[slice(*np.searchsorted(t, [time - 0.25 * half, time + 0.25 * half]))]
        turning.append(float(part[np.argmax(np.abs(part))]) if part.size else math.nan)
    points = np.array(turning)
    zeta = mean_of(np.concatenate([by_sums(points), by_differences(points)]), "1", "eqs. 7 and 8")
    if zeta.value is None or abs(zeta.value) >= 1.0:
        return Estimate.refused("eqs. 7 and 8 gave no damping ratio", unit)
    root = math.sqrt(1.0 - zeta.value**2)
    q = math.exp(-math.pi * zeta.value / root)
    single = np.sign(points[:-1]) * (points[1:] + q * points[:-1]) / (1.0 + q)
    omega_n = omega_d[0] / root
    return Estimate(quantity(omega_n, omega_d[1] / root, "rad/s"), zeta, mean_of(single, unit, "eq. 6"), points.size)


Figures = dict[str, list[tuple[float, float]]]


def run(slider: Slider = EXPERIMENT, setup: Setup | None = None) -> tuple[Figures, list[float]]:
    """(x_k in m, zeta) of every release for each of four methods, and the sensor phases in rad."""
    setup = setup or Setup()
    rng = np.random.default_rng(setup.seed)
    figures: Figures = {"acceleration": [], "acceleration-paper": [], "displacement": [], "displacement-paper": []}
    phases = []
    for start in setup.starts:
        t, x, a = release(slider, start, setup, rng)
        every = estimate_all(t, x=x, a=a)
        fit = fit_channel(t, x, Kind.DISPLACEMENT)
        found = dict(every.methods) | {"displacement-paper": displacement_paper(t, x, fit.edges, (fit.omega, 0.0))}
        for name, rows in figures.items():
            x_k, zeta = found[name].x_k.value, found[name].zeta.value
            rows.append((math.nan if x_k is None else x_k, math.nan if zeta is None else zeta))
        phases.append(math.nan if every.sensor_phase.value is None else every.sensor_phase.value)
    return figures, phases


def table(
    slider: Slider = EXPERIMENT, setup: Setup | None = None, found: tuple[Figures, list[float]] | None = None
) -> str:
    """Table 1 as text: rows of x_k (mm) and zeta by release, mean, reference, standard deviation and error.

    found : what ``run`` gave for these, where it has been run already.
    """
    setup = setup or Setup()
    figures, phases = found or run(slider, setup)
    head = "".join(f"{f'Test {i + 1}':>9}" for i in range(len(setup.starts)))
    lines = [
        f"m={slider.m} kg, k={slider.k:g} N/m, c={slider.c} N s/m, f_k={slider.f_k} N; {setup.rate:g} Hz,"
        f" noise {setup.noise_a} m/s^2 and {setup.noise_x * 1e3:g} mm, seed {setup.seed}",
        "",
        f"{'':<26}{head}{'Average':>10}{'Reference':>11}{'Std (%)':>9}{'Error (%)':>11}",
    ]
    for name, pairs in figures.items():
        for column, (label, scale, exact) in enumerate((("x_k mm", 1e3, slider.x_k), ("zeta", 1.0, slider.zeta))):
            values = np.array([pair[column] for pair in pairs]) * scale
            mean, truth = float(np.mean(values)), exact * scale
            digits = "".join(f"{value:9.4f}" for value in values)
            spread, error = 100.0 * float(np.std(values, ddof=1)) / mean, 100.0 * (mean / truth - 1.0)
            lines.append(f"{name + ' ' + label:<26}{digits}{mean:10.4f}{truth:11.4f}{spread:9.2f}{error:11.2f}")
    lines += ["", f"sensor phase: {np.mean(phases):.4f} rad found, {PHASE} rad put in"]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.stdout.write(table() + "\n")

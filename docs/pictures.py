"""Draws docs/pictures/concepts.svg from the exact solution: python docs/pictures.py."""

from pathlib import Path

import numpy as np
from drawing import FIRST, SECOND, Panel, drawing

from harness.core.slider import Slider
from harness.exact.decay import Decay, free_decay

TARGET = Path(__file__).resolve().parent / "pictures" / "concepts.svg"
SLIDER = Slider(m=1.0, c=0.6, k=100.0, f_k=8.0)
"""Friction of 8 N on a spring of 100 N/m: x_k = 80 mm, large enough to be seen."""
END = 2.4


def text() -> str:
    """Position and acceleration of a decay from 1 m; friction as a length above, as jumps below."""
    t = np.linspace(0.0, END, 961)
    trace = free_decay(Decay(SLIDER.omega_n, SLIDER.zeta, SLIDER.x_k), t)
    turns = np.flatnonzero(np.diff(np.sign(trace.v[1:])) != 0) + 1
    turns = turns[t[turns] < END]
    x_k = SLIDER.x_k
    above = Panel((58, 30, 570, 190), (0.0, END), (-1.0, 1.0))
    above.band(-x_k, x_k, SECOND)
    half = 0.5 * 2.0 * np.pi / SLIDER.omega_d
    for i in range(4):
        centre = x_k if i % 2 == 0 else -x_k
        above.line((i * half, (i + 1) * half), (centre, centre), SECOND, 1.6)
    above.line(t.tolist(), trace.x.tolist(), FIRST, 2.0)
    above.text(END, 0.28, "each half-cycle swings about +x_k or -x_k", SECOND, "end")
    above.text(END, -0.22, "inside the band it can rest", SECOND, "end")
    above.text(0.68, 0.6, "a turning point", FIRST)
    above.frame(f"position x, m; x_k = f_k / k = {SLIDER.f_k:g} N / {SLIDER.k:g} N/m = {1e3 * x_k:g} mm")
    below = Panel((58, 268, 570, 190), (0.0, END), (-100.0, 100.0))
    below.line(t.tolist(), trace.a.tolist(), FIRST, 1.6)
    at = int(turns[0])
    before, after = trace.a[at - 1], trace.a[at + 2]
    below.line((t[at], t[at]), (before, after), SECOND, 3.0)
    below.text(
        t[at] + 0.07,
        85.0,
        f"friction reverses: a jump of 2 f_k / m = {before - after:.0f} m/s^2",
        SECOND,
    )
    stop = float(t[np.flatnonzero(np.abs(trace.v) > 0.0)[-1]])
    below.text(stop + 0.03, 14.0, "it sticks", FIRST)
    below.frame("acceleration, m/s^2", (0.0, 0.5, 1.0, 1.5, 2.0))
    return drawing(640, 490, "free decay of a slider with dry friction: x_k = f_k / k", (above, below))


if __name__ == "__main__":
    TARGET.parent.mkdir(exist_ok=True)
    TARGET.write_text(text(), encoding="utf-8")

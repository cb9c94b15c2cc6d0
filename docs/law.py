"""Draws docs/pictures/law.svg from the diagnosis of the example: python docs/law.py."""

from pathlib import Path

import numpy as np
from drawing import FIRST, GREY, SECOND, Panel, drawing, rounded

import harness

HERE = Path(__file__).resolve().parent
TARGET = HERE / "pictures" / "law.svg"


def text() -> str:
    """What both models leave of the position, and the law that was found, beside the recording."""
    result = harness.diagnose(HERE / "example" / "rig.csv", engines=())
    t, x = (result.curves["recording"][name] for name in "tx")
    noise = 2e3 * float(result.recording.noise["x"])
    moving = t >= result.refined_model.release.t0
    models = dict(zip(("viscous and Coulomb", "refined"), (SECOND, FIRST), strict=True))
    left = {name: 1e3 * (x - result.curves[name]["x"])[moving] for name in models}
    most = rounded(float(np.max(np.abs(left["viscous and Coulomb"]))))
    above = Panel((58, 30, 570, 170), (float(t[moving][0]), float(t[-1])), (-most, most))
    above.band(-noise, noise, GREY)
    for name, color in models.items():
        above.line(t[moving].tolist(), left[name].tolist(), color, 1.4)
    above.text(float(t[moving][0]), 0.75 * most, "viscous and Coulomb friction", SECOND, dy=-4)
    above.text(float(t[moving][0]), 0.75 * most, f"with {result.mechanisms[0].name}", FIRST, dy=16)
    above.frame("recording minus model, mm; grey: noise", (1, 2, 3, 4, 5, 6))
    (law,) = result.laws
    at, seen = np.array(law.at), np.array(law.seen)
    top = rounded(float(np.max(np.abs(seen))))
    below = Panel((58, 258, 570, 190), (float(at[0]), float(at[-1])), (-top, top))
    for values, color in ((law.base, SECOND), (law.fitted, FIRST)):
        for side in (at < 0.0, at > 0.0):
            below.line(at[side].tolist(), np.array(values)[side].tolist(), color, 2.0)
    for place, value, error in zip(law.at, law.seen, law.stderr, strict=True):
        below.line((place, place), (value - 2.0 * error, value + 2.0 * error), GREY, 5.0)
    below.text(float(at[-1]), -0.7 * top, "bars: the recording, two standard errors", GREY, "end")
    below.frame(f"friction and damping, {law.force_unit}, over speed", (-0.4, -0.2, 0.0, 0.2), law.at_unit)
    return drawing(640, 480, "what both models leave, and the law beside the recording", (above, below))


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")

"""What each term of the catalogue leaves when viscous and Coulomb friction alone are fitted to a motion that has it.

python docs/signatures.py writes docs/terms: a picture of each term, and signatures.json with the other names that
follow the same motion. It takes some minutes; python docs/term_pages.py makes the pages from it.
"""

import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from drawing import FIRST, GREY, SECOND, Panel, drawing, rounded

from harness.core.arrays import FloatArray
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.pipeline import fit_base, search
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.simulated import observe
from harness.estimate.noise import Noise
from harness.model.model import Model, ModelTerm
from harness.model.registry import TERMS
from harness.model.term import Term

FOLDER = Path(__file__).resolve().parent / "terms"
BASE = {"m": 1.0, "c": 0.6, "k": 100.0, "f_k": 2.0, "x0": 1.0, "mass_known": True}
"""The slider for which terms give an example of parameters that matter."""
NOISE = {"x": 1e-3, "a": 0.1}
"""Standard deviations, m and m/s^2: a thousandth of the largest value."""
T = np.linspace(0.0, 6.0, 481)
ALIKE, MOST = 0.5, 4
"""Names are listed that take off so much of what the base leaves beyond noise, and at most so many."""


@dataclass(frozen=True, slots=True)
class Signature:
    """What one term does: the channels as recorded, and as the fitted base model shows them."""

    term: Term
    problem: FreeDecay
    base: Fit

    @property
    def over_noise(self) -> float:
        """chi-square per point of the base fit."""
        return self.base.chi2 / self.base.points


def draws(term: Term) -> bool:
    """Whether a free decay shows it and it is a name to look for."""
    return term.searched and "driven" not in term.needs


def problem_of(term: Term) -> FreeDecay:
    """A free decay with the term at its example values, with noise."""
    model = Model(**BASE, terms=(ModelTerm(term, term.example),))
    silent = {c: np.zeros(T.size) for c in NOISE}
    noise = {c: Noise(sigma, True) for c, sigma in NOISE.items()}
    empty = FreeDecay(T, silent, noise, angular="angle" in term.needs)
    chance = np.random.default_rng(1)
    shown = observe(model, empty).y
    seen: dict[str, FloatArray] = {c: shown[c] + chance.normal(0.0, NOISE[c], T.size) for c in NOISE}
    return FreeDecay(T, seen, noise, angular="angle" in term.needs)


def signature(term: Term) -> Signature:
    """The base model fitted to it."""
    problem = problem_of(term)
    return Signature(term, problem, baseline(problem)[0])


def picture(found: Signature) -> str:
    """The recorded position with the fitted one, and what the fit leaves of position and acceleration."""
    unit = "rad" if found.problem.angular else "m"
    t, panels = T.tolist(), []
    for i, (channel, title) in enumerate((("x", f"position, {unit}"), ("x", ""), ("a", ""))):
        recorded, fitted = found.problem.channels[channel], found.base.shown.y[channel]
        drawn = recorded if i == 0 else recorded - fitted
        factor = 1.0 if i != 1 else 1e3
        top = rounded(factor * max(float(np.max(np.abs(drawn))), 3.0 * NOISE[channel]))
        panel = Panel((58, 28 + 140 * i, 570, 100), (0.0, T[-1]), (-top, top))
        if i == 0:
            panel.line(t, recorded.tolist(), FIRST, 2.2)
            panel.line(t, fitted.tolist(), SECOND, 1.4, "5 4")
            panel.frame(f"{title}: with the term, and the base model (dashed)")
        else:
            panel.band(-2.0 * factor * NOISE[channel], 2.0 * factor * NOISE[channel], GREY)
            panel.line(t, (factor * drawn).tolist(), FIRST, 1.1)
            left = {"x": f"m{unit}", "a": f"{unit}/s^2"}[channel]
            ticks = list(range(7)) if i == 2 else ()
            panel.frame(f"what the fit leaves of {'position' if i == 1 else 'acceleration'}, {left}", ticks)
        panels.append(panel)
    return drawing(640, 440, f"signature of {found.term.key} in a free decay", panels)


def followed(term: Term) -> dict[str, float]:
    """Other names that follow the same motion, with the share of what the base leaves beyond noise that each takes."""
    found = search(fit_base(problem_of(term))).search
    beyond = found.base.chi2 - found.base.points
    shares: dict[str, float] = {}
    for single in found.singles:
        (name,) = {entry.term.name for entry in single.model.terms}
        shares[name] = max(shares.get(name, 0.0), (found.base.chi2 - single.chi2) / beyond)
    ordered = sorted((n for n in shares if n != term.name and shares[n] >= ALIKE), key=lambda n: -shares[n])
    return {name: round(shares[name], 3) for name in ordered[:MOST]}


def file_name(term: Term) -> str:
    """The picture of a term in docs/terms."""
    return term.key.replace(":", "-") + ".svg"


def main(arguments: list[str]) -> None:
    """Draw and measure terms, all of them where none is named; with --draw only draw."""
    keys = [key for key in arguments if key != "--draw"]
    FOLDER.mkdir(exist_ok=True)
    kept = FOLDER / "signatures.json"
    known = json.loads(kept.read_text(encoding="utf-8")) if kept.is_file() else {}
    for term in TERMS:
        if draws(term) and (not keys or term.key in keys):
            found = signature(term)
            (FOLDER / file_name(term)).write_text(picture(found), encoding="utf-8")
            if "--draw" in arguments:
                continue
            known[term.key] = {"chi2_per_point": float(f"{found.over_noise:.3g}"), "followed_by": followed(term)}
            print(term.key, known[term.key], flush=True)
            ordered = {t.key: known[t.key] for t in TERMS if t.key in known}
            kept.write_text(json.dumps(ordered, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    np.seterr(over="ignore", invalid="ignore")
    main(sys.argv[1:])

"""What is said of a verdict: each verdict's sentence, its cautions, and the recording that would decide."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.diagnosis.explain.sentences import sentence_of
from harness.diagnosis.motion import motion_of
from harness.diagnosis.outcome import Grade, Verdict
from harness.diagnosis.rules import LEAST_CYCLES, MOST_LIKELY, Rule
from harness.model.registry import TERMS


def named(name: str, grade: Grade = Grade.EXPLAINS, share: float | None = None, *others: str) -> Any:
    entry = SimpleNamespace(
        term=SimpleNamespace(name=name, family="damping", repeating=next(t for t in TERMS if t.name == name).repeating)
    )
    alternatives = tuple(SimpleNamespace(name=other) for other in others)
    said = f"{name} is so much."
    return SimpleNamespace(
        name=name, grade=grade, share=share, statement=said, entry=entry, alternatives=alternatives, probability=0.93
    )


def outcome(
    verdict: Verdict, *mechanisms: Any, alone: tuple[int, ...] = (), left: bool = True, rules: tuple[Rule, ...] = ()
) -> Any:
    problem = SimpleNamespace(alone=alone, choices=("It was let go by hand.",))
    remainder = SimpleNamespace(looks_like="what is left looks like noise", over_noise=2.04) if left else None
    return SimpleNamespace(verdict=verdict, mechanisms=mechanisms, problem=problem, remainder=remainder, rules=rules)


MAIN, LISTED, MINOR, TABLE = (
    named("quadratic-drag", Grade.MAIN, 0.91),
    named("stribeck", Grade.ONE_OF, 0.7),
    named("force-ripple", Grade.MINOR, 0.12),
    named("tabulated-stiffness", Grade.TABULATED, 0.5),
)
SENTENCES: list[tuple[Any, tuple[str, ...], str]] = [
    (outcome("adequate"), (), "Viscous and Coulomb friction explain this recording to its noise: nothing is left out"),
    (outcome("adequate", alone=(1, 2)), (), "explain these recordings to their noise"),
    (outcome("missing_physics", named("presliding")), (), "The simulation leaves out presliding: presliding is so"),
    (outcome("missing_physics", named("stribeck"), named("end-stop")), (), "leaves out stribeck and end stop: "),
    (
        outcome("missing_physics", named("stribeck"), named("end-stop")),
        ("stribeck",),
        "The simulation has stribeck and leaves out end stop: ",
    ),
    (
        outcome("missing_physics", named("stribeck")),
        ("stribeck",),
        "Viscous and Coulomb friction leave out stribeck, which your simulation has: ",
    ),
    (
        outcome("missing_physics", named("stribeck"), rules=(LEAST_CYCLES, MOST_LIKELY)),
        (),
        "Most likely missing: stribeck (P 0.93, explains this recording to its noise): stribeck is so much.",
    ),
    (outcome("main_effect", MAIN), (), "Most likely missing: quadratic drag (P 0.93, 91 % of the misfit): "),
    (
        outcome("main_effect", MAIN, TABLE, left=False),
        ("quadratic-drag",),
        "quadratic drag, which your simulation has (P 0.93, 91 % of the misfit): quadratic-drag is so much.",
    ),
    (
        outcome("one_of", LISTED, named("presliding", Grade.ONE_OF), named("end-stop", Grade.ONE_OF)),
        (),
        "is one of stribeck, presliding or end stop; this recording cannot tell which. The first takes 70 %",
    ),
    (
        outcome("one_of", named("stribeck", Grade.ONE_OF), named("end-stop", Grade.ONE_OF), alone=(1, 2)),
        (),
        "one of stribeck or end stop; these recordings together cannot tell which. The first takes an unknown share of",
    ),
    (
        outcome("one_of", LISTED, named("end-stop", Grade.ONE_OF), alone=(1, 2), left=False),
        (),
        "What the simulation leaves out is one of stribeck or end stop: stribeck explains these recordings to their"
        " noise, the other nearly as well, and these recordings together cannot tell which.",
    ),
    (
        outcome("unexplained", MINOR),
        (),
        "do not explain this recording, and no entry of the catalogue is the main part of what they leave. The largest"
        " single part of it is force ripple (12 %). What is left looks like noise.",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("one", "has", "said"), SENTENCES)
def test_each_verdict_has_its_sentence(one: Any, has: tuple[str, ...], said: str) -> None:
    found = sentence_of(one, has)
    assert said in found
    assert found.endswith(" It was let go by hand.")
    assert "  " not in found
    assert ".." not in found


def test_the_motion_is_told_by_any_channel() -> None:
    t, omega = np.linspace(0.0, 6.0, 1500), 9.0
    x = np.cos(omega * t)
    v, a = -omega * np.sin(omega * t), -(omega**2) * np.cos(omega * t)
    inner = slice(200, -200)
    for channels in ({"x": x}, {"x": x, "v": v}, {"v": v}, {"a": a}):
        found = motion_of(t, channels, omega)
        assert np.max(np.abs(found.x - x)[inner]) < 0.05
        assert np.max(np.abs(found.v - v)[inner]) < 0.05 * omega
        assert not found.stuck.any()
    coarse = motion_of(t[::60], {"x": x[::60]}, omega)
    assert np.max(np.abs(coarse.v)) > 0.7 * omega
    rests = motion_of(t, {"x": np.where(t < 3.0, x, x[750]), "v": np.where(t < 3.0, v, 0.0)}, omega)
    assert rests.stuck[t > 3.01].all()
    assert not rests.stuck[t < 2.9].any()

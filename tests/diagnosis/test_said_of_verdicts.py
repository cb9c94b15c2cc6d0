"""What is said of a verdict: each verdict's sentence, its cautions, and the recording that would decide."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.core.quantity import Quantity
from harness.diagnosis.explain import next_experiment as experiments
from harness.diagnosis.explain.cautions import cautions, cautions_of_misfit
from harness.diagnosis.explain.next_experiment import Open, left_open, left_open_by_grade, next_experiment, to_be_sure
from harness.diagnosis.explain.other_release import Release
from harness.diagnosis.explain.verdict_sentence import sentence_of
from harness.diagnosis.motion import motion_of
from harness.diagnosis.outcome import Grade, Verdict
from harness.diagnosis.pooling import said as pooled_said
from harness.diagnosis.pooling.pooled import Differs
from harness.diagnosis.pooling.said import sentences
from harness.diagnosis.rules import CHANCE, EVEN, LEAST_CYCLES, MOST_LIKELY, SHARE_OF_MISFIT, Rule
from harness.diagnosis.search.search import _beam, _merged
from harness.model.experiments import LARGER
from harness.model.model import Model, ModelTerm
from harness.model.registry import TERMS

DRAG = ModelTerm.named("quadratic-drag", c2=0.2)
STRIBECK = ModelTerm.named("stribeck", f_s=0.5, v_s=0.1)


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


@dataclass
class Fake:
    """A fit by its terms and squares."""

    model: Model
    chi2: float = 500.0
    bic: float = 0.0
    points: int = 100


def of(*terms: ModelTerm, chi2: float = 500.0, bic: float = 0.0) -> Any:
    return Fake(Model(m=1.0, k=50.0, c=0.1, f_k=0.2, x0=1.0, terms=terms), chi2, bic)


def search(spare: float = 0.0, **changed: Any) -> Any:
    problem = SimpleNamespace(spare=spare, given=())
    known = {"base": of(chi2=1100.0), "chosen": of(), "singles": (of(DRAG, chi2=600.0), of(STRIBECK, chi2=850.0))}
    return SimpleNamespace(**{**known, "problem": problem, "rivals": (), "doubted": None, **changed})


def judged(verdict: Verdict, rival: Any = None, *rules: Rule) -> Any:
    return SimpleNamespace(verdict=verdict, rival=rival, rules=rules)


NONE_HELD: Any = SimpleNamespace(refined_rmse={}, baseline_rmse={})


def test_cautions_of_what_nothing_explains_name_the_closest_with_their_shares() -> None:
    first, closest = cautions(search(), judged("unexplained"), NONE_HELD)
    assert first.startswith("no entry or pair of the catalogue explains it")
    assert "quadratic-drag 50 %, stribeck 25 %; none is named" in closest
    assert len(cautions(search(singles=()), judged("unexplained"), NONE_HELD)) == 1
    followed = cautions(search(doubted=of(DRAG, STRIBECK)), judged("unexplained"), NONE_HELD)[0]
    assert followed.startswith("quadratic-drag with stribeck would leave noise alone, but")
    assert len(cautions(search(base=of(chi2=90.0)), judged("unexplained"), NONE_HELD)) == 1
    assert (
        "a force measured with less noise would decide" in cautions(search(1e4), judged("unexplained"), NONE_HELD)[-1]
    )


def test_why_a_law_that_explains_all_is_not_named_and_what_would_decide() -> None:
    found = search(base=of(chi2=600.0), chosen=of(STRIBECK, chi2=500.0))
    found.chosen.shown = SimpleNamespace(v=np.zeros(900))
    found.problem.t, found.problem.turns = np.arange(900.0), lambda v: np.arange(1, 10) * 90
    few, small = cautions(found, judged("one_of", None, LEAST_CYCLES, SHARE_OF_MISFIT), NONE_HELD)
    assert few.startswith("it explains the recording to its noise, but 5 cycles are few")
    assert small.startswith("noise is 83 % of what viscous and Coulomb friction leave")
    assert cautions(found, judged("one_of", None, EVEN), NONE_HELD) == ()
    sure = "To be sure of stribeck: "
    likely = named("stribeck", Grade.MAIN)
    assert to_be_sure([likely, MINOR], (LEAST_CYCLES,), False).startswith(f"{sure}a decay of 8 cycles or more")
    assert to_be_sure([likely], (MOST_LIKELY,), False).startswith(f"{sure}releases from displacements")
    assert to_be_sure([likely], (), False) == to_be_sure([LISTED, LISTED], (LEAST_CYCLES,), False) == ""
    # nothing is let go where a force drives
    assert to_be_sure([likely], (LEAST_CYCLES,), True) == f"{sure}a recording of 16 independent strokes or more."
    assert to_be_sure([likely], (MOST_LIKELY,), True).startswith(f"{sure}drives whose speeds differ")
    assert "stays where it is" in to_be_sure([named("force-ripple", Grade.MAIN)], (MOST_LIKELY,), False)
    near = search(chosen=of(DRAG), rivals=(of(DRAG), of(STRIBECK)))
    both = left_open([named("quadratic-drag", Grade.ONE_OF), LISTED], near)
    assert both is not None
    assert (both.names, both.rival) == (("quadratic-drag", "stribeck"), near.rivals[1])
    # where the search went on to pairs, a listed law stands among those fitted alone; where nowhere, nothing is shown
    pairs, alone = (of(DRAG, STRIBECK),), of(STRIBECK)
    for singles, rival in (((alone,), alone), ((), None)):
        both = left_open([named("quadratic-drag", Grade.ONE_OF), LISTED], search(rivals=pairs, singles=singles))
        assert both is not None
        assert both.rival is rival


def test_a_pair_that_another_pair_matches_is_told_so() -> None:
    (said,) = cautions(
        search(chosen=of(DRAG, STRIBECK, bic=10.0)), judged("unexplained", of(STRIBECK, bic=13.0)), NONE_HELD
    )
    assert said.startswith("quadratic-drag with stribeck would explain it, but stribeck nearly as well (BIC 3 worse)")


def test_a_model_that_predicts_worse_is_told_so() -> None:
    held: Any = SimpleNamespace(refined_rmse={"x": 3.0, "a": 1.0}, baseline_rmse={"x": 1.0, "a": 1.0})
    assert cautions(search(), judged("missing_physics"), held) == (
        "BIC decides for the refined model although it predicts x worse",
    )
    even: Any = SimpleNamespace(refined_rmse={"x": 0.5}, baseline_rmse={"x": 1.0})
    assert cautions(search(), judged("missing_physics"), even) == ()
    assert cautions(search(), judged("adequate"), NONE_HELD) == ()


def test_cautions_of_a_graded_misfit() -> None:
    def graded(left_out: float, cycles: float, grade: Grade | None, pairs: bool = True) -> Any:
        problem = SimpleNamespace(pairs_searched=pairs, given=())
        misfit = SimpleNamespace(left_out=left_out, strokes=SimpleNamespace(cycles=cycles), problem=problem)
        named = SimpleNamespace(name="harmonic-force", clock=False, share=0.5, run=SimpleNamespace(total=0.9025))
        return SimpleNamespace(
            misfit=misfit,
            grade=grade,
            named=(named,),
            base_run=SimpleNamespace(total=1.0),
            chance=None,
            odds=SimpleNamespace(least=CHANCE),
            rules=(),
            finalists=(named,),
        )

    (said,) = cautions_of_misfit(graded(0.0, 20.0, Grade.MAIN))
    assert said.startswith("no entry or pair of the catalogue")
    (said,) = cautions_of_misfit(graded(0.0, 20.0, Grade.MAIN, pairs=False))
    assert said.startswith("no entry of the catalogue")
    (said,) = cautions_of_misfit(graded(0.0, 20.0, Grade.MAIN), of(DRAG, STRIBECK))
    assert said.startswith("quadratic-drag with stribeck would leave noise alone, but")
    crowd = graded(0.0, 20.0, Grade.ONE_OF)
    crowd.chance = 0.377
    assert "look like this one 38 % have harmonic-force as their main effect" in cautions_of_misfit(crowd)[1]
    all_said = cautions_of_misfit(graded(0.31, 4.5, Grade.ONE_OF))
    for words in ("the first 0.31 s", "4.5 cycles are few"):
        assert any(words in one for one in all_said)


def test_what_a_recording_leaves_open_and_what_would_decide(monkeypatch: pytest.MonkeyPatch) -> None:
    rival = of(STRIBECK)
    found = left_open([named("presliding"), named("quadratic-drag", Grade.EXPLAINS, 1.0, "stribeck")],
                      search(chosen=of(DRAG), rivals=(rival,)))  # fmt: skip
    assert found is not None
    assert (found.names, found.rival) == (("quadratic-drag", "stribeck"), rival)
    assert left_open([named("presliding")], search()) is None
    graded: Any = SimpleNamespace(finalists=[SimpleNamespace(name="quadratic-drag", fit=of(DRAG))])
    assert left_open_by_grade([], graded) is None
    assert left_open_by_grade([MAIN], graded) is None
    first = named("quadratic-drag", Grade.ONE_OF)
    open_ = left_open_by_grade([first, MINOR, LISTED], graded)
    assert open_ is not None
    assert open_.names == ("quadratic-drag", "stribeck")
    assert open_.rival is None
    driven: Any = SimpleNamespace(given=("driven",))
    stops = Open(("cubic-stiffness", "end-stop"), "stiffness", of(), None)
    for asked, words in ((open_, "drives whose speeds"), (stops, "a drive over a longer way")):
        assert f": {words}" in next_experiment(asked, driven, SimpleNamespace())  # type: ignore[arg-type]
    free: Any = SimpleNamespace(given=(), covariates={}, angular=False, channels={"x": np.zeros(3), "a": np.zeros(3)})
    scales: Any = SimpleNamespace()
    assert next_experiment(None, free, scales) == ""
    assert next_experiment(open_, free, scales).startswith("To tell quadratic-drag from stribeck: ")
    sensor = Open(("sensor-gain", "sensor-lag"), "sensor", of(), None)
    assert next_experiment(sensor, free, scales) == f"To tell sensor-gain from sensor-lag: {LARGER}."

    def each(*_: Any) -> list[Release]:
        return [Release(factor=f, amplitude=a, apart=d) for f, a, d in
                ((3.0, 3.0, 0.4), (2.0, 2.0, 1.5), (0.5, 0.5, 4.0))]  # fmt: skip

    monkeypatch.setattr(experiments, "releases", each)
    monkeypatch.setattr(experiments, "under", lambda found, problem: found)
    both = Open(("quadratic-drag", "stribeck"), "damping", of(DRAG), rival)
    said = next_experiment(both, free, scales)
    assert (
        "let it go from 0.5 m (0.5 times as far, where the two differ by 4 times what is left now) or from 2 m" in said
    )
    assert said.endswith("and diagnose both recordings with --together.")
    monkeypatch.setattr(experiments, "releases", lambda *_: [])
    assert "let it go" not in next_experiment(both, free, scales)


def test_recordings_that_are_pooled_and_that_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    alone = [SimpleNamespace(parameters={"omega_n": Quantity(v, 0.01, "rad/s"), "zeta": Quantity(0.02, 0.01, "1")})
             for v in (9.0, 9.1, 9.5, 9.2)]  # fmt: skip
    problem: Any = SimpleNamespace(starts=SimpleNamespace(stretches=range(4)))

    def before(chance: float, own: tuple[str, ...] = ()) -> Any:
        compared = SimpleNamespace(chance=chance, alone=alone)
        return SimpleNamespace(compared=compared, own=own, scales=SimpleNamespace(omega=9.0))

    (agree,) = sentences(of(), problem, before(0.4), True)
    assert agree == "The 4 recordings are pooled: alone they agree in their base parameters (chance 0.4)."
    (differ,) = sentences(of(), problem, before(1e-9), True)
    assert "read alone they differ (omega_n 9 and 9.5)" in differ
    rows = [[], [Differs("m", Quantity(1.25, 0.01, "1"))], [Differs("m", Quantity(1.001, 0.01, "1"))]]
    monkeypatch.setattr(pooled_said, "differences", lambda *_: rows)
    (own,) = sentences(of(), problem, before(1e-9, ("m",)), True)
    assert own.startswith("The recordings differ in ")
    assert "recording 2 has " in own
    assert "above that of the first" in own
    assert "recording 3" not in own


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


def test_pairs_are_built_on_the_best_and_on_the_best_plain_laws() -> None:
    flexible, plain = of(STRIBECK, bic=1.0), of(DRAG, bic=5.0)
    other = of(ModelTerm.named("viscoelastic", k_m=1.0, tau=0.1), bic=2.0)
    assert [one.bic for one in _beam((flexible, other, plain))][:2] == [1.0, 5.0]
    worse = of(DRAG, bic=9.0)
    steps: Any = [SimpleNamespace(fits=(worse, flexible)), SimpleNamespace(fits=(plain,))]
    assert [one.bic for one in _merged(steps)] == [1.0, 5.0]

"""Every term is what it says of itself, one that is not is refused, and the dispatch is the one of the registry.

The record of a thread is used run after run: no run knows of the one before.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.kernels import generate
from harness.kernels.generate import examine
from harness.kernels.layout import CHANGES_IN_TIME, SMOOTH, laws, lay_out
from harness.kernels.solve import By, Drive, Solution, solve
from harness.model.covariate import GIVEN
from harness.model.law import D_INTERNAL, D_PARAMETER, D_T, D_X, VALUE
from harness.model.model import Model, ModelTerm
from harness.model.registry import TERMS, term
from harness.model.term import Parameter, Slot, Term


@pytest.mark.parametrize("entry", TERMS, ids=lambda t: t.key)
def test_every_law_agrees_with_what_its_term_says(entry: Term) -> None:
    examine(entry)


@pytest.mark.parametrize("entry", [t for t in TERMS if t.law is not None], ids=lambda t: t.key)
def test_the_kernel_knows_which_laws_change_in_time(entry: Term) -> None:
    """A slider at rest is looked at again exactly while something can move it: a law of time, or an internal state."""
    spec = lay_out(Model(1.0, 1.0, 100.0, 2.0, terms=(ModelTerm(entry, entry.example),)), 1.0).spec
    assert bool(spec[CHANGES_IN_TIME]) == (entry.changes_in_time or entry.slot is Slot.INTERNAL)


def growing(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """rate t: takes t and gives no partial by it."""
    out[VALUE] = theta[o] * t
    out[D_PARAMETER] = t


def shifted(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """A partial by a time that it is not given."""
    out[VALUE] = theta[o] * x
    out[D_X] = theta[o]
    out[D_PARAMETER] = x
    out[D_T] = 1.0


def pushing(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """A force at rest."""
    out[VALUE] = theta[o]
    out[D_PARAMETER] = 1.0


def low(v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """A level that is not its first parameter at v = 0."""
    out[VALUE] = 0.5 * theta[o]
    out[D_PARAMETER] = 0.5


def springy(v: float, side: int, z: float, level: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """A bristle without end."""
    out[0, VALUE], out[1, VALUE] = theta[o] * z, v
    out[0, D_INTERNAL], out[0, D_PARAMETER], out[1, 2] = theta[o], z, 1.0


def entry(law: Any, slot: Slot = Slot.SMOOTH, **changed: Any) -> Term:
    given: dict[str, Any] = {"parameters": (Parameter("one", "N"),), "example": (2.0,), "law": law} | changed
    return Term("mine", "environment", slot, sentence="{one}", **given)


BAD = [
    (entry(growing), "the partial by t is "),
    (entry(shifted), "it writes a partial by what it is not given"),
    (entry(pushing), "push names the size of a force on a slider at rest at x = 0, and there is one"),
    (entry(low, Slot.FRICTION_LEVEL), "the level at v = 0 must be the first parameter"),
    (entry(springy, Slot.FRICTION_LAW, internal=1), "at full deflection level/theta"),
]


@pytest.mark.parametrize(("wrong", "message"), BAD, ids=lambda value: getattr(value, "law", value).__class__.__name__)
def test_a_law_that_says_something_else_is_refused(wrong: Term, message: str) -> None:
    with pytest.raises(TypeError, match=f"term mine: {message}"):
        examine(wrong)


CONTRADICTIONS: list[tuple[dict[str, Any], str]] = [
    ({"law": None}, "slot S takes a law"),
    ({"example": ()}, "a value for every parameter is needed"),
    ({"slot": Slot.EVENT}, "slot E takes no law"),
    ({"slot": Slot.OBSERVATION, "law": None}, "a sensor belongs in slot O"),
    ({"slot": Slot.EVENT, "law": None}, "a formula is needed without a law"),
    ({"law": growing, "parameters": (Parameter("Omega", "rad/s"),)}, "an angular frequency of a law that takes t"),
]


@pytest.mark.parametrize(("changed", "message"), CONTRADICTIONS)
def test_an_entry_that_contradicts_itself_is_refused(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(TypeError, match=f"term mine: .*{message}"):
        entry(**({"law": shifted} | changed))
    with pytest.raises(TypeError, match="family 'magic': one of friction, damping"):
        replace(term("cubic-stiffness"), family="magic")


def test_a_law_with_other_arguments_is_refused() -> None:
    ladder = next(ladder for ladder in generate.LADDERS if ladder.name == "smooth")
    with pytest.raises(TypeError, match=r"term mine: law\(v, theta, o, out\); expected law\(x, v, t, theta, o, out\)"):
        ladder.call(entry(low))


def test_the_dispatch_is_the_one_of_the_registry() -> None:
    assert generate.TARGET.read_text(encoding="utf-8") == generate.text(), "run python -m harness.kernels.generate"
    dispatched = [t for ladder in generate.LADDERS for t in ladder.terms]
    laws = {t.key for t in TERMS if t.law is not None} | {t.key for t in GIVEN.values()}
    assert {t.key for t in dispatched} == laws


def test_a_dispatch_written_for_other_terms_is_refused() -> None:
    keys = [t.key for t in SMOOTH]
    for written, found in (
        (keys[:-1], f"written without {keys[-1]}"),
        ([*keys, "mine"], "written with mine"),
        (keys[::-1], "written in another order"),
    ):
        with pytest.raises(
            InputError, match=rf"dispatch.py: {found}; expected what python -m harness.kernels.generate writes"
        ):
            laws(SMOOTH, *written)
    assert laws(()) == ()


def test_laws_write_into_zeros_only_what_is_theirs() -> None:
    """Rows come to a law as zeros, so that a law with a dead zone writes nothing within it."""
    out = np.zeros(9)
    stop = term("end-stop")
    assert stop.law is not None
    stop.law(0.1, 0.0, np.array([0.0] * 6 + [0.5, 100.0]), 6, out)
    assert not out.any()


T = np.linspace(0.0, 6.0, 301)
DRIVE = Drive(T, 0.4 * np.sin(3.0 * T))


def _models() -> list[Model]:
    """The base and every entry of the catalogue with the numbers of its own example."""
    base = Model(m=1.0, c=0.3, k=40.0, f_k=0.5, x0=0.1)
    return [base, *(base.with_terms(ModelTerm(term, term.example)) for term in TERMS)]


def _run(model: Model) -> Solution:
    own: tuple[By, ...] = tuple((i, j) for i, e in enumerate(model.terms) for j in range(len(e.values)))
    return solve(model, T, ("m", "c", "k", "f_k", "x0", *own), drive=DRIVE)


def _alone(model: Model) -> Solution:
    """In a thread, and so in a record, of its own."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(_run, model).result()


def test_a_run_is_to_the_last_bit_what_it_is_in_a_record_of_its_own() -> None:
    models = _models()
    fresh = [_alone(model) for model in models]
    for order in (range(len(models)), reversed(range(len(models)))):
        for i in order:
            again = _run(models[i])
            for name in ("x", "v", "a", "mode", "dx", "dv", "da"):
                same = np.array_equal(getattr(again, name), getattr(fresh[i], name), equal_nan=True)
                assert same, (name, models[i].labels)
            assert again.steps == fresh[i].steps

"""The record of a thread is used run after run: no run knows of the one before."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from harness.kernels.solve import By, Drive, Solution, solve
from harness.model.model import Model, ModelTerm
from harness.model.registry import TERMS

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

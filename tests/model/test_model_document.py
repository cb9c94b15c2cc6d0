"""model.json to and from a model, and the page of the catalogue."""

import copy
import json
import pickle
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from harness.core.errors import InputError
from harness.model import catalogue
from harness.model.document import from_document, load, to_document
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import TERMS
from harness.model.term import Slot
from harness.results import generate
from harness.results.common import ModelDocument

NAMED = ModelTerm.named
FULL = Model(
    1.2, 0.5, 90.0, 2.0, 2.5, x0=0.7, v0=-0.1, t0=0.3,
    terms=(
        NAMED("end-stop:negative", gap=0.5, k_stop=100.0),
        NAMED("position-dependent-friction:periodic", depth=0.1, period=0.2, phase=0.3),
        ModelTerm(NAMED("viscoelastic", k_m=3.0, tau=0.1).term, (3.0, 0.1), (0.02,)),
        NAMED("pendulum-stiffness"),
    ),
    mass_known=False,
)  # fmt: skip
SCHEMA = json.loads((generate.FOLDER / "harness.model-1.json").read_text(encoding="utf-8"))


def middle(lower: float, upper: float) -> float:
    return 0.5 if lower <= 0.5 <= upper else lower


@pytest.mark.parametrize(
    "model", [FULL, Model(1.0, 1.0, 100.0, 3.0), Model(2.0, 1.0, 0.0, 3.0, restoring=Restoring.NONE)]
)
def test_a_model_survives_the_file(model: Model, tmp_path: Path) -> None:
    file = tmp_path / "model.json"
    document = to_document(model)
    file.write_text(json.dumps(document))
    assert load(file) == model
    jsonschema.validate(document, SCHEMA)
    again = ModelDocument.model_validate_json(file.read_text()).model_dump(by_alias=True)
    assert from_document(again) == model
    jsonschema.validate(again, SCHEMA)


@pytest.mark.parametrize("term", TERMS, ids=lambda t: t.key)
def test_every_term_survives(term: Any) -> None:
    values = tuple(max(3.0, p.lower) if p.name == "f_s" else middle(p.lower, p.upper) for p in term.parameters)
    model = Model(1.0, 1.0, 100.0, 3.0, terms=(ModelTerm(term, values),))
    assert from_document(json.loads(json.dumps(to_document(model)))) == model
    assert pickle.loads(pickle.dumps(model)) == model


def test_f_s_is_written_and_equal_levels_are_none() -> None:
    document = to_document(Model(1.0, 1.0, 100.0, 3.0))
    assert document["base"] == {"m": 1.0, "c": 1.0, "k": 100.0, "f_k": 3.0, "f_s": 3.0}
    assert from_document(document).f_s is None


def changed(path: str, value: Any) -> dict[str, Any]:
    document = copy.deepcopy(to_document(FULL))
    *way, last = path.split(".")
    at: Any = document
    for name in way:
        at = at[int(name)] if name.isdigit() else at[name]
    at[int(last) if last.isdigit() else last] = value
    return document


STATIC = {"name": "static-friction", "parameters": {"f_s": 2.4}}
BRISTLE = {"name": "presliding", "parameters": {"sigma0": 100.0, "sigma1": 0.0}}
SMOOTHED = {"name": "regularised-friction", "parameters": {"v_r": 0.1, "lead": 0.0}}
STRIBECK = {"name": "stribeck", "parameters": {"f_s": 3.0, "v_s": 0.1}}
BAD = [
    ([], r"m.json: \[\]; expected an object with schema, base"),
    (changed("schema", "harness.model/2"), "m.json: schema: 'harness.model/2'; expected 'harness.model/1'"),
    (changed("typo", 1), "m.json: unknown field 'typo'; expected schema, base"),
    (changed("base", {"m": 1.0}), "m.json: base: no field 'c'; expected the fields m, c, k, f_k"),
    (changed("base.m", "1"), "m.json: base.m: '1'; expected a finite number"),
    (changed("base.m", None), "m.json: base.m: null; expected a finite number"),
    (changed("base.m", float("nan")), "m.json: base.m: nan; expected a finite number"),
    (changed("base.m", -1.0), "m.json: model: m: -1; expected a number above 0 kg"),
    (changed("base.f_s", 1.0), "m.json: model: f_s: 1, below f_k = 2; expected f_s >= f_k"),
    (changed("release.x0", True), "m.json: release.x0: True; expected a finite number"),
    (changed("restoring", "rubber"), "m.json: restoring: 'rubber'; expected spring, pendulum, none"),
    (changed("restoring", "none"), "m.json: model: k: 90 with restoring none; expected 0"),
    (changed("mass_known", 1), "m.json: mass_known: 1; expected true or false"),
    (changed("terms", {}), r"m.json: terms: \{\}; expected a list"),
    (
        changed("terms.0.name", "magic"),
        r"terms\[0\]: 'magic:negative' is not in the catalogue; expected one of stribeck,",
    ),
    (changed("terms.0.variant", "left"), r"terms\[0\]: 'end-stop:left' is not in the catalogue"),
    (
        changed("terms.0.parameters", {"gap": 1.0}),
        r"terms\[0\].parameters: no field 'k_stop'; expected the fields gap, k_stop",
    ),
    (changed("terms.0.parameters.gap", "x"), r"terms\[0\].parameters.gap: 'x'; expected a finite number"),
    (changed("terms.0.parameters.gap", -1), r"terms\[0\]: term end-stop:negative: gap: -1; expected 0 to inf"),
    (changed("terms.2.internal", [1, 2]), r"terms\[2\].internal: \[1, 2\]; expected a list of 1 numbers"),
    (changed("terms", [BRISTLE, SMOOTHED]), "presliding and regularised-friction in slot F law; expected one law"),
    (changed("terms", [BRISTLE]), "m.json: a break-away level together with presliding; expected a law that sticks"),
    (changed("terms", [STRIBECK]), "base.f_s: 2.5 beside the f_s of stribeck; expected f_s = f_k"),
    (changed("terms", [STATIC]), "base.f_s: 2.5 beside the f_s of static-friction"),
]


@pytest.mark.parametrize(("document", "message"), BAD)
def test_bad_documents_are_named(document: Any, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        from_document(document, "m.json")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [(b"{", "line 1: Expecting property name"), (b"\xff\xfe", "not text; expected JSON of harness.model/1")],
)
def test_files_that_are_no_json_are_named(text: bytes, message: str, tmp_path: Path) -> None:
    file = tmp_path / "m.json"
    file.write_bytes(text)
    with pytest.raises(InputError, match=message):
        load(file)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file or directory; expected a file that can be read"):
        load(tmp_path / "none.json")


def test_slots_that_take_one_law_refuse_two() -> None:
    for slot in (Slot.FRICTION_LAW, Slot.FRICTION_LEVEL, Slot.BREAK_AWAY):
        of = [t for t in TERMS if t.slot is slot]
        two = (of[0], of[-1])
        entries = tuple(ModelTerm(t, tuple(middle(p.lower, p.upper) for p in t.parameters)) for t in two)
        with pytest.raises(InputError, match=f"in slot {slot.value}; expected one law"):
            Model(1.0, 1.0, 100.0, 0.1, terms=entries)


def test_terms_refuse_wrong_numbers_of_values() -> None:
    with pytest.raises(InputError, match="term stribeck: parameters f_s; expected f_s, v_s"):
        NAMED("stribeck", f_s=1.0)
    with pytest.raises(InputError, match="term viscoelastic: 2 internal starts; expected 1 internal starts"):
        ModelTerm(FULL.terms[2].term, (1.0, 1.0), (0.0, 0.0))


def test_the_page_is_the_one_of_the_registry() -> None:
    assert catalogue.TARGET.read_text(encoding="utf-8") == catalogue.text(), "run python -m harness.model.catalogue"


def test_every_term_is_on_it_with_a_page_of_its_own() -> None:
    page = catalogue.text()
    for term in TERMS:
        assert page.count(f"| [{term.key}]({catalogue.page_of(term)}.md) |") == 1
        own = (catalogue.TARGET.parent / f"{catalogue.page_of(term)}.md").read_text(encoding="utf-8")
        for parameter in term.parameters:
            assert f"| `{parameter.name}` | {parameter.unit} |" in own

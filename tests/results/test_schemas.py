"""The shipped schemas are those of the code, and an example of each result is valid by its schema."""

import json
from typing import Any

import jsonschema
import pytest
from pydantic import ValidationError

from harness.app.doctor import doctor
from harness.core.quantity import Quantity
from harness.results import generate
from harness.results.common import P

NUMBER = P(value=0.03, stderr=1e-6, unit="m")
REFUSED = P.of(Quantity.refused("m", "two reversals; three are needed"))


def test_shipped_schemas_are_those_of_the_code() -> None:
    shipped = {file.name: file.read_text(encoding="utf-8") for file in generate.FOLDER.glob("*.json")}
    made = {generate.file_name(name): generate.schema_text(name, model) for name, model in generate.models().items()}
    assert shipped == made, "run python -m harness.results.generate"


@pytest.mark.parametrize("name", generate.models())
def test_every_schema_is_one(name: str) -> None:
    """A result of each is held against it beside its use case."""
    schema = json.loads((generate.FOLDER / generate.file_name(name)).read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)


def test_the_doctors_result_is_valid_by_its_schema() -> None:
    schema = json.loads((generate.FOLDER / "harness.doctor-1.json").read_text(encoding="utf-8"))
    jsonschema.validate(json.loads(doctor().model_dump_json(by_alias=True)), schema)


def test_an_unknown_field_is_an_error() -> None:
    with pytest.raises(ValidationError, match="typo"):
        P.model_validate({"value": 1.0, "stderr": 1.0, "unit": "m", "typo": 1})


@pytest.mark.parametrize("missing", [{"value": None, "stderr": None}, {"value": 1.0, "stderr": None}])
def test_what_is_null_says_why(missing: dict[str, Any]) -> None:
    with pytest.raises(ValidationError, match="needs a why"):
        P.model_validate({**missing, "unit": "m"})


def test_a_number_has_no_why_and_a_refusal_has_one() -> None:
    assert json.loads(NUMBER.model_dump_json()) == {"value": 0.03, "stderr": 1e-6, "unit": "m"}
    assert json.loads(REFUSED.model_dump_json())["why"].startswith("two reversals")

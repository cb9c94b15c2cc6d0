"""The shipped schemas are those of the code, an example of each result is valid by its schema; numbers in sentences."""

import json
from typing import Any

import jsonschema
import pytest
from pydantic import ValidationError

from harness.app.doctor import doctor
from harness.core.errors import short_names
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


@pytest.mark.parametrize(
    ("value", "stderr", "text"),
    [
        (20.0134, 0.0067, "20.013 +- 0.007 N/m"),
        (9.5032, 0.0126, "9.503 +- 0.013 N/m"),
        (0.0316, 2.5e-4, "0.03160 +- 0.00025 N/m"),
        (3.172e-5, 1.2e-6, "(3.17 +- 0.12)e-05 N/m"),
        (123456.0, 2345.0, "123500 +- 2300 N/m"),
        (1.2e9, 4e7, "(1.20 +- 0.04)e+09 N/m"),
        (0.1, 0.3, "0.1 +- 0.3 N/m"),
        (5.0, 0.0299, "5.00 +- 0.03 N/m"),
        (1.0, 9.96, "1 +- 10 N/m"),
        (-3.456, 0.25, "-3.46 +- 0.25 N/m"),
        (-0.04, 9.0, "0 +- 9 N/m"),
        (-4e-13, 9.1e-10, "(0 +- 9)e-10 N/m"),
    ],
)
def test_two_digits_of_an_error_that_begins_with_one_or_two_else_one(value: float, stderr: float, text: str) -> None:
    assert str(Quantity(value, stderr, "N/m")) == text


def test_a_number_without_error_or_without_value() -> None:
    assert str(Quantity(1.5, None, "1", "given")) == "1.5"
    assert str(Quantity.refused("s", "too few reversals")) == "unknown"
    assert str(P.of(Quantity.refused("s", "too few reversals"))) == "none (too few reversals)"
    assert str(P.of(Quantity(0.0316, 2.5e-4, "s"))) == "0.03160 +- 0.00025 s"


@pytest.mark.parametrize(
    ("files", "names"),
    [
        (["a/log.csv"], ["log.csv"]),
        (["mon/log.csv", "tue/log.csv", "tue/two.csv"], ["mon/log.csv", "tue/log.csv", "two.csv"]),
        (["log.csv", "x/log.csv"], ["log.csv", "x/log.csv"]),
        (["/r/a/1/log.csv", "/r/b/1/log.csv"], ["a/1/log.csv", "b/1/log.csv"]),
        (["a/log.csv", "a/log.csv"], ["log.csv", "log.csv"]),
        (["-"], ["-"]),
    ],
)
def test_files_are_called_by_as_much_of_their_paths_as_parts_them(files: list[str], names: list[str]) -> None:
    assert [short_names(files)[file] for file in files] == names

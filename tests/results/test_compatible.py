"""A schema's number rises when a field goes or changes its type, for programs that read results; choices may grow.

fields.json has the fields of every schema as they were published. What is added there is added by
``python tests/results/test_compatible.py``; what is taken out, by hand, with a new number.
"""

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from harness.results import generate

KEPT = Path(__file__).with_name("fields.json")
PUBLISHED: dict[str, dict[str, list[str]]] = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}


def types(of: Mapping[str, Any]) -> set[str]:
    """The forms that a field may have; of texts with a fixed choice, each choice."""
    if "anyOf" in of or "oneOf" in of:
        return set().union(*(types(one) for one in of.get("anyOf") or of["oneOf"]))
    if "enum" in of or "const" in of:
        return {repr(value) for value in of.get("enum", [of.get("const")])}
    return {of["$ref"].rpartition("/")[2]} if "$ref" in of else {str(of.get("type", "any"))}


def fields(schema: Mapping[str, Any]) -> dict[str, list[str]]:
    """The fields of a schema and of its parts, by "Part.field", with their types."""
    parts = {**schema.get("$defs", {}), schema["title"]: schema}
    return {
        f"{part}.{name}": sorted(types(field))
        for part, holds in sorted(parts.items())
        for name, field in holds.get("properties", {}).items()
    }


@cache
def now() -> dict[str, dict[str, list[str]]]:
    return {name: fields(json.loads(generate.schema_text(name, model))) for name, model in generate.models().items()}


@pytest.mark.parametrize("schema", PUBLISHED)
def test_what_was_published_is_still_there(schema: str) -> None:
    found = now()
    if schema not in found:
        stem, _, number = schema.rpartition("/")
        assert f"{stem}/{int(number) + 1}" in found, f"{schema} is gone, and no later number of it is there"
        return
    for field, forms in PUBLISHED[schema].items():
        assert field in found[schema], f"{schema}: {field} is gone: give the schema a new number"
        assert set(forms) <= set(found[schema][field]), (
            f"{schema}: {field} has lost a form: give the schema a new number"
        )


def test_every_field_is_among_those_published() -> None:
    """A new one is there for good once it is in the file."""
    assert now() == PUBLISHED, "run python tests/results/test_compatible.py"


def test_a_lost_field_and_a_lost_choice_are_seen() -> None:
    whole = {"title": "R", "properties": {"a": {"enum": ["x", "y"]}, "b": {"type": "number"}}}
    assert fields(whole) == {"R.a": ["'x'", "'y'"], "R.b": ["number"]}
    assert types({"anyOf": [{"$ref": "#/$defs/P"}, {"type": "null"}]}) == {"P", "null"}


if __name__ == "__main__":
    KEPT.write_text(json.dumps(now(), indent=1) + "\n", encoding="utf-8")

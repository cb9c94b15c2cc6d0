"""Writes docs/results.md, every field of every result file, from the code: python docs/results_page.py."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from harness.fidelity.kind import kinds
from harness.results.generate import file_name, models

TARGET = Path(__file__).resolve().parent / "results.md"
INTRODUCTION = """\
# Results

Written by `python docs/results_page.py` from the models of the results. Every command writes JSON: `result.json` of its
output folder, or `--json FILE`. A field `schema` says which of the forms below it is. SI units everywhere; of a hinge,
metres are radians. Nothing is ever missing in silence: what is null says why.

A number that was estimated is a `P`, with its standard error and its unit; what could not be is null, with `why`.
"""
METRICS = """\
## Figures of the scenarios

What a row of `harness sweep` is scored by: a metric, and what it is measured against.
[Engine settings](fidelity.md) says more of each scenario.

| scenario | metric | figure |
|---|---|---|
"""


def _type(of: Mapping[str, Any]) -> str:
    """A type in words, with a link to where it stands."""
    if "$ref" in of:
        name = of["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if "const" in of or "enum" in of:
        return ", ".join(f"`{value}`" for value in of.get("enum", [of.get("const")]))
    if "anyOf" in of or "oneOf" in of:
        return " or ".join(dict.fromkeys(_type(one) for one in of.get("anyOf") or of["oneOf"]))
    if of.get("type") == "array":
        return f"list of {_type(of['items'])}" if of.get("items") else "list"
    if of.get("type") == "object" and isinstance(of.get("additionalProperties"), Mapping):
        return f"{_type(of['additionalProperties'])} by name"
    return {"string": "text", "object": "object", "boolean": "yes or no"}.get(of.get("type", ""), of.get("type", "any"))


def _fields(of: Mapping[str, Any]) -> Iterator[str]:
    """A description, and a table of fields."""
    first, _, rest = of.get("description", "").partition("\n")
    yield from (" ".join((first, *rest.split())).strip(), "")
    if of.get("properties"):
        yield from ("| field | type | meaning |", "|---|---|---|")
        for name, field in of["properties"].items():
            meaning = field.get("description", "").replace("|", "\\|")
            yield f"| `{name}` | {_type(field).replace('|', chr(92) + '|')} | {meaning} |"
        yield ""


def text() -> str:
    """The page."""
    schemas = {name: model.model_json_schema(by_alias=True, mode="serialization") for name, model in models().items()}
    parts: dict[str, Mapping[str, Any]] = {}
    for schema in schemas.values():
        parts |= schema.get("$defs", {})
    lines = [INTRODUCTION]
    for name, schema in schemas.items():
        link = f"[schema](../harness/results/schemas/{file_name(name)})"
        lines += [f"## {name}", "", f"JSON {link}.", ""]
        lines += _fields(schema)
        if "properties" not in schema:
            lines += [f"It is {_type(schema)}.", ""]
    lines += ["## Parts", "", "What several of them are made of, by name.", ""]
    for name, part in sorted(parts.items()):
        lines += [f"### {name}", "", *_fields(part)]
    rows = [f"| {k.name} | `{f.metric}` | {f.label}: {f.good} |" for k in kinds().values() for f in k.figures]
    return "\n".join([*lines, METRICS + "\n".join(rows)]).rstrip() + "\n"


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")

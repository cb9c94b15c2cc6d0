"""Write the JSON Schema of every result: ``python -m harness.results.generate``; a test regenerates and compares."""

import json
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from pydantic import BaseModel, RootModel

from harness import results
from harness.results.common import Result

FOLDER = Path(__file__).parent / "schemas"


def models() -> dict[str, type[BaseModel]]:
    """Every result that has a schema name of its own, by that name ("harness.run/1").

    A document of several forms (an object or an array of them) is a RootModel whose SCHEMA names it.
    """
    found: dict[str, type[BaseModel]] = {}
    documents: dict[str, type[BaseModel]] = {}
    for module in sorted(module.name for module in iter_modules(results.__path__)):
        for value in vars(import_module(f"harness.results.{module}")).values():
            if isinstance(value, type) and issubclass(value, Result) and "schema_" in value.model_fields:
                found[str(value.model_fields["schema_"].default)] = value
            elif isinstance(value, type) and issubclass(value, RootModel) and "SCHEMA" in vars(value):
                documents[str(vars(value)["SCHEMA"])] = value
    return dict(sorted((found | documents).items()))


def file_name(schema: str) -> str:
    """The file a schema is kept in: "harness.run/1" in harness.run-1.json."""
    return schema.replace("/", "-") + ".json"


def schema_text(schema: str, model: type[BaseModel]) -> str:
    """The JSON Schema of a model, as its file holds it. Every field is required of what we write."""
    generated = model.model_json_schema(by_alias=True, mode="serialization")
    named = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": f"urn:{schema.replace('/', ':')}"}
    return json.dumps({**named, **generated}, indent=2, ensure_ascii=False) + "\n"


def main() -> None:
    """Write all of them, and remove those that nothing stands behind any more."""
    FOLDER.mkdir(exist_ok=True)
    wanted = {file_name(schema): schema_text(schema, model) for schema, model in models().items()}
    for file in FOLDER.glob("*.json"):
        if file.name not in wanted:
            file.unlink()
    for name, text in wanted.items():
        (FOLDER / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()

"""model.json, "harness.model/1": a model as a document, and back."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from harness.core.bounded import MOST_DOCUMENT_BYTES, parse_json, read_bytes
from harness.core.checks import finite
from harness.core.errors import InputError
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import term as find_term
from harness.model.term import Slot

SCHEMA: Final = "harness.model/1"
_TOP = ("schema", "base", "restoring", "release", "terms", "mass_known", "offset")
_BASE = ("m", "c", "k", "f_k", "f_s")
_RELEASE = ("x0", "v0", "t0")
_TERM = ("name", "variant", "parameters", "internal")
SMALLEST, LARGEST = 1e-30, 1e30
"""Of a number in SI units: the product of four quotients of such numbers stays one of double precision."""


def to_document(model: Model) -> dict[str, Any]:
    """The model as plain data, in the order of the contract; f_s is f_k where they do not differ."""
    terms = [
        {
            "name": entry.term.name,
            "variant": entry.term.variant,
            "parameters": dict(zip(entry.term.names, entry.values, strict=True)),
            "internal": list(entry.internal0),
        }
        for entry in model.terms
    ]
    f_s = model.f_k if model.f_s is None else model.f_s
    return {
        "schema": SCHEMA,
        "base": {"m": model.m, "c": model.c, "k": model.k, "f_k": model.f_k, "f_s": f_s},
        "restoring": model.restoring.value,
        "release": {"x0": model.x0, "v0": model.v0, "t0": model.t0},
        "terms": terms,
        "mass_known": model.mass_known,
        "offset": model.offset,
    }


def _fields(where: str, data: object, known: tuple[str, ...], needed: tuple[str, ...]) -> Mapping[str, Any]:
    """``data`` as a mapping with these names, or InputError."""
    if not isinstance(data, Mapping):
        raise InputError(where, f"{data!r}", f"an object with {', '.join(needed)}")
    for name in data:
        if name not in known:
            raise InputError(where, f"unknown field {name!r}", f"{', '.join(known)}")
    for name in needed:
        if name not in data:
            raise InputError(where, f"no field {name!r}", f"the fields {', '.join(needed)}")
    return data


def _number(where: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(where, f"{value!r}", "a finite number")
    number = finite(where, value)
    if number != 0.0 and not SMALLEST <= abs(number) <= LARGEST:
        raise InputError(where, f"{number:g}", f"0, or {SMALLEST:g} to {LARGEST:g} in size")
    return number


def _term(where: str, data: object) -> ModelTerm:
    given = _fields(where, data, _TERM, ("name", "parameters"))
    variant = given.get("variant", "")
    try:
        entry = find_term(f"{given['name']}:{variant}" if variant else str(given["name"]))
    except InputError as error:
        raise InputError(where, error.found, error.accepted) from None
    names = entry.names
    parameters = _fields(f"{where}.parameters", given["parameters"], names, names)
    values = tuple(_number(f"{where}.parameters.{name}", parameters[name]) for name in names)
    internal = given.get("internal", [])
    if not isinstance(internal, list) or len(internal) not in (0, entry.internal):
        raise InputError(f"{where}.internal", f"{internal!r}", f"a list of {entry.internal} numbers")
    start = tuple(_number(f"{where}.internal", value) for value in internal)
    try:
        return ModelTerm(entry, values, start)
    except InputError as error:
        raise InputError(f"{where}: {error.where}", error.found, error.accepted) from None


def _check_break_away(where: str, model: Model) -> None:
    """Refuse a break-away level that the model would not use."""
    static = model.in_slot(Slot.BREAK_AWAY)
    above = model.f_s is not None and model.f_s > model.f_k
    for law in model.in_slot(Slot.FRICTION_LAW):
        if static or above:
            found = f"a break-away level together with {law.term.key}"
            raise InputError(where, found, "a law that sticks with one")
    # the first parameter of either is a break-away force
    owner = next(iter((*static, *model.in_slot(Slot.FRICTION_LEVEL))), None)
    if above and owner is not None:
        found = f"{model.f_s:g} beside the {owner.term.names[0]} of {owner.term.key}"
        raise InputError(f"{where}: base.f_s", found, "f_s = f_k")
    if static and static[0].values[0] < model.f_k:
        found = f"{static[0].values[0]:g}, below f_k = {model.f_k:g}"
        raise InputError(f"{where}: {static[0].term.key}: {static[0].term.names[0]}", found, "f_s >= f_k")


def from_document(data: object, where: str = "model") -> Model:
    """The model a document describes. Raises InputError naming the field, what stood there, what is expected."""
    top = _fields(where, data, _TOP, ("schema", "base"))
    if top["schema"] != SCHEMA:
        raise InputError(f"{where}: schema", f"{top['schema']!r}", f"{SCHEMA!r}")
    base = _fields(f"{where}: base", top["base"], _BASE, _BASE[:4])
    values = {name: _number(f"{where}: base.{name}", base[name]) for name in base if base[name] is not None}
    release = _fields(f"{where}: release", top.get("release", {}), _RELEASE, ())
    start = {name: _number(f"{where}: release.{name}", release[name]) for name in release}
    restoring = top.get("restoring", Restoring.SPRING.value)
    if restoring not in [kind.value for kind in Restoring]:
        raise InputError(f"{where}: restoring", f"{restoring!r}", f"{', '.join(Restoring)}")
    mass_known = top.get("mass_known", True)
    if not isinstance(mass_known, bool):
        raise InputError(f"{where}: mass_known", f"{mass_known!r}", "true or false")
    offset = _number(f"{where}: offset", top.get("offset", 0.0))
    listed = top.get("terms", [])
    if not isinstance(listed, list):
        raise InputError(f"{where}: terms", f"{listed!r}", "a list")
    terms = tuple(_term(f"{where}: terms[{i}]", entry) for i, entry in enumerate(listed))
    f_s = values.pop("f_s", None)
    if f_s == values.get("f_k"):
        f_s = None
    for name in _BASE[:4]:
        if name not in values:
            raise InputError(f"{where}: base.{name}", "null", "a finite number")
    given: dict[str, Any] = {**values, **start, "f_s": f_s, "mass_known": mass_known, "offset": offset}
    try:
        model = Model(restoring=Restoring(restoring), terms=terms, **given)
    except InputError as error:
        raise InputError(f"{where}: {error.where}", error.found, error.accepted) from None
    _check_break_away(where, model)
    return model


def load(file: Path) -> Model:
    """The model in a file. Raises InputError when it cannot be read or is not a model."""
    try:
        data = parse_json(read_bytes(file, MOST_DOCUMENT_BYTES).decode("utf-8"))
    except UnicodeDecodeError:
        raise InputError(str(file), "not text", f"JSON of {SCHEMA}") from None
    except json.JSONDecodeError as error:
        raise InputError(f"{file}, line {error.lineno}", error.msg, f"JSON of {SCHEMA}") from None
    except ValueError as error:
        raise InputError(str(file), str(error), f"JSON of {SCHEMA}") from None
    return from_document(data, str(file))

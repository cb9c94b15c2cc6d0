"""Writes a page for each name of the catalogue to docs/terms: python docs/term_pages.py, after docs/signatures.py."""

import json
import math
from collections.abc import Iterator
from typing import Any

from signatures import ALIKE, BASE, FOLDER, NOISE, draws, file_name

from harness.model.catalogue import page_of
from harness.model.registry import TERMS
from harness.model.term import Parameter, Term

_MASS = f"{BASE['m']:g} kg, {BASE['k']:g} N/m, {BASE['c']:g} N s/m and {BASE['f_k']:g} N"
NEEDS = {
    "driven": "a recording with a measured force",
    "angle": "a channel in rad or deg",
    "spring": "a spring",
    "zero": "a zero of x that is the spring's",
    "returns": "a motion that comes back to the same places and speeds, as no run-down does",
    "both-ways": "both directions",
    "one-clock": "one recording at a time: its phase or moment is not that of another",
}


def _range(p: Parameter) -> str:
    if math.isinf(p.lower) and math.isinf(p.upper):
        return "any"
    if math.isinf(p.upper):
        return f"{'above' if p.positive else 'at least'} {p.lower:g}"
    return f"{p.lower:g} to {p.upper:g}"


def _law(term: Term) -> Iterator[str]:
    yield from ("```text", *term.said.splitlines(), "```", "")
    if term.parameters:
        yield from ("| parameter | unit | range | no effect at |", "|---|---|---|---|")
        for p in term.parameters:
            yield f"| `{p.name}` | {p.unit} | {_range(p)} | {'-' if p.none is None else f'{p.none:g}'} |"
        yield ""
    if term.needs:
        yield f"It needs {', and '.join(NEEDS[need] for need in term.needs)}."
        yield ""


def _signature(term: Term, known: dict[str, Any]) -> Iterator[str]:
    if not draws(term):
        why = "It is fitted where nothing that has a name explains a recording."
        if term.frees:
            why = "Its form is free: it is fitted where the law of this name leaves structure."
        yield "A free decay does not show it." if term.searched else why
        yield ""
        return
    values = ", ".join(f"{p.name} = {v:g} {p.unit}" for p, v in zip(term.parameters, term.example, strict=True))
    yield f"![what viscous and Coulomb friction leave of a decay with {term.key}]({file_name(term)})"
    yield ""
    unit = "rad" if "angle" in term.needs else "m"
    yield f"A slider of {_MASS}, let go at {BASE['x0']:g} {unit}{f', with {values}' if values else ''}."
    yield "The base model is fitted to position and acceleration; the bands are two standard deviations of noise"
    yield f"({NOISE['x']:g} {unit}, {NOISE['a']:g} {unit}/s^2). Chi-square per point that it leaves:"
    yield f"{known['chi2_per_point']:g}."
    yield ""


def _confused(terms: list[Term], known: dict[str, Any]) -> Iterator[str]:
    yield from ("## What it is confused with", "")
    linked = {t.name: f"[{t.name}]({t.name}.md)" for t in TERMS}
    for term in (t for t in terms if t.key in known):
        near = known[term.key]["followed_by"]
        which = f"In the decay above ({term.key})" if len(terms) > 1 else "In the decay above"
        names = ", ".join(f"{linked[name]} {100.0 * share:.0f} %" for name, share in near.items())
        none = (
            f"{which} no other name alone takes off {100.0 * ALIKE:.0f} % of what the base model leaves beyond noise."
        )
        yield f"{which} these take off alone, of what the base model leaves beyond noise: {names}." if near else none
        yield ""
    name = terms[0].name
    told = {other: words for t in terms for other, words in t.told_from.items()}
    told |= {t.name: t.told_from[name] for t in TERMS if name in t.told_from}
    for other, words in told.items():
        yield f"- {words[0].upper()}{words[1:]} tells it from {linked[other]}."
    yield ""


def text(name: str, known: dict[str, Any]) -> str:
    """The page of a name, from the registry and what was measured."""
    terms = [term for term in TERMS if term.name == name]
    lines = [f"# {name}", "", "Written by `python docs/term_pages.py` from the registry and signatures.json.", ""]
    for term in terms:
        values = {p.name: f"{v:g} {p.unit}" for p, v in zip(term.parameters, term.example, strict=True)}
        said = term.say({**values, **term.words(term.example, BASE["k"])})
        lines += [
            f"## {term.key if len(terms) > 1 else 'Law'}",
            "",
            f"Family {term.family}, slot {term.slot}. {said}",
            "",
        ]
        lines += [*_law(term), *([] if len(terms) > 1 else ["## Signature", ""])]
        lines += _signature(term, known.get(term.key, {}))
    lines += _confused(terms, known)
    return "\n".join(lines).rstrip() + "\n"


def pages() -> dict[str, str]:
    """Every page by its name."""
    known = json.loads((FOLDER / "signatures.json").read_text(encoding="utf-8"))
    return {page_of(term) + ".md": text(term.name, known) for term in TERMS}


if __name__ == "__main__":
    for page, written in pages().items():
        (FOLDER.parent / page).write_text(written, encoding="utf-8")

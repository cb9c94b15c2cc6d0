"""What came out, in sentences, before anything else."""

from collections.abc import Mapping, Sequence
from typing import Any

from harness.show.motion_units import SLIDES, MotionUnits
from harness.show.numbers import number
from harness.show.report.section import Section
from harness.show.sentences.words import engine_name


def verdict_section(
    headline: str, sentences: Sequence[str], about: Sequence[str] = (), heading: str = "What came out"
) -> Section:
    """headline : one or two sentences. sentences : what differs and why.

    about : names; sentences that begin with one of them and a colon are put together.
    """
    grouped: dict[str, list[str]] = {}
    rest = []
    for sentence in sentences:
        who, colon, said = sentence.partition(": ")
        if colon and who in about:
            grouped.setdefault(who, []).append(_capital(said))
        else:
            rest.append(sentence)
    return Section(heading, "verdict.html.j2", {"headline": headline, "grouped": grouped, "sentences": rest})


def headline(traces: Sequence[Mapping[str, Any]], units: MotionUnits = SLIDES) -> str:
    """One sentence for each preset: how far its engines are from exact, and whether they come to rest."""
    groups: dict[str, list[Mapping[str, Any]]] = {}
    for trace in traces:
        if trace["metrics"]["max_error_m"] is not None and trace["source"] != "reference":
            groups.setdefault(trace["preset"], []).append(trace)
    said = [_sentence(preset, members, units.small) for preset, members in sorted(groups.items(), reverse=True)]
    return " ".join(said) or "The exact reference alone was run; there is nothing to compare it with."


def _sentence(preset: str, traces: Sequence[Mapping[str, Any]], unit: str) -> str:
    parts = []
    for trace in traces:
        metrics = trace["metrics"]
        part = f"{engine_name(trace['source'])} is off by at most {number(metrics['max_error_m'] * 1e3, 3)} {unit}"
        creep = metrics["creep_m_s"]
        if creep is not None and abs(creep) > 1e-6:
            part += f" and never rests (it creeps at {number(creep * 1e3, 3)} {unit}/s)"
        parts.append(part)
    start = {"as-shipped": "As shipped, ", "tuned": "Tuned, "}.get(preset, f"{preset}: " if preset else "")
    text = start + _joined(parts)
    return text[0].upper() + text[1:] + "."


def _capital(sentence: str) -> str:
    """Begun with a capital, unless it begins with a symbol such as zeta or x_k."""
    first = sentence.split(maxsplit=1)[0]
    return sentence if "_" in first or first == "zeta" else sentence[0].upper() + sentence[1:]


def _joined(parts: Sequence[str]) -> str:
    return (
        parts[0]
        if len(parts) == 1
        else ", ".join(parts[:-1]) + "; " * (len(parts) > 2) + " and " * (len(parts) == 2) + parts[-1]
    )

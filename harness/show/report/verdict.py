"""What a page begins and ends with: the answer in sentences; sources, files, versions."""

import shlex
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

from harness.show.numbers import SLIDES, MotionUnits, engine_name, number
from harness.show.report.section import Section


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


def sources_section(traces: Sequence[Mapping[str, Any]], palette: Sequence[str], exact: str = "closed form") -> Section:
    """traces : as in harness.run/1. exact : how one without a step moves."""
    cards = [
        {
            "head": f"{trace['source']} {trace['preset']}".strip(),
            "color": color,
            "line": ", ".join(
                part
                for part in (
                    f"version {trace['version']}" if trace["version"] else "",
                    f"{exact}, no step" if trace["dt_s"] is None else f"step {trace['dt_s'] * 1e3:.6g} ms",
                )
                if part
            ),
            "ignored": trace["ignored"],
            "count": "1 setting" if len(trace["settings"]) == 1 else f"{len(trace['settings'])} settings",
            "settings": {name: setting(value) for name, value in trace["settings"].items()},
        }
        for trace, color in zip(traces, palette, strict=True)
    ]
    return Section("Engines, settings, and what is ignored", "sources.html.j2", {"cards": cards})


def made_with_section(machine: Mapping[str, Any], files: Mapping[str, str], command: str) -> Section:
    """machine, files : as in the result file. command : the line that makes it again."""
    packages = ", ".join(f"{name} {version}" for name, version in machine["packages"].items())
    seeds = ", ".join(f"{name} {seed}" for name, seed in machine["seeds"].items())
    facts = {
        "Python": machine["python"],
        "system": f"{machine['system']}, {machine['cores']} cores",
        "packages": packages,
        "seeds": seeds,
    }
    return Section(
        "Files, and how to make this again",
        "madewith.html.j2",
        {
            "command": command,
            "facts": {name: value for name, value in facts.items() if value},
            "files": {name: PurePath(path).name for name, path in files.items()},
            "view": f"harness view {shlex.quote(PurePath(files['rrd']).name)}" if "rrd" in files else "",
        },
    )


def setting(value: object) -> str:
    """A setting's value as one line."""
    if isinstance(value, float):
        return f"{value:.10g}"
    if isinstance(value, (list, tuple)):
        return " ".join(setting(inner) for inner in value)
    return str(value)

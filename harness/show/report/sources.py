"""Who made the traces, and how to make them again."""

import shlex
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

from harness.show.report.section import Section


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

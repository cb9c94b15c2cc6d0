"""Who made the traces, and how to make them again."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, ClassVar

from harness.show.report.section import Section


@dataclass(frozen=True)
class Sources(Section):
    """traces : as in harness.run/1. exact : how one without a step moves."""

    template: ClassVar[str] = "sources.html.j2"
    traces: Sequence[Mapping[str, Any]]
    palette: Sequence[str]
    exact: str = "closed form"

    @property
    def title(self) -> str:
        """The heading."""
        return "Engines, settings, and what is ignored"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        cards = [
            {
                "head": f"{trace['source']} {trace['preset']}".strip(),
                "color": color,
                "line": ", ".join(
                    part
                    for part in (
                        f"version {trace['version']}" if trace["version"] else "",
                        f"{self.exact}, no step" if trace["dt_s"] is None else f"step {trace['dt_s'] * 1e3:.6g} ms",
                    )
                    if part
                ),
                "ignored": trace["ignored"],
                "count": "1 setting" if len(trace["settings"]) == 1 else f"{len(trace['settings'])} settings",
                "settings": {name: setting(value) for name, value in trace["settings"].items()},
            }
            for trace, color in zip(self.traces, self.palette, strict=True)
        ]
        return {"cards": cards}


@dataclass(frozen=True)
class MadeWith(Section):
    """machine, files : as in the result file. command : the line that makes it again."""

    template: ClassVar[str] = "madewith.html.j2"
    machine: Mapping[str, Any]
    files: Mapping[str, str]
    command: str

    @property
    def title(self) -> str:
        """The heading."""
        return "Files, and how to make this again"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        packages = ", ".join(f"{name} {version}" for name, version in self.machine["packages"].items())
        seeds = ", ".join(f"{name} {seed}" for name, seed in self.machine["seeds"].items())
        facts = {
            "Python": self.machine["python"],
            "system": f"{self.machine['system']}, {self.machine['cores']} cores",
            "packages": packages,
            "seeds": seeds,
        }
        return {
            "command": self.command,
            "facts": {name: value for name, value in facts.items() if value},
            "files": {name: PurePath(path).name for name, path in self.files.items()},
            "view": f"harness view {shlex.quote(PurePath(self.files['rrd']).name)}" if "rrd" in self.files else "",
        }


def setting(value: object) -> str:
    """A setting's value as one line."""
    if isinstance(value, float):
        return f"{value:.10g}"
    if isinstance(value, (list, tuple)):
        return " ".join(setting(inner) for inner in value)
    return str(value)

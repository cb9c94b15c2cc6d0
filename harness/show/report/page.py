"""A page of blocks as one HTML file that needs no network."""

import base64
import hashlib
import json
import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path, PurePath
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from harness.core.arrays import FloatArray
from harness.core.bounded import MOST_DOCUMENT_BYTES, read_bytes
from harness.core.writing import replacing
from harness.results.common import Machine
from harness.show.blocks import Block, Code, Facts, Figure, Page, Section
from harness.show.numbers import squared
from harness.show.plots import POINTS, thinned

LARGEST = 5_000_000
"""Bytes a page may have."""
_BUNDLE = "plotly-cartesian.min.js"
_SHARED = Path("..", _BUNDLE)
"""Where published pages have their plotting library together, seen from each."""
_ALLOWED, _ALLOWED_SHARED = "script-src 'unsafe-inline';", "script-src 'unsafe-inline' 'self' file:;"
_SCRIPT_SHARED = f'<script src="{_SHARED.as_posix()}"></script>'


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("harness.show.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["symbols"] = symbols
    return environment


_GREEK = {"omega": "ω", "zeta": "ζ", "sigma": "σ", "beta": "β", "Omega": "Ω"}
_SYMBOL = re.compile(r"\b(?:(omega|Omega|sigma|zeta|beta)(?:_(\w+))?|([xfvckmaXFN])_(\w{1,2}))\b")
_OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*")


def symbols(text: str) -> Markup:
    """Sentences with x_k, omega_n, +- and the like set as people print them, and options that no line breaks."""

    def one(found: re.Match[str]) -> str:
        base, index = _GREEK.get(found[1], found[3]), found[2] or found[4]
        return f"{base}<sub>{index}</sub>" if index else base

    shown = squared(_SYMBOL.sub(one, str(escape(text)).replace("+-", "\u00b1")))
    return Markup(_OPTION.sub(r'<span class="option">\g<0></span>', shown))


def _beside(name: str) -> Markup:
    return Markup((files("harness.show.report") / "templates" / name).read_text(encoding="utf-8"))


def _bundle() -> Markup:
    text = (files("harness.show") / "vendor" / _BUNDLE).read_text(encoding="utf-8")
    return Markup(text.replace("</script", "<\\/script"))


@dataclass(slots=True)
class Pool:
    """Arrays of a page, each stored once as base64 of little-endian doubles."""

    arrays: dict[str, str] = field(default_factory=dict)

    def add(self, values: FloatArray) -> str:
        """The key under which the page finds these numbers; nan draws a gap."""
        data = np.ascontiguousarray(values, dtype="<f8").tobytes()
        key = hashlib.blake2b(data, digest_size=6).hexdigest()
        self.arrays.setdefault(key, base64.b64encode(data).decode("ascii"))
        return key

    def spec(self, figure: Figure) -> dict[str, Any]:
        """The figure as JSON, arrays replaced by {"$": key}."""
        traces = [
            {key: value for key, value in trace.items() if key not in ("t", "now")}
            for trace in thinned(figure, POINTS // max(1, len(figure.traces)))
        ]
        kept = {"traces": self._plain(traces), "layout": self._plain(figure.layout)}
        return {"name": figure.name, **kept, "group": figure.group}

    def _plain(self, value: object) -> Any:
        if isinstance(value, np.ndarray):
            return {"$": self.add(value)}
        if isinstance(value, np.generic):
            return value.item()
        if isinstance(value, Mapping):
            return {key: self._plain(inner) for key, inner in value.items()}
        if isinstance(value, (list, tuple)):
            return [self._plain(inner) for inner in value]
        return value


def script_json(value: object) -> str:
    """JSON that can stand inside a script element whatever text it holds."""
    return json.dumps(value, allow_nan=False).replace("<", "\\u003c").replace("\u2028", "\\u2028")


def made_with(machine: Machine, files: Mapping[str, str], command: str) -> Section:
    """How a page ends: files, versions. command : the line that makes it again."""
    blocks: list[Block] = [Code(command, intro="This command makes it again:")] if command else []
    if "rrd" in files:
        intro = "Every sample of every trace is in the .rrd beside this page; this opens it:"
        blocks.append(Code(f"harness view {shlex.quote(PurePath(files['rrd']).name)}", intro=intro))
    if files:
        blocks.append(Facts({name: PurePath(path).name for name, path in files.items()}))
    facts = {
        "Python": machine.python,
        "system": f"{machine.system}, {machine.cores} cores",
        "packages": ", ".join(f"{name} {version}" for name, version in machine.packages.items()),
        "seeds": ", ".join(f"{name} {seed}" for name, seed in machine.seeds.items()),
    }
    blocks.append(Facts({name: value for name, value in facts.items() if value}))
    return Section("Files, and how to make this again", blocks)


def render(page: Page) -> str:
    """The page as text."""
    pool, figures = Pool(), []

    def register(figure: Figure) -> str:
        figures.append(pool.spec(figure))
        return ""

    environment = _environment()
    drawn = environment.get_template("blocks.html.j2").module.draw  # type: ignore[attr-defined]
    parts = [
        {"id": f"section-{index}", "title": section.title, "body": drawn(section.blocks, register)}
        for index, section in enumerate(section for section in page.sections if section.blocks)
    ]
    return environment.get_template("page.html.j2").render(
        title=page.title,
        subtitle=page.subtitle,
        parts=parts,
        style=_beside("page.css"),
        script=_beside("page.js"),
        plotly=_bundle(),
        figures=Markup(script_json(figures)),
        arrays=Markup(script_json(pool.arrays)),
    )


def write_report(path: Path, page: Page) -> None:
    """Write the page; it appears whole or not at all.

    Raises StoreError when it cannot be written, ValueError when it would be larger than 5 MB (a section that does not
    decimate its data).
    """
    data = render(page).encode("utf-8")
    if len(data) > LARGEST:
        raise ValueError(f"the page {path.name} would take {len(data)} bytes; at most {LARGEST} are allowed")
    with replacing(path) as part:
        part.write_bytes(data)


def share(page: Path, into: Path) -> None:
    """Put a page at ``into`` without its plotting library, which stands once beside the folder of ``into``."""
    bundle = str(_bundle())
    text = page.read_text(encoding="utf-8").replace(f"<script>{bundle}</script>", _SCRIPT_SHARED)
    into.write_text(text.replace(_ALLOWED, _ALLOWED_SHARED, 1), encoding="utf-8")
    (into.parent / _SHARED).write_text(bundle, encoding="utf-8")


def whole(page: Path) -> bytes:
    """A page as it was made: with its plotting library, where it shares that with others."""
    data = read_bytes(page, MOST_DOCUMENT_BYTES)
    shared = _SCRIPT_SHARED.encode()
    if shared not in data or not (page.parent / _SHARED).is_file():
        return data
    bundle = read_bytes(page.parent / _SHARED, MOST_DOCUMENT_BYTES)
    alone = data.replace(shared, b"<script>" + bundle + b"</script>")
    return alone.replace(_ALLOWED_SHARED.encode(), _ALLOWED.encode(), 1)

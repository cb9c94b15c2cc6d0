"""Sections to one HTML file that needs no network."""

import re
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from harness.core.bounded import MOST_DOCUMENT_BYTES, read_bytes
from harness.core.writing import replacing
from harness.show.report.section import Figure, Pool, Section, script_json

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


def symbols(text: str) -> Markup:
    """Sentences with x_k, omega_n and the like set as people print them."""

    def one(found: re.Match[str]) -> str:
        base, index = _GREEK.get(found[1], found[3]), found[2] or found[4]
        return f"{base}<sub>{index}</sub>" if index else base

    return Markup(_SYMBOL.sub(one, str(escape(text))))


def _vendored(name: str) -> Markup:
    text = (files("harness.show") / "vendor" / name).read_text(encoding="utf-8")
    return Markup(text.replace("</script", "<\\/script"))


def render(title: str, subtitle: str, sections: Sequence[Section]) -> str:
    """The page as text. title : what it is about. subtitle : one line below it."""
    pool, figures = Pool(), []

    def figure(one: Figure) -> str:
        figures.append(pool.spec(one))
        return ""

    environment = _environment()
    parts: list[dict[str, Any]] = []
    for index, section in enumerate(sections):
        body = environment.get_template(section.template).render(register=figure, **section.context)
        parts.append({"id": f"section-{index}", "title": section.title, "body": Markup(body)})
    return environment.get_template("page.html.j2").render(
        title=title,
        subtitle=subtitle,
        parts=parts,
        style=Markup(environment.get_template("page.css").render()),
        script=Markup(environment.get_template("page.js").render()),
        plotly=_vendored(_BUNDLE),
        figures=Markup(script_json(figures)),
        arrays=Markup(script_json(pool.arrays)),
    )


def write_report(path: Path, title: str, subtitle: str, sections: Sequence[Section]) -> None:
    """Write the page; it appears whole or not at all.

    Raises StoreError when it cannot be written, ValueError when it would be larger than 5 MB (a section that does not
    decimate its data).
    """
    data = render(title, subtitle, sections).encode("utf-8")
    if len(data) > LARGEST:
        raise ValueError(f"the page {path.name} would take {len(data)} bytes; at most {LARGEST} are allowed")
    with replacing(path) as part:
        part.write_bytes(data)


def share(page: Path, into: Path) -> None:
    """Put a page at ``into`` without its plotting library, which stands once beside the folder of ``into``."""
    bundle = str(_vendored(_BUNDLE))
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

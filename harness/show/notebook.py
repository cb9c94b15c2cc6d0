"""A result in a notebook or a console: its page, its verdict and numbers as text, its numbers as a table, its plots.

A plot of the page is a figure of plotly or matplotlib, whichever is installed.
"""

import gzip
import re
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.errors import InputError, did_you_mean
from harness.results.common import P, Paged, Result
from harness.show.blocks import Block, Figure, Folded, Page
from harness.show.numbers import number, sentence_quantity
from harness.show.plots import POINTS, Trace, thinned
from harness.show.report.page import render, whole

_LOOKS = "width:100%;height:min(85vh,900px);border:0;background:white"
_UNPACKED = """<p>This page needs a browser of 2023 or later, with scripts.</p>
<script type="text/plain">%s</script><script>
const packed = Uint8Array.from(atob(document.scripts[0].text), one => one.charCodeAt(0));
const page = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
new Response(page).text().then(text => { document.open(); document.write(text); document.close(); });
</script>"""
"""A document that is replaced by the one packed in it (gzip, base64)."""
_NAMES = ("label", "name", "what", "file", "joint")
"""Fields by which one of several is known, the first that it has."""
_SAID = ("statement", "conclusions", "sentences", "shortfalls", "wrong", "warnings")
"""Fields that say what came out, in order."""
_MOST_LINES = 24


def html(result: Paged) -> str:
    """The page in a frame of its own; the text where neither the motion nor the written page is there any more."""
    page = page_of(result)
    if page is not None:
        shown = render(page)
    else:
        files: Mapping[str, str] = getattr(result, "files", None) or getattr(result, "outputs", {})
        report = Path(files.get("report", ""))
        if not report.is_file():
            return f"<pre>{escape(text(result))}</pre>"
        shown = whole(report).decode("utf-8")
    # a document inside the document: neither's style or script reaches the other; packed, since a notebook keeps the
    # output of every cell that shows one, the library of its plots included
    packed = b64encode(gzip.compress(shown.encode("utf-8"), mtime=0)).decode("ascii")
    return f'<iframe title="report" srcdoc="{escape(_UNPACKED % packed)}" style="{_LOOKS}"></iframe>'


def text(result: Paged) -> str:
    """What it says in sentences, then every number with its error and unit, or its rows, a line each."""
    found = next((said for name in _SAID if (said := getattr(result, name, None))), None)
    said = [found] if isinstance(found, str) else list(found or [])
    if result.LINES:
        lines = [", ".join(f"{k} {v}" for k, v in row.items()) for row in map(_short, _lines(result))]
    else:
        lines = [f"{'.'.join(way)} = {sentence_quantity(p)}" for way, p in _numbers(result, ()) if p.value is not None]
    more = [f"... and {len(lines) - _MOST_LINES} more: to_frame()"] if len(lines) > _MOST_LINES else []
    return "\n".join([*said, *lines[:_MOST_LINES], *more]) or type(result).__name__


def frame(result: Paged) -> Any:
    """Every number with its error and unit as a pandas.DataFrame, a row each; of a table its own rows.

    Rows of numbers go by "part" ("baseline", "refined", "mechanisms.quadratic-drag", "estimates.displacement") and
    "quantity"; columns are value, stderr, systematic, unit, and why a value or an error is missing. Raises InputError
    without pandas.
    """
    try:
        pandas = import_module("pandas")
    except ImportError:
        raise InputError("to_frame", "pandas is not installed", "try: pip install pandas") from None
    if result.LINES:
        return pandas.json_normalize(_lines(result))
    rows = list(_numbers(result, ()))
    places = [(".".join(way[:-1]), way[-1]) for way, _ in rows]
    index = pandas.MultiIndex.from_tuples(places, names=["part", "quantity"])
    columns = {name: [getattr(p, name) for _, p in rows] for name in ("value", "stderr", "systematic", "unit", "why")}
    return pandas.DataFrame(columns, index=index).astype({"value": float, "stderr": float, "systematic": float})


def _lines(result: Paged) -> list[dict[str, Any]]:
    return [row.model_dump(mode="json") for row in getattr(result, result.LINES)]


def _short(row: Mapping[str, Any]) -> dict[str, str]:
    """What of a row is a name or a number."""
    plain = {k: number(v) if isinstance(v, float) else v for k, v in row.items() if v not in (None, "")}
    return {k: str(v) for k, v in plain.items() if isinstance(v, str | int)}


def _numbers(value: object, way: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], P]]:
    """Every number below a value, with the names on the way to it; "parameters" says nothing, and is left out."""
    if isinstance(value, P):
        yield way, value
    elif isinstance(value, Result):
        for name in type(value).model_fields:
            yield from _numbers(getattr(value, name), way if name == "parameters" else (*way, name))
    elif isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _numbers(inner, (*way, str(name)))
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            known = (str(getattr(inner, name)) for name in _NAMES if hasattr(inner, name))
            yield from _numbers(inner, (*way, next(known, str(place + 1))))


LIBRARIES = ("plotly", "matplotlib")
_OURS = {"ink": "#1c2127", "muted": "#667080", "rule": "#dfe2e6", "middle": "#c9ccd1"}
"""Colours that a page has its own of."""
_INCH, _WIDE = 100.0, 9.0
"""Pixels of an inch; inches of a figure's width."""
_INDEX = re.compile(r"<sub>(.*?)</sub>")
_DASHES = {"dash": "--", "dot": ":", "dashdot": "-."}


def page_of(result: Paged) -> Page | None:
    """The page that a result is drawn on; None of one that was read from a file."""
    page = result._drawing.page
    found: Page | None = page(result) if callable(page) else page
    return found


def names(result: Paged) -> list[str]:
    """Of the plots on its page, in their order."""
    return [figure.name for figure in _figures(result)]


def plot(result: Paged, name: str | None, library: str | None) -> Any:
    """See Paged.plot."""
    figures = {figure.name: figure for figure in _figures(result)}
    if not figures:
        found = "the motions are not in it: it was read from a file, or has no plot"
        raise InputError("plot", found, "a result made in this session, such as harness.diagnose(FILE).plot()")
    name = next(iter(figures)) if name is None else name
    if name not in figures:
        raise InputError("plot", f"{name!r} is none", f"one of {', '.join(figures)}{did_you_mean(name, figures)}")
    library = library or next((one for one in LIBRARIES if find_spec(one) is not None), LIBRARIES[0])
    if library not in LIBRARIES:
        raise InputError("plot: library", f"{library!r} is not known", f"{' or '.join(LIBRARIES)}")
    if find_spec(library) is None:
        raise InputError("plot", f"{library} is not installed", f"try: pip install {library}")
    return (_in_plotly if library == "plotly" else _in_matplotlib)(figures[name])


def _figures(result: Paged) -> Iterator[Figure]:
    page = page_of(result)
    for section in () if page is None else page.sections:
        yield from _among(section.blocks)


def _among(blocks: Sequence[Block]) -> Iterator[Figure]:
    for block in blocks:
        if isinstance(block, Figure):
            yield block
        elif isinstance(block, Folded):
            yield from _among(block.blocks)


def _colored(value: Any) -> Any:
    """With the page's own colours as they are in light."""
    if isinstance(value, str):
        return _OURS.get(value.removeprefix("var(--").removesuffix(")"), value)
    if isinstance(value, Mapping):
        return {key: _colored(inner) for key, inner in value.items()}
    return [_colored(inner) for inner in value] if isinstance(value, list | tuple) else value


def _traces(figure: Figure) -> list[Trace]:
    """As they are drawn, without what only pages read."""
    drawn = thinned(figure, POINTS // max(1, len(figure.traces)))
    return [{k: _colored(v) for k, v in trace.items() if k not in ("t", "now", "meta")} for trace in drawn]


def _in_plotly(figure: Figure) -> Any:
    layout = {"template": "plotly_white", "height": figure.height + 80, "legend": {"orientation": "h", "y": 1.12}}
    return import_module("plotly.graph_objects").Figure(_traces(figure), layout | _colored(dict(figure.layout)))


def _in_matplotlib(figure: Figure) -> Any:
    drawn = import_module("matplotlib.figure").Figure((_WIDE, figure.height / _INCH), layout="constrained")
    planes: dict[str, Any] = {}
    traces = _traces(figure)
    wanted = list(dict.fromkeys(str(trace.get("xaxis", "x")) for trace in traces))
    for place, axis in enumerate(wanted, 1):
        plane = planes[axis] = drawn.add_subplot(1, len(wanted), place)
        for way in ("x", "y"):
            _axis(plane, way, figure.layout.get(f"{way}axis{axis[1:]}", {}))
    for before, trace in zip([None, *traces], traces, strict=False):
        _KINDS[trace["type"]](planes[str(trace.get("xaxis", "x"))], trace, before)
    for plane in planes.values():
        for shape in figure.layout.get("shapes", ()):
            _shape(plane, _colored(shape))
        if figure.layout.get("showlegend", len(traces) > 1) and plane.get_legend_handles_labels()[1]:
            plane.legend(frameon=False, fontsize="small")
    return drawn


def _axis(plane: Any, way: str, axis: Mapping[str, Any]) -> None:
    title = axis.get("title", "")
    text = str(title.get("text", "") if isinstance(title, Mapping) else title)
    getattr(plane, f"set_{way}label")(_INDEX.sub(r"$_{\\mathrm{\1}}$", text))
    if axis.get("type") == "log":
        getattr(plane, f"set_{way}scale")("log")
    if axis.get("autorange") == "reversed":
        getattr(plane, f"invert_{way}axis")()


def _scatter(plane: Any, trace: Trace, before: Trace | None) -> None:
    x, y, line, marker = trace["x"], trace["y"], trace.get("line", {}), trace.get("marker", {})
    if trace.get("fill") == "tonexty" and before is not None:
        plane.fill_between(np.asarray(x), np.asarray(before["y"]), np.asarray(y), color=_rgba(trace["fillcolor"]), lw=0)
    name = trace.get("name", "") if trace.get("showlegend", True) else ""
    color = line.get("color") or (marker.get("color") if isinstance(marker.get("color"), str) else None)
    dash = _DASHES.get(line.get("dash", ""), "-")
    if "lines" in trace.get("mode", "lines") and line.get("width", 1.5) > 0:
        plane.plot(x, y, dash, color=color, lw=line.get("width", 1.5), label=name or "_")
    elif "markers" in trace.get("mode", ""):
        drawn = marker.get("color", color)
        size = float(marker.get("size", 5)) if np.ndim(marker.get("size", 5)) == 0 else 5.0
        one = isinstance(drawn, str) or drawn is None
        looks = {"color": drawn} if one else {"c": drawn, "cmap": "coolwarm", "vmin": marker.get("cmin")}
        looks |= {} if one else {"vmax": marker.get("cmax")}
        plane.scatter(x, y, s=size**2 / 2.0, label=name or "_", **looks)
    for way, at in (("error_y", "yerr"), ("error_x", "xerr")):
        if way in trace:
            error = trace[way]
            sizes = [error["arrayminus"], error["array"]] if "arrayminus" in error else error["array"]
            plane.errorbar(x, y, **{at: sizes}, fmt="none", ecolor=error.get("color", color))


def _bars(plane: Any, trace: Trace, _: Trace | None) -> None:
    colors = trace.get("marker", {}).get("color")
    if trace.get("orientation") == "h":
        drawn = plane.barh(trace["y"], trace["x"], color=colors, label=trace.get("name", "_"))
    else:
        drawn = plane.bar(trace["x"], trace["y"], color=colors, label=trace.get("name", "_"))
    if "text" in trace:
        plane.bar_label(drawn, trace["text"], padding=3)


def _heatmap(plane: Any, trace: Trace, _: Trace | None) -> None:
    z = np.array(trace["z"], dtype=np.float64)
    x, y = (list(trace.get(way, range(size))) for way, size in (("x", z.shape[1]), ("y", z.shape[0])))
    drawn = plane.pcolormesh(x, y, z, shading="nearest", vmin=trace.get("zmin"), vmax=trace.get("zmax"))
    plane.figure.colorbar(drawn, ax=plane)


_KINDS = {"scatter": _scatter, "bar": _bars, "heatmap": _heatmap}


def _shape(plane: Any, shape: Mapping[str, Any]) -> None:
    """A line or a band across; the others stay a page's."""
    across, line = shape.get("yref") == "paper", shape.get("line", {})
    low, high = (shape["x0"], shape["x1"]) if across else (shape["y0"], shape["y1"])
    looks = {"color": line.get("color"), "lw": 1, "ls": _DASHES.get(line.get("dash", ""), "-"), "zorder": 0}
    if shape["type"] == "rect":
        span = plane.axvspan if across else plane.axhspan
        span(low, high, color=_rgba(shape["fillcolor"]), lw=0, zorder=0)
    elif low == high:
        (plane.axvline if across else plane.axhline)(low, **looks)


def _rgba(color: str) -> Any:
    """A colour with the transparency that plotly writes; any other as it is."""
    if not color.startswith("rgba("):
        return color
    *parts, alpha = (float(part) for part in color[5:-1].split(","))
    return (*(part / 255.0 for part in parts), alpha)

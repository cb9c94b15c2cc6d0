"""Small line drawings as SVG, in colours that read on white and on black, without a library."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np

GREY, PALE, FIRST, SECOND = "#7c7c7c", "#9a9a9a", "#2b7fd6", "#e4632d"
_FONT = "font-family='system-ui,sans-serif' font-size='17'"


@dataclass(slots=True)
class Panel:
    """An axis with lines over a common horizontal one.

    box : left, top, width, height in pixels. across, up : ranges of the data.
    """

    box: tuple[float, float, float, float]
    across: tuple[float, float]
    up: tuple[float, float]
    parts: list[str] = field(default_factory=list)

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Pixels of a point."""
        left, top, width, height = self.box
        share = (x - self.across[0]) / (self.across[1] - self.across[0])
        rise = (y - self.up[0]) / (self.up[1] - self.up[0])
        return left + width * share, top + height * (1.0 - rise)

    def line(self, x: Sequence[float], y: Sequence[float], color: str, width: float = 1.4, dash: str = "") -> None:
        """A line through points."""
        shown = " ".join(f"{a:.1f},{b:.1f}" for a, b in (self.place(*p) for p in zip(x, y, strict=True)))
        dashed = f" stroke-dasharray='{dash}'" if dash else ""
        self.parts.append(
            f"<polyline fill='none' stroke='{color}' stroke-width='{width}' stroke-linejoin='round'{dashed} "
            f"points='{shown}'/>"
        )

    def band(self, low: float, high: float, color: str) -> None:
        """A level band over the whole width, no wider than the panel."""
        low, high = max(low, self.up[0]), min(high, self.up[1])
        (left, top), (right, bottom) = self.place(self.across[0], high), self.place(self.across[1], low)
        self.parts.append(
            f"<rect x='{left:.1f}' y='{top:.1f}' width='{right - left:.1f}' height='{bottom - top:.1f}' "
            f"fill='{color}' fill-opacity='0.22'/>"
        )

    def text(self, x: float, y: float, said: str, color: str = GREY, anchor: str = "start", dy: float = 0.0) -> None:
        """Words at a point."""
        a, b = self.place(x, y)
        self.parts.append(
            f"<text x='{a:.1f}' y='{b + dy:.1f}' fill='{color}' text-anchor='{anchor}' {_FONT}>{escape(said)}</text>"
        )

    def frame(self, title: str, ticks: Sequence[float] = (), unit: str = "s") -> None:
        """Zero, the ends of the scale, a title above, and ticks of the horizontal axis below."""
        left, top, width, height = self.box
        zero = self.place(self.across[0], 0.0)[1]
        self.parts.insert(0, f"<path d='M{left} {zero:.1f}h{width}' stroke='{PALE}' stroke-width='0.7'/>")
        self.parts.append(f"<path d='M{left} {top}v{height}' stroke='{PALE}' stroke-width='0.7'/>")
        self.parts.append(f"<text x='{left}' y='{top - 8}' fill='{GREY}' {_FONT}>{escape(title)}</text>")
        for value in (self.up[0], 0.0, self.up[1]):
            y = self.place(self.across[0], value)[1]
            self.parts.append(
                f"<text x='{left - 6}' y='{y + 5:.1f}' fill='{GREY}' text-anchor='end' {_FONT}>{value:g}</text>"
            )
        for value in ticks:
            said = f"{value:g} {unit}" if value == ticks[-1] else f"{value:g}"
            self.text(value, self.up[0], said, anchor="middle", dy=20.0)


def drawing(width: int, height: int, title: str, panels: Sequence[Panel]) -> str:
    """The file; ``title`` is what a screen reader says."""
    inner = "\n".join(part for panel in panels for part in panel.parts)
    return (
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' role='img'>\n"
        f"<title>{escape(title)}</title>\n{inner}\n</svg>\n"
    )


def rounded(value: float) -> float:
    """The next larger of 1, 1.5, 2, 3, 5, 7 times a power of ten, for the end of a scale."""
    power = 10.0 ** np.floor(np.log10(value))
    steps = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0)
    return float(f"{power * next(step for step in steps if step * power >= 0.999 * value):.3g}")

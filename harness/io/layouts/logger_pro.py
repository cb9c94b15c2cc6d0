"""Logger Pro's text export: "Vernier Format 2", file, run, names, short names, units, an empty line, rows of tabs."""

from collections.abc import Sequence

from harness.io.layout import Head, Layout, is_row


def _find(lines: Sequence[str], name: str) -> Head | None:
    if not lines or not lines[0].startswith("Vernier Format"):
        return None
    first = next((i for i, line in enumerate(lines) if is_row(line.split("\t"))), None)
    above = [line.split("\t") for line in lines[:first] if "\t" in line]
    if first is None or not above:
        return None
    units = above[-1] if len(above) > 1 else [""] * len(above[0])
    decimal = "," if "," in lines[first] else "."
    return Head(first=first, fields=tuple(above[0]), units=tuple(unit.strip() for unit in units), decimal=decimal)


LAYOUT = Layout(name="Logger Pro", find=_find)

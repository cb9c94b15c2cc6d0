"""One colour a source, the same in the viewer and on the page."""

from collections.abc import Sequence

from harness.core.trajectory import Source

REFERENCE = "#8a93a0"
_PAIRS = (  # (tuned and the like, as shipped): hues that stay apart for most colour-blind readers
    ("#e4632d", "#f2b087"),
    ("#2b7fd6", "#93c3f2"),
    ("#1f9e77", "#8fd3bd"),
    ("#a45bc2", "#d6b1e4"),
    ("#b58900", "#e3cf7c"),
)


def colors(sources: Sequence[Source]) -> list[str]:
    """Hex colours: grey for the first (the reference), a hue for each engine, pale for its as-shipped preset."""
    names = list(dict.fromkeys(source.name for source in sources[1:]))
    found = [REFERENCE]
    for source in sources[1:]:
        strong, pale = _PAIRS[names.index(source.name) % len(_PAIRS)]
        found.append(pale if source.preset == "as-shipped" else strong)
    return found[: len(sources)]


def of_engines(sources: Sequence[Source]) -> list[str]:
    """The same where there is no reference."""
    return colors([Source("reference"), *sources])[1:]


def of_names(count: int) -> list[str]:
    """So many hues, strong ones first; they begin anew where there are too few."""
    hues = [strong for strong, _ in _PAIRS] + [pale for _, pale in _PAIRS]
    return [hues[i % len(hues)] for i in range(count)]

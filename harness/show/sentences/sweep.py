"""What a sweep shows, in sentences: which settings to change, and what stays wrong."""

from collections.abc import Mapping, Sequence
from typing import Any

from harness.fidelity.scores import Card
from harness.show.numbers import engine_name

ROUTES = {"joint": "joint friction", "contact": "contact friction", "law": "the clipped force law"}
WORDS = {"dt": "the step (s)", "leapfrog": "leapfrog (start half a step back, read speeds as means of two)"}
NOTICEABLE = 0.01
"""A distance from exact above this is worth a sentence."""
MOST = 3
"""Figures that a sentence names."""


def sentences(cards: Sequence[Card]) -> list[str]:
    """For every engine and route: what is wrong as shipped, what to change, what that mends, what stays wrong."""
    said = []
    pairs: dict[str, dict[str, Card]] = {}
    for card in cards:
        pairs.setdefault(about(card), {})[card.preset] = card
    for where, pair in pairs.items():
        shipped, tuned = pair.get("as-shipped"), pair.get("tuned")
        if shipped is not None:
            said.append(f"{where}: as shipped {_wrong(shipped, 'nothing is off by more than 1 %')}.")
        if shipped is not None and tuned is not None:
            change = _change(shipped, tuned)
            said.append(f"{where}: change {change}. Then {_mended(shipped, tuned)}.")
            said.append(f"{where}: what stays wrong after that: {_wrong(tuned, 'nothing above 1 %')}.")
    return said


def about(card: Card) -> str:
    """What a card is about, as its sentences begin."""
    place = f" ({card.environment})" if card.environment else ""
    return f"{engine_name(card.engine)} {card.version}{place}, {ROUTES.get(card.route, card.route)}"


def _known(card: Card) -> dict[str, float]:
    return {label: value for label, value in card.values.items() if value is not None}


def _wrong(card: Card, nothing: str) -> str:
    bad = sorted(((v, k) for k, v in _known(card).items() if v > NOTICEABLE), reverse=True)
    parts = [f"{label} off by {percent(value)}" for value, label in bad[:MOST]]
    more = f" and {len(bad) - MOST} more figures above 1 %" if len(bad) > MOST else ""
    return ", ".join(parts) + more if parts else nothing


def _mended(shipped: Card, tuned: Card) -> str:
    before, after = _known(shipped), _known(tuned)
    both = sorted(((before[k] - after[k], k) for k in before if k in after and before[k] > NOTICEABLE), reverse=True)
    parts = [f"{label} goes from {percent(before[label])} to {percent(after[label])}" for _, label in both[:MOST]]
    return ", ".join(parts) if parts else "nothing noticeable changes"


def _change(shipped: Card, tuned: Card) -> str:
    """The settings that tell the two apart and that the engine honours on this route."""
    first, second = _settings(shipped), _settings(tuned)
    ignored = " ".join(next(iter(tuned.rows.values()))["ignored"]) if tuned.rows else ""
    parts = [
        f"{WORDS.get(name, name)} to {_text(second[name])}"
        for name in second
        if first.get(name) != second[name] and f"{name}:" not in ignored and name not in ("route", "restoring")
    ]
    return ", ".join(parts) if parts else "nothing"


def _settings(card: Card) -> Mapping[str, Any]:
    rows = list(card.rows.values())
    settings: Mapping[str, Any] = rows[0]["settings"] if rows else {}
    return settings


def percent(value: float) -> str:
    """A share for people."""
    if value < 1e-5:
        return "less than 0.001 %"
    return f"{100.0 * value:.0f} %" if value >= 0.1 else f"{100.0 * value:.2g} %"


def _text(value: object) -> str:
    if isinstance(value, list):
        return "(" + " ".join(_text(inner) for inner in value) + ")"
    return f"{value:.6g}" if isinstance(value, float) else str(value)

"""Text of unknown origin as a terminal may show it."""

import unicodedata

_KEPT = "\n\t"


def visible(text: str) -> str:
    """``text`` with every character that a terminal or an editor would obey, not show, as its escape.

    Those are control characters (ESC begins a command to the terminal), marks that turn the direction of writing, and
    the halves of characters that stand for bytes which are no UTF-8. New lines and tabs stay.
    """
    if text.isprintable():
        return text
    return "".join(_escaped(c) if c not in _KEPT and unicodedata.category(c)[0] == "C" else c for c in text)


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")

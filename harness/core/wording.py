"""How sentences are put together."""

import re

_NAME = re.compile(r"\S*\w[._/]\w|[A-Za-z]+\d|zeta\b")
"""At the beginning of a symbol or of the name of a joint, a file or a column: x_k, elbow.position, q2."""


def capitalised(text: str) -> str:
    """A sentence begun with a capital, unless it begins with a symbol or a name, whose letters are its own."""
    return text if not text or _NAME.match(text) else f"{text[0].upper()}{text[1:]}"

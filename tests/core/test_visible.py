"""A terminal shows what it is given and obeys none of it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.errors import InputError, visible


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("x [µm], Weg 2", "x [µm], Weg 2"),
        ("\x1b]0;title\x07", r"\x1b]0;title\x07"),
        ("a\rb\x00\x7f\x9b", r"a\rb\x00\x7f\x9b"),
        ("\u202efdp.exe", r"\u202efdp.exe"),
        ("bad\udcff", r"bad\udcff"),
        ("two\nlines\tand a tab", "two\nlines\tand a tab"),
    ],
)
def test_what_would_be_obeyed_is_escaped(text: str, shown: str) -> None:
    assert visible(text) == shown


@given(st.text(), st.text(max_size=30))
def test_an_error_is_one_line_of_text(found: str, where: str) -> None:
    said = str(InputError(where, found, "this is accepted"))
    said.encode()
    assert "\n" not in said
    assert not any(ord(c) < 32 or 127 <= ord(c) < 160 for c in said)
    assert said.endswith("this is accepted")
    assert len(said) < 6000

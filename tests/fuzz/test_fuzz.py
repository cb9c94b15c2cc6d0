"""Whatever is in a file or on the command line: a recording, or one line that says why not; soon, and in bounds.

The search that is steered by branches runs for a moment; its long form is ``python -m benchmarks.fuzz``.
"""

import os
import signal
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest
from hostile import BASE, MODEL, T, X, mat, mat73, mat_packed, parquet
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mutations import changed, spots

from benchmarks.fuzz.search import Search, stored
from benchmarks.fuzz.targets import NAMES, TARGETS, Target
from harness.app.shared.reading import read
from harness.core.errors import HarnessError, InputError
from harness.core.recording import Recording
from harness.core.scenario import FREE_DECAY
from harness.exact.decay import free_decay
from harness.io.columns import parse_columns
from harness.io.options import ReadOptions
from harness.io.units import parse_unit, split_header
from harness.model.document import from_document, to_document
from harness.show.report.motion import run_scene
from harness.show.trace import write_trace

HANG_S = 5.0
FULL = os.environ.get("HARNESS_FUZZ", "")
"""How many examples of each kind the long form tries."""
LONG = settings(
    max_examples=int(FULL or 3000), deadline=None, derandomize=not FULL, suppress_health_check=list(HealthCheck)
)
SHORT = settings(max_examples=100, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
APART = settings(SHORT, max_examples=3)
"""Every example starts a process."""


@contextmanager
def no_hang() -> Iterator[None]:
    """End a test that computes for ever; time of this process, so that a busy machine does not count."""

    def stop(signum: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"computes for more than {HANG_S} s")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, HANG_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def said(error: InputError, name: str) -> None:
    """One line, of a length that is read, that a terminal shows and that names what is wrong."""
    text = str(error)
    assert text.isprintable()
    assert len(text) < 2000
    assert name in text or text.startswith("--columns")


def reads(data: bytes, suffix: str, columns: str | None = None) -> None:
    """Read a file of these bytes: a recording that holds what one promises, or an error for people."""
    with tempfile.TemporaryDirectory() as folder, no_hang():
        path = Path(folder) / f"fuzzed{suffix}"
        path.write_bytes(data)
        try:
            found = read(path, ReadOptions(columns))
        except InputError as error:
            said(error, "fuzzed")
            return
    assert isinstance(found, Recording)
    assert len(found) >= 50
    assert all(np.all(np.isfinite(values)) for values in (found.t, *found.channels.values()))


def rrd(path: Path) -> None:
    t = np.linspace(0.0, 3.0, 301)
    write_trace(path, run_scene([free_decay(FREE_DECAY, t)], {"name": "free-decay"}, {}, "A test."))


def npz(path: Path) -> None:
    np.savez(path, t=T, x=X)


def npz_packed(path: Path) -> None:
    np.savez_compressed(path, t=T, x=X)


BINARY: dict[str, tuple[Callable[[Path], Any], str]] = {
    "npz": (npz, ".npz"),
    "npz packed": (npz_packed, ".npz"),
    "mat 5": (mat, ".mat"),
    "mat 5 packed": (mat_packed, ".mat"),
    "mat 7.3": (mat73, ".mat"),
    "parquet": (parquet, ".parquet"),
    "rrd": (rrd, ".rrd"),
}


def valid(make: Callable[[Path], Any], suffix: str) -> bytes:
    """The bytes of a valid file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"valid{suffix}"
        make(path)
        return path.read_bytes()


def try_binary(kind: str, options: settings) -> None:
    make, suffix = BINARY[kind]
    data = valid(make, suffix)

    @options
    @given(changed(data, spots(data)))
    def check(changed_data: bytes) -> None:
        reads(changed_data, suffix)

    check()


_COLUMNS = "t x v u q = =t x= * , [ ] [m] [mm #1 #0 #999999 1e308 1e-400 - ( ² ** m deg __import__('os')"
_UNITS = "m mm s g / * ** ^ 2 9 -1 ( ) ² ⁻¹ e . lbf degC delta_degF % count [ ] kilo µ nan inf 0"
PIECES = [*_COLUMNS.split(), *("\x1b", "\n", " ", "9" * 50, "\u202e", "\ud800")]
UNITS = [*_UNITS.split(), " "]


def try_expressions(options: settings) -> None:
    @options
    @given(st.lists(st.sampled_from(PIECES), max_size=40).map("".join) | st.text(max_size=60))
    def columns(text: str) -> None:
        with no_hang():
            try:
                assert set(parse_columns(text)) <= set("txvau")
            except InputError as error:
                said(error, "--columns")

    @options
    @given(st.lists(st.sampled_from(UNITS), max_size=14).map("".join), st.sampled_from("txvau"), st.integers(0, 5000))
    def units(text: str, channel: str, blanks: int) -> None:
        with no_hang():
            name, unit = split_header(f"x{' ' * blanks}[{text}]")
            assert name.startswith("x")
            try:
                factor = parse_unit("header", channel, unit).factor
                assert np.isfinite(factor)
            except InputError as error:
                said(error, "header")

    columns()
    units()


JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**40), 10**40) | st.floats() | st.text(max_size=12),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3),
    max_leaves=6,
)
FIELDS = [
    *MODEL, *BASE, "f_s", "restoring", "terms", "mass_known", "x0", "t0", "name", "parameters", "internal",
    "variant",
]  # fmt: skip
TERM = st.fixed_dictionaries(
    {"name": st.sampled_from(["stribeck", "backlash", "viscoelastic", "cubic-stiffness", "no-such"])},
    optional={
        "parameters": st.dictionaries(st.sampled_from(["k3", "v_s", "f_s", "gap"]), JSON, max_size=3),
        "internal": JSON,
    },
)


def try_models(options: settings) -> None:
    @options
    @given(
        st.dictionaries(st.sampled_from(FIELDS), JSON, max_size=2),
        st.dictionaries(st.sampled_from([*BASE, "f_s", "y"]), JSON, max_size=2),
        st.lists(TERM, max_size=2),
    )
    def documents(top: dict[str, Any], base: dict[str, Any], terms: list[Any]) -> None:
        with no_hang():
            try:
                model = from_document(MODEL | {"base": BASE | base, "terms": terms} | top)
                assert from_document(to_document(model)) == model
            except InputError as error:
                said(error, "model")

    documents()


@pytest.mark.parametrize("kind", BINARY)
def test_binary_files(kind: str) -> None:
    try_binary(kind, APART)


def test_column_expressions_and_units() -> None:
    try_expressions(SHORT)


def test_model_files() -> None:
    try_models(SHORT)


@pytest.mark.full
@pytest.mark.parametrize("kind", ["expressions", "models", *BINARY])
def test_the_long_form(kind: str) -> None:
    if kind in BINARY:
        try_binary(kind, settings(LONG, max_examples=LONG.max_examples // 10))
    else:
        {"expressions": try_expressions, "models": try_models}[kind](LONG)


@pytest.mark.parametrize("name", [name for name, target in TARGETS.items() if not target.apart])
def test_what_earlier_searches_found_is_answered(name: str, tmp_path: Path) -> None:
    target = TARGETS[name]
    path = tmp_path / NAMES.get(name, f"fuzzed{target.suffix}")
    for data in (*target.seeds, *stored(name)):
        path.write_bytes(data)
        assert answered(target, path).isprintable()


def answered(target: Target, path: Path) -> str:
    """The line that refuses a file, "" for one that is read."""
    try:
        target.call(path)
    except HarnessError as error:
        return str(error)
    return ""


def test_a_short_search_finds_nothing_wrong() -> None:
    for name in ("table", "model", "npz"):
        search = Search(name, 1)
        search.run(0.7)
        assert search.tried > 0
        assert search.wrong == {}

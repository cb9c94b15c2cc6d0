"""The suite as tests of an engine's own: ``pytest --friction-fidelity`` has a test a row, against a baseline.

It comes with the package (entry point pytest11). Rows are found at collection and run where their test runs, so that
they are chosen (-k, -m), marked and shared out among processes as any other test.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from harness.app.sweep.regress import Rows, Version
    from harness.fidelity.row import Spec

MARK = "friction_fidelity"
_WRITE = "harness regress --baseline friction.json --update"
_NO_BASELINE = f"no baseline, and no fixture friction_baseline. Try: {_WRITE}, then --friction-baseline friction.json"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options, and what a project says once and for all in its configuration."""
    group = parser.getgroup("friction fidelity")
    group.addoption("--friction-fidelity", action="store_true", help="one test a row of the friction-fidelity suite")
    group.addoption("--friction-whole", action="store_true", help="every row, not what ships and is tuned at one step")
    group.addoption("--friction-baseline", type=Path, metavar="FILE", help="that harness regress --update wrote")
    group.addoption("--friction-engine", action="append", default=[], metavar="NAME[@PYTHON]", help="may repeat")
    parser.addini(
        "friction_baseline", "file that harness regress --update wrote, from the configuration's folder", "paths"
    )
    parser.addini("friction_engines", "engines whose rows are tests, all installed by default", "args")
    parser.addini("friction_skip", "rows that are skipped, PATTERN: WHY a line", "linelist")
    parser.addini("friction_xfail", "rows that are known to fail, PATTERN: WHY a line", "linelist")


def pytest_configure(config: pytest.Config) -> None:
    """The mark that every row's test has."""
    config.addinivalue_line("markers", f"{MARK}: a row of the friction-fidelity suite")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(session: pytest.Session, config: pytest.Config, items: list[pytest.Item]) -> None:
    """Add the rows, before -k and -m choose."""
    if config.getoption("--friction-fidelity"):
        items.extend(_rows(session))


def _named_baseline(config: pytest.Config) -> Path | None:
    """The file of the option, else of the configuration; None where a fixture has to say it."""
    given: Path | None = config.getoption("--friction-baseline")
    configured: list[Path] = config.getini("friction_baseline")
    return given if given is not None else next(iter(configured), None)


class _Suite(pytest.Collector):
    """What the rows' tests are below."""

    def collect(self) -> list[pytest.Item]:
        return []


def _rows(session: pytest.Session) -> Iterator[pytest.Item]:
    """Raises pytest.UsageError for an engine that there is not, and for a baseline that was named and is none."""
    from harness.app.sweep.sweep import SweepOptions, engines_for
    from harness.core.errors import HarnessError
    from harness.fidelity.select import Selection

    config = session.config
    chosen = config.getoption("--friction-engine") or config.getini("friction_engines")
    whole: bool = config.getoption("--friction-whole")
    known = Selection.of(skip=config.getini("friction_skip"), xfail=config.getini("friction_xfail"))
    if (named := _named_baseline(config)) is not None:
        _held(named, pytest.UsageError)
    try:
        options = SweepOptions(tuple(chosen), short=not whole)
        specs = [*options.matrix.specs(engines_for(options))]
    except HarnessError as error:
        raise pytest.UsageError(str(error).replace("--engine", "--friction-engine", 1)) from None
    suite = _Suite.from_parent(session, name="friction-fidelity", nodeid="friction-fidelity")
    for spec in specs:
        item: pytest.Item = pytest.Function.from_parent(suite, name=spec.name, callobj=_test_of(spec))
        item.add_marker(MARK)
        if (why := known.skipped(spec.name)) is not None:
            item.add_marker(pytest.mark.skip(reason=why))
        if (why := known.expected(spec.name)) is not None:
            item.add_marker(pytest.mark.xfail(reason=why))
        yield item
    if whole:
        item = pytest.Function.from_parent(suite, name="no-row-is-gone", callobj=_test_of_all(specs))
        item.add_marker(MARK)
        yield item


def _held(baseline: Path, kind: Callable[[str], BaseException]) -> "Mapping[Version, Rows]":
    """Rows of a baseline by engine and version; ``kind`` is raised for what is none."""
    from harness.app.sweep.regress import held
    from harness.core.errors import InputError

    try:
        return held(baseline)
    except InputError as error:
        raise kind(f"--friction-baseline {baseline}: {error.found}. Try: {_WRITE}") from None


def _test_of(spec: "Spec") -> Callable[..., None]:
    def test(friction_held: "Mapping[Version, Rows]") -> None:
        from harness.app.sweep.parts import compute
        from harness.app.sweep.regress import against, sentence
        from harness.fidelity.compare import REGRESSIONS, kept, moved_rows

        if spec.engine.partition("@")[0] not in {engine for engine, _, _ in friction_held}:
            pytest.fail(
                f"the baseline has no row of {spec.engine}. Try: {_WRITE} --engine {spec.engine.partition('@')[0]}",
                pytrace=False,
            )
        now = {spec.name: kept(compute(spec))}
        before = against(friction_held, now)
        if not before:
            pytest.skip("the baseline does not have this row")
        bad = [sentence(moved) for moved in moved_rows(before, now) if moved.verdict in REGRESSIONS]
        if bad:
            pytest.fail("\n".join(bad), pytrace=False)

    return test


def _test_of_all(specs: "list[Spec]") -> Callable[..., None]:
    def test(friction_held: "Mapping[Version, Rows]") -> None:
        from harness.app.sweep.regress import known_rows

        labels = {(spec.engine.partition("@")[0], spec.version, spec.place): spec.label for spec in specs}
        gone = sorted(known_rows(friction_held, labels).keys() - {spec.name for spec in specs})
        if gone:
            pytest.fail("\n".join(["the matrix does not have these rows any more:", *gone]), pytrace=False)

    return test


@pytest.fixture(scope="session")
def friction_baseline(pytestconfig: pytest.Config) -> Path:
    """The file of rows to compare with, that harness regress --update wrote; a project's own fixture may replace it."""
    named = _named_baseline(pytestconfig)
    if named is None:
        pytest.fail(_NO_BASELINE, pytrace=False)
    return named


@pytest.fixture(scope="session")
def friction_held(friction_baseline: Path) -> "Mapping[Version, Rows]":
    """Rows of the baseline by engine and version, each by what its name holds besides."""
    return _held(friction_baseline, lambda text: pytest.fail.Exception(text, pytrace=False))


@pytest.fixture
def friction_regressions(request: pytest.FixtureRequest) -> Callable[..., list[str]]:
    """Call it with an engine's name: sentences on what got worse against the baseline, none when all is well."""

    def compare(engine: str, short: bool = True, baseline: Path | None = None) -> list[str]:
        from harness.app.sweep.regress import compared, fresh_rows, sentence
        from harness.app.sweep.sweep import SweepOptions
        from harness.fidelity.compare import REGRESSIONS

        path: Any = baseline or request.getfixturevalue("friction_baseline")
        options = SweepOptions((engine,), short=short, jobs=1)
        result = compared(path, fresh_rows(options), options)
        return [f"{moved.name}: {sentence(moved)}" for moved in result.moved if moved.verdict in REGRESSIONS]

    return compare

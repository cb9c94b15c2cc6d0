"""For an engine's own tests: ``pytest -p harness.app.pytest_friction --friction-baseline FILE``."""

from collections.abc import Callable
from pathlib import Path

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    """--friction-baseline: the rows to compare with."""
    parser.addoption("--friction-baseline", type=Path, help="baseline that harness regress --update wrote")


@pytest.fixture
def friction_regressions(pytestconfig: pytest.Config) -> Callable[..., list[str]]:
    """Call it with an engine's name: sentences on what got worse against the baseline, none when all is well."""

    def compare(engine: str, short: bool = True, baseline: Path | None = None) -> list[str]:
        from harness.app.sweep.ci import sentence
        from harness.app.sweep.regress import compared, fresh_rows
        from harness.app.sweep.sweep import SweepOptions
        from harness.fidelity.compare import REGRESSIONS

        path = baseline or pytestconfig.getoption("--friction-baseline")
        if path is None:
            pytest.fail("--friction-baseline FILE is needed; harness regress --update writes one")
        options = SweepOptions((engine,), short=short, jobs=1)
        result = compared(path, fresh_rows(options), options)
        return [f"{moved.name}: {sentence(moved)}" for moved in result.moved if moved.verdict in REGRESSIONS]

    return compare

"""What a gate found, as systems of continuous integration read it: JUnit XML, annotations of GitHub."""

from collections.abc import Iterable, Iterator, Sequence

from harness.fidelity.compare import REGRESSIONS, is_regression
from harness.results.sweep import Moved, RegressResult

MOST = 10
"""Annotations of a kind that GitHub shows for a step."""


def sentence(moved: Moved) -> str:
    if not moved.metric:
        return f"{moved.verdict}: {moved.why}"
    return f"{moved.metric} {moved.verdict}: {moved.before} -> {moved.after}, allowed {moved.why}"


def by_row(moved: Iterable[Moved]) -> dict[str, list[Moved]]:
    """What got worse, known or not, by the row's name."""
    bad: dict[str, list[Moved]] = {}
    for one in moved:
        if one.verdict in REGRESSIONS:
            bad.setdefault(one.name, []).append(one)
    return bad


def junit(result: RegressResult, names: Iterable[str]) -> str:
    """JUnit XML: one test case a row, its regressions as a failure; skipped and known to fail as pytest writes them."""
    from lxml import etree

    bad = by_row(result.moved)
    cases = sorted({*names, *bad, *result.skipped})
    failures = [name for name, found in bad.items() if any(map(is_regression, found))]
    counts = {"tests": len(cases), "failures": len(failures), "errors": 0}
    suite = etree.Element("testsuite", name="friction fidelity", **{name: str(n) for name, n in counts.items()})
    suite.set("skipped", str(len(result.skipped) + len(bad) - len(failures)))
    for name in cases:
        engine, _, rest = name.partition("/")
        case = etree.SubElement(suite, "testcase", classname=f"friction.{engine}", name=rest)
        if name in result.skipped:
            etree.SubElement(case, "skipped", type="pytest.skip", message=result.skipped[name])
        elif name in bad:
            lines, known = [sentence(moved) for moved in bad[name]], bad[name][0].expected
            if known is None:
                etree.SubElement(case, "failure", message=lines[0]).text = "\n".join(lines)
            else:
                etree.SubElement(case, "skipped", type="pytest.xfail", message=known).text = "\n".join(lines)
    root = etree.Element("testsuites")
    root.append(suite)
    return str(etree.tostring(root, xml_declaration=True, encoding="utf-8", pretty_print=True).decode())


def annotations(result: RegressResult) -> list[str]:
    """Workflow commands: errors of rows that got worse, warnings of what was not compared, notices of what passed."""
    bad = {name: found for name, found in by_row(result.moved).items() if any(map(is_regression, found))}
    errors = [_command("error", name, "\n".join(map(sentence, found))) for name, found in bad.items()]
    absent = [_command("warning", name, "in the baseline but not installed here") for name in result.not_run]
    unused = [_command("warning", text, "no row has a name that this pattern means") for text in result.unused]
    passed = [_command("notice", name, f"known to fail ({why}), and does not") for name, why in result.passed.items()]
    return [*_some("error", errors), *_some("warning", [*absent, *unused]), *_some("notice", passed)]


def _some(kind: str, lines: Sequence[str]) -> Iterator[str]:
    """As many as are shown, the last of which says how many there are besides."""
    yield from lines if len(lines) <= MOST else lines[: MOST - 1]
    if len(lines) > MOST:
        yield _command(kind, f"{len(lines) - MOST + 1} more", "the log of this step has them all")


def _command(kind: str, title: str, text: str) -> str:
    def escaped(value: str, marks: str) -> str:
        return "".join(f"%{ord(letter):02X}" if letter in marks else letter for letter in value)

    lines = "%\r\n"
    return f"::{kind} title={escaped(f'friction {title}', f'{lines}:,')}::{escaped(text, lines)}"

"""harness doctor."""

import click

from harness.cli.options import json_options
from harness.cli.output import Output, show_rows


@click.command(short_help="Versions, engines, viewer, browser, cache: what works and what does not.")
@json_options
def command(to: Output) -> int:
    """Versions, engines found, viewer, browser, numba cache, what does not work and why.

    Exit code 1 when something is missing that the main job needs.

    \b
    Example: harness doctor
             harness doctor --json -
    """
    from harness.app.doctor import doctor, healthy

    result = doctor()
    machine, heads = result.machine, ("what", "", "found", "needed for", "remedy")
    rows = [(one.name, "yes" if one.ok else "no", one.found, one.needed_for, one.remedy or "") for one in result.checks]
    title = f"Python {machine.python}, {machine.system}, {machine.cores} cores"
    to.give(result, lambda _: show_rows(heads, rows, heads, title))
    return 0 if healthy(result) else 1

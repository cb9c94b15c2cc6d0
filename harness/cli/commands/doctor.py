"""harness doctor."""

import click

from harness.cli.options import json_option, quiet_option
from harness.cli.output import check_json, emit_json, shows_tables
from harness.cli.tables import show


@click.command(short_help="Versions, engines, viewer, browser, cache: what works and what does not.")
@json_option
@quiet_option
def command(json_to: str | None, quiet: bool) -> int:
    """Versions, engines found, viewer, browser, numba cache, what does not work and why.

    Exit code 1 when something is missing that the main job needs.

    \b
    Example: harness doctor
             harness doctor --json -
    """
    from harness.app.doctor import doctor, healthy

    check_json(json_to)
    result = doctor()
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        from rich.table import Table

        table = Table(title=f"Python {result.machine.python}, {result.machine.system}, {result.machine.cores} cores")
        for heading in ("what", "", "found", "needed for", "remedy"):
            table.add_column(heading, overflow="fold")
        for check in result.checks:
            works = "yes" if check.ok else "no"
            table.add_row(check.name, works, check.found, check.needed_for, check.remedy or "")
        show(table)
    return 0 if healthy(result) else 1

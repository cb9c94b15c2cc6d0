"""``python -m benchmarks [--only NAME ...] [--json FILE]``: exit 1 when a target is missed, 2 on bad usage.

A row of an engine that is not here is left out, and said so on standard error.
"""

import argparse
import dataclasses
import json
import os
import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

from benchmarks.registry import Row, all_benchmarks, run
from harness.core.errors import SimulationError


def _seconds(value: float) -> str:
    for factor, unit in ((1.0, "s"), (1e3, "ms"), (1e6, "us")):
        if value * factor >= 1.0:
            return f"{value * factor:.3g} {unit}"
    return f"{value * 1e9:.3g} ns"


def _show(rows: list[Row], console: Console) -> None:
    table = Table(title="ours against a peer, alternated in this run, medians")
    for column in ("row", "ours", "peer", "ratio", "at most", "met"):
        table.add_column(column, no_wrap=True, justify="left" if column == "row" else "right")
    for row in rows:
        target = "-" if row.target is None else f"{row.target:.4g}"
        met = "-" if row.target is None else ("yes" if row.met else "[red]no[/red]")
        table.add_row(row.name, _seconds(row.ours_s), _seconds(row.peer_s), f"{row.ratio:.4g}", target, met)
    console.print(table)
    for row in rows:
        console.print(f"[bold]{row.name}[/bold]: {row.timed}. Peer: {row.peer}.", highlight=False)


def _write(file: str, rows: list[Row]) -> None:
    text = json.dumps({"rows": [dataclasses.asdict(row) for row in rows]}, indent=2) + "\n"
    if file == "-":
        sys.stdout.write(text)
        return
    beside = Path(f"{file}.part")
    beside.write_text(text)
    os.replace(beside, file)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--json", metavar="FILE", help="write the rows as JSON; - is standard output")
    parser.add_argument("--only", metavar="NAME", action="append", help="rows whose name contains this; may repeat")
    options = parser.parse_args(arguments)
    chosen = [b for b in all_benchmarks() if not options.only or any(part in b.name for part in options.only)]
    if not chosen:
        names = ", ".join(b.name for b in all_benchmarks())
        sys.stderr.write(f"--only: {' '.join(options.only)} matches no row; expected part of one of these: {names}\n")
        return 2
    progress = Console(stderr=True)
    rows = []
    for item in chosen:
        if progress.is_terminal:
            progress.print(f"[dim]{item.name} ...[/dim]")
        try:
            rows.append(run(item))
        except (ModuleNotFoundError, SimulationError) as why:
            sys.stderr.write(f"{item.name}: not run ({why})\n")
    if options.json != "-":
        _show(rows, Console())
    if options.json:
        _write(options.json, rows)
    return 0 if all(row.met for row in rows) else 1


if __name__ == "__main__":
    raise SystemExit(main())

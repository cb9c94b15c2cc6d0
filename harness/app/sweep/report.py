"""What is made of a finished sweep: result.json, traces of the worst rows, the page, a table for people."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from harness.app.shared.progress import SILENT, Progress
from harness.app.sweep.sweep import PAGE, TRACES, Sweep, SweepOptions, settings_of, write_result
from harness.app.sweep.traces import keep_worst, overlay
from harness.fidelity.laws import DAMPING, MASS, SERVOS, STEP, STIFFNESS, WITHOUT_EFFECT
from harness.fidelity.scores import COLUMNS, FIGURES, Card, badness, cards, front, points
from harness.show.blocks import Page
from harness.show.report.page import write_report
from harness.show.report.sweep import engine_color, sweep_sections
from harness.show.sentences.sweep import about, headline, percent, sentences

BRIEF = ("position", "x_k wide", "x_k narrow", "zeta", "creep 97 %", "belt period", "forced", "lift")
"""Figures of the table in the terminal."""
DRAWN = 1500
"""Samples of a curve on the page."""
Names = dict[tuple[str, str], str]
"""Something of every engine and version."""
_UNITS = {"m": ("mm", 1e3), "m_s": ("mm/s", 1e3), "s": ("ms", 1e3)}


def finish(result: Sweep, options: SweepOptions, progress: Progress = SILENT) -> None:
    """Write traces/, result.json and report.html into the folder; raises StoreError."""
    kept = keep_worst(result, options, progress)
    progress("writing result.json and report.html", result.total, result.total)
    write_page(result, kept)
    write_result(result)


def write_page(result: Sweep, kept: dict[str, str]) -> None:
    """The page; kept : names of trace files by the name of their row."""
    rows = [row for row in result.rows() if not row["draw"]]
    scored = cards(rows)
    shown = _shown(rows)
    names = sorted(set(shown.values()))
    colors = {key: engine_color(name, names) for key, name in shown.items()}
    data = {
        "headline": headline(scored),
        "sentences": [*sentences(scored), *result.notes],
        "about": [about(card) for card in scored],
        "cards": [_card(card, shown, colors) for card in scored],
        "figures": [{"label": figure.label, "good": figure.good, "group": _group(name)} for name, figure in COLUMNS],
        "points": _points(rows, shown, colors),
        "orders": [
            one.model_dump() | {"engine": shown[one.engine, one.version], "color": colors[one.engine, one.version]}
            for one in result.convergence()
        ],
        "creep": _creep(one_step_each(rows), shown, colors),
        "lift": _lift(one_step_each(rows), shown, colors),
        "servo": _servo(),
        "silent": [asdict(one) for one in WITHOUT_EFFECT],
        "worst": _worst(result.folder, rows, kept, colors),
        "machine": result.machine.model_dump(mode="json"),
        "files": {"rows": "rows", "result": "result.json"},
        "command": result.command,
    }
    versions = ", ".join(dict.fromkeys(f"{row['engine']} {row['version']}" for row in rows))
    failed = f", {result.failed} of them could not be run" if result.failed else ""
    subtitle = f"{result.total} rows{failed}: {versions}; every figure against an exact answer"
    page = Page("What engine settings do to Coulomb friction", subtitle, sweep_sections(data))
    write_report(result.folder / PAGE, page)


def _of(row: Mapping[str, Any]) -> tuple[str, str]:
    return row["engine"], row["version"]


def _shown(rows: Sequence[dict[str, Any]]) -> Names:
    """The name of every engine and version: with its environment where there are two of the engine."""
    places = {_of(row): row["environment"] for row in rows}
    several = {name for name, _ in places if sum(name == other for other, _ in places) > 1}
    return {
        (name, version): f"{name} ({place})" if place and name in several else name
        for (name, version), place in places.items()
    }


def _servo() -> dict[str, Any]:
    about = (
        f"What the way a servo is computed does to its damping, from the laws of docs/fidelity.md: stiffness "
        f"{STIFFNESS:g} N/m, step {STEP * 1e3:g} ms, {MASS:g} kg, {DAMPING:g} N s/m."
    )
    rows = [asdict(one) | {"false_damping": one.false_damping, "zeta": one.zeta} for one in SERVOS]
    return {"about": about, "rows": rows, "exact": SERVOS[0].zeta}


def _card(card: Card, shown: Names, colors: Names) -> dict[str, Any]:
    physical = {label: _physical(row, label) for label, row in card.rows.items()}
    first = next(iter(card.rows.values()), None)
    return {
        "engine": shown[card.engine, card.version],
        "version": card.version,
        "route": card.route,
        "preset": card.preset,
        "step": "" if card.dt_s is None else f"{card.dt_s * 1e3:.4g} ms",
        "settings": "" if first is None else _all_settings(first),
        "values": card.values,
        "physical": physical,
        "errors": card.errors,
        "color": colors[card.engine, card.version],
    }


def _group(scenario: str) -> str:
    return "free decay" if scenario.startswith("free-decay") else "hold, belt, harmonic force"


def _physical(row: dict[str, Any] | Any, label: str) -> str:
    """The metric itself, in a unit for people."""
    metric = next(figure.metric for figure in FIGURES if figure.label == label)
    value = row["metrics"].get(metric)
    if value is None:
        return ""
    for ending in ("_m_s", "_m", "_s"):
        if metric.endswith(ending):
            unit, factor = _UNITS[ending[1:]]
            return f"{value * factor:.4g} {unit}"
    return f"{value:.4g}"


def _all_settings(row: dict[str, Any] | Any) -> str:
    return ", ".join(f"{name} {value}" for name, value in row["settings"].items() if name not in ("route", "restoring"))


def _points(rows: Sequence[dict[str, Any]], shown: Names, colors: Names) -> list[dict[str, Any]]:
    found = points(rows)
    best = set()
    for route in {point.row["route"] for point in found}:
        best |= {id(point) for point in front([point for point in found if point.row["route"] == route])}
    return [
        {
            "engine": shown[_of(point.row)],
            "version": point.row["version"],
            "route": point.row["route"],
            "preset": point.row["preset"],
            "settings": settings_of(point.row),
            "cost": point.cost,
            "error": point.score,
            "best": id(point) in best,
            "color": colors[_of(point.row)],
        }
        for point in found
    ]


def one_step_each(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Of rows that differ in their step alone, those at the step nearest to 1 ms by ratio."""

    def settings(row: dict[str, Any]) -> tuple[str, ...]:
        # settings that follow the step are the same settings
        changed = {name: value for name, value in row["changed"].items() if not name.startswith(("solref", "solimp"))}
        return *_of(row), row["route"], row["preset"], repr(changed), row["integrator"]

    steps: dict[tuple[str, ...], set[float]] = {}
    for row in rows:
        if row["dt_s"] is not None:
            steps.setdefault(settings(row), set()).add(row["dt_s"])
    nearest = {key: min(found, key=lambda dt: abs(np.log(dt / 1e-3))) for key, found in steps.items()}
    return [row for row in rows if row["dt_s"] is not None and row["dt_s"] == nearest[settings(row)]]


def _creep(rows: Sequence[dict[str, Any]], shown: Names, colors: Names) -> list[dict[str, Any]]:
    found: dict[tuple[str, ...], dict[str, Any]] = {}
    for row in rows:
        if row["scenario"] in ("hold-50", "hold-97") and row["route"] != "law" and row["error"] is None:
            key = (*_of(row), row["route"], settings_of(row))
            line = found.setdefault(key, {"half": None, "most": None})
            line |= {"engine": shown[_of(row)], "version": row["version"], "route": row["route"]}
            line |= {"settings": settings_of(row), "color": colors[_of(row)]}
            line["half" if row["scenario"] == "hold-50" else "most"] = row["metrics"]["creep_m_s"]
    return list(found.values())


def _lift(rows: Sequence[dict[str, Any]], shown: Names, colors: Names) -> list[dict[str, Any]]:
    found = []
    for row in rows:
        metrics = row["metrics"]
        if (
            row["scenario"].startswith("free-decay")
            and metrics.get("lift_m") is not None
            and row["slider"]["f_k"] > 0.0
        ):
            release = abs(row["setup"]["release"]["x0"])
            found.append(
                {
                    "engine": shown[_of(row)],
                    "version": row["version"],
                    "settings": settings_of(row),
                    "release": release,
                    "ratio": metrics["mu_v_over_g_s"],
                    "lift": max(0.0, metrics["lift_m"]),
                    "normal": metrics["normal_error"],
                    "error": metrics["max_error_m"] / release,
                    "color": colors[_of(row)],
                }
            )
    return found


def _worst(folder: Path, rows: Sequence[dict[str, Any]], kept: dict[str, str], colors: Names) -> list[dict[str, Any]]:
    found = []
    by_name = {row["name"]: row for row in rows}
    for name, file in sorted(kept.items(), key=lambda item: item[1]):
        row = by_name[name]
        t, x, exact = overlay(folder / TRACES / file)
        chosen = np.unique(np.linspace(0, t.size - 1, min(DRAWN, t.size)).astype(np.int64))
        found.append(
            {
                "head": f"{row['engine']} {row['version']}, {row['route']}, {row['scenario']}",
                "file": file,
                "settings": settings_of(row),
                "badness": badness(row),
                "t": t[chosen],
                "x": x[chosen],
                "exact": exact[chosen],
                "color": colors[_of(row)],
            }
        )
    return found


def summary(result: Sweep) -> tuple[tuple[str, ...], list[list[str]]]:
    """Heads and lines of the table: what ships and what is tuned, by engine and route, distances from exact."""
    lines = []
    found = cards(result.rows())
    kinds = {(card.engine, card.version, card.environment) for card in found}
    for card in found:
        values = [_share(card.values.get(label)) for label in BRIEF]
        alone = sum(card.engine == engine for engine, _, _ in kinds) == 1
        lines.append([card.engine if alone else _named(card), card.route, card.preset, *values])
    return ("engine", "route", "settings", *BRIEF), lines


def _named(card: Card) -> str:
    """An engine of which there are two, told apart."""
    return f"{card.engine} {card.version}" + (f" ({card.environment})" if card.environment else "")


def _share(value: float | None) -> str:
    return "-" if value is None else percent(value).replace("less than ", "<")

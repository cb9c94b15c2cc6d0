"""Tables of a diagnosis: both models' parameters, what was left out, held-out prediction, engines."""

from collections.abc import Mapping
from typing import Any

from harness.show.diagnosis_scene import model_names
from harness.show.numbers import NONE, number, quantity
from harness.show.report.section import Cell, Column, Row, Section, Table
from harness.show.report.verdict import setting

_GRADES = {
    "explains": "explains it",
    "main": "main effect",
    "one-of": "one of these",
    "minor": "minor part",
    "tabulated": "tabulated",
}


def _units(result: Mapping[str, Any]) -> dict[str, str]:
    """Unit of a rmse by channel."""
    angular = any("rad" in p["unit"] for name, p in result["baseline"]["parameters"].items() if name == "x_k")
    return {"x": "rad", "v": "rad/s", "a": "rad/s²"} if angular else {"x": "m", "v": "m/s", "a": "m/s²"}


def _cell(p: Mapping[str, Any] | None, reasons: list[str]) -> Cell:
    if p is None:
        return Cell(NONE)
    value, stderr, _ = quantity(p)
    notes = [f"± {stderr}"] if stderr else []
    if p.get("why"):
        if p["why"] not in reasons:
            reasons.append(p["why"])
        notes.append(f"({reasons.index(p['why']) + 1})")
    return Cell(value, notes)


def _footnotes(reasons: list[str]) -> list[str]:
    return [f"({i + 1}) {reason}" for i, reason in enumerate(reasons)]


def models_section(result: Mapping[str, Any]) -> Section:
    """Parameters of both models. result : as in harness.diagnosis/2."""
    reasons: list[str] = []
    names = list(result["baseline"]["parameters"])
    units = _units(result)
    channels = list(result["baseline"]["rmse"])
    columns = [Column(n, quantity(result["baseline"]["parameters"][n])[2]) for n in names]
    columns += [Column("chi-square per point", "", "1 when only noise is left")]
    percent = result["fit_percent"] or {}
    fitted = [c for c in channels if percent]
    columns += [Column(f"fit of {c}", "%", "100 (1 - |y - y_model| / |y - mean y|), NRMSE") for c in fitted]
    columns += [Column(f"rmse of {c}", units.get(c, "")) for c in channels]
    rows = []
    for side, label in zip(("baseline", "refined"), model_names(result), strict=False):
        fit = result[side]
        cells = [_cell(fit["parameters"].get(n), reasons) for n in names]
        cells += [Cell(number(fit["chi2_per_point"], 4)), *(Cell(number(percent[side].get(c), 4)) for c in fitted)]
        cells += [Cell(number(fit["rmse"].get(c), 4)) for c in channels]
        rows.append(Row(label, cells))
    noise = result["recording"]["noise"]
    said = [Cell(number(s, 4) if isinstance(s, float) else str(s or NONE)) for s in (noise.get(c) for c in channels)]
    rows.append(
        Row(
            "noise",
            [*[Cell("")] * len(names), Cell("1"), *[Cell("")] * len(fitted), *said],
            "estimated from the data",
        )
    )
    return Section(
        "Fit before and after",
        "table.html.j2",
        {"tables": [Table("model", columns, rows, "Below each value: one standard error.", "", _footnotes(reasons))]},
    )


def mechanisms_section(result: Mapping[str, Any]) -> Section:
    """What was left out, with its parameters. result : as in harness.diagnosis/2."""
    tables = [_grades(result)]
    for mechanism in result["mechanisms"]:
        reasons: list[str] = []
        parameters = mechanism["parameters"]
        columns = [Column(name, quantity(p)[2]) for name, p in parameters.items()]
        columns += [Column("evidence", "BIC", "what BIC loses without it"), Column("acts")]
        cells = [_cell(p, reasons) for p in parameters.values()]
        place = mechanism["where"]
        spans = place["time_s"]
        when = f"{number(spans[0][0], 4)} to {number(spans[-1][1], 4)} s" if spans else NONE
        many = f" in {len(spans)} spans" if len(spans) > 1 else ""
        cells += [
            Cell(number(mechanism["delta_bic"], 4)),
            Cell(place["condition"], [f"{place['regime']}, {when}{many}"]),
        ]
        row = Row(mechanism["name"], cells, mechanism["family"])
        tables.append(
            Table("mechanism", columns, [row], mechanism["statement"].replace("+-", "\u00b1"), "", _footnotes(reasons))
        )
    return Section("What was left out", "table.html.j2", {"tables": tables})


def _grades(result: Mapping[str, Any]) -> Table:
    """How much of what is missing each is, how it predicts, and what else it could be."""
    columns = [
        Column("grade"),
        Column("P", "", "probability of being what is missing"),
        Column("share of the misfit", "%", "of the mean square beyond noise that it takes off alone"),
        Column("held-out error", "after / before", "blocks of cycles that took no part in the fit"),
        Column("free-run error", "after / before", "the last 40 %, from a fit of the first 60 %"),
        Column("not ruled out", "worse by, BIC"),
    ]
    rows = []
    for one in result["mechanisms"]:
        others = [f"{a['name']} ({number(a['delta_bic'], 2)})" for a in one["alternatives"]]
        share = None if one["share"] is None else 100.0 * one["share"]
        cells = [
            Cell(_GRADES[one["grade"]]),
            Cell(number(one.get("probability"), 2)),
            Cell(number(share, 3)),
            _ratios(one["holdout"]),
            _ratios(one["forward"]),
            Cell(others[0] if others else NONE, others[1:]),
        ]
        rows.append(Row(one["name"], cells, one["family"]))
    return Table("mechanism", columns, rows)


def _ratios(found: Mapping[str, Any] | None) -> Cell:
    """Error after over before: the largest of the channels, all of them below it."""
    if found is None:
        return Cell(NONE)
    pairs = [(c, found["refined_rmse"][c] / b) for c, b in found["baseline_rmse"].items() if b > 0.0]
    notes = [f"{c} {number(r, 2)}" for c, r in pairs] if len(pairs) > 1 else []
    return Cell(number(max((r for _, r in pairs), default=None), 2), notes)


def heldout_section(result: Mapping[str, Any]) -> Section:
    """Prediction of samples left out of the fits. result : as in harness.diagnosis/2."""
    held = result["holdout"]
    if not held["spans_s"]:
        return Section("Prediction of what was held out", "table.html.j2", {"tables": []})
    units = _units(result)
    noise = result["recording"]["noise"]
    rows = [
        Row(
            c,
            [
                Cell(number(before, 4)),
                Cell(number(held["refined_rmse"].get(c), 4)),
                Cell(number(held["refined_rmse"][c] / before if before and c in held["refined_rmse"] else None, 3)),
                Cell(number(noise[c], 4) if isinstance(noise.get(c), float) else str(noise.get(c) or NONE)),
            ],
            units.get(c, ""),
        )
        for c, before in held["baseline_rmse"].items()
    ]
    columns = [Column("rmse before"), Column("rmse after"), Column("after over before"), Column("noise")]
    spans = ", ".join(f"{low:.4g} to {high:.4g} s" for low, high in held["spans_s"][:8])
    more = f" and {len(held['spans_s']) - 8} more" if len(held["spans_s"]) > 8 else ""
    graded = any(one["holdout"] is not None for one in result["mechanisms"])
    what = "Each of these blocks of cycles" if graded else "Every second full period"
    caption = (
        f"{what} took no part in {'the fit that predicts it' if graded else 'these fits'} ({spans}{more}); the "
        "trajectory runs through. Which terms the model has was chosen on the whole recording."
    )
    if held.get("given"):
        caption += f" Given, not predicted: {', '.join(held['given'])}."
    return Section(
        "Prediction of what was held out", "table.html.j2", {"tables": [Table("channel", columns, rows, caption)]}
    )


def rules_section(result: Mapping[str, Any]) -> Section:
    """Numbers that moved the verdict, folded. result : as in harness.diagnosis/2."""
    rules = result["rules"]
    columns = [Column("value"), Column("unit"), Column("origin")]
    rows = [Row(r["name"], [Cell(number(r["value"], 4)), Cell(r["unit"]), Cell("", [r["origin"]])]) for r in rules]
    return Section(
        "Rules that decided",
        "rules.html.j2",
        {"count": f"{len(rows)} rules with their values and origins", "table": Table("rule", columns, rows)},
    )


def engines_section(result: Mapping[str, Any]) -> Section:
    """Both models in the engines. result : as in harness.diagnosis/2."""
    engines, units = result["engines"], _units(result)
    channels = list(result["baseline"]["rmse"])
    columns = [
        column
        for c in channels
        for column in (
            Column(f"rmse of {c} before", units.get(c, "")),
            Column(f"rmse of {c} after", units.get(c, "")),
            Column(f"own error in {c}", "noise", "rms against the exact motion of the refined model"),
        )
    ]
    rows, cards = [], []
    for name, engine in engines.items():
        label = f"{name} {engine['version']}".strip()
        if engine["error"]:
            rows.append(Row(label, [Cell("could not be run"), *[Cell(NONE)] * (len(columns) - 1)], engine["error"]))
            continue
        cells = [
            Cell(number((engine[block] or {}).get(c), 4))
            for c in channels
            for block in ("baseline_rmse", "refined_rmse", "own_error")
        ]
        step = engine["settings"].get("dt")
        rows.append(Row(label, cells, f"step {step * 1e3:.4g} ms" if step else ""))
        cards.append(
            {
                "head": label,
                "color": "var(--muted)",
                "line": f"step {step * 1e3:.6g} ms" if step else "",
                "ignored": engine["ignored"],
                "count": f"{len(engine['settings'])} settings",
                "settings": {key: setting(value) for key, value in engine["settings"].items()},
            }
        )
    return Section(
        "In the engines",
        "engines.html.j2",
        {
            "tables": [Table("engine", columns, rows, _ENGINES)],
            "cards": cards,
            "left_out": result["model_left_out"],
        },
    )


_ENGINES = (
    "The base model and the refined model simulated by each engine, sensors applied, against the recording. The last "
    "column of each channel is what the engine's own step adds, in units of the noise."
)

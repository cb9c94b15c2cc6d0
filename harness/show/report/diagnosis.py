"""The page of a diagnosis: what was left out, where, how well the model that has it does, and in which engines."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.show.numbers import number, quantity
from harness.show.report.diagnosis_bars import evidence_section, left_section, shares_section
from harness.show.report.diagnosis_figures import (
    Curves,
    before_section,
    mismatch_section,
    phase_plane_section,
    tables_section,
)
from harness.show.report.diagnosis_tables import (
    engines_section,
    heldout_section,
    mechanisms_section,
    models_section,
    rules_section,
)
from harness.show.report.section import Cell, Column, Row, Section, Table
from harness.show.report.verdict import made_with_section, verdict_section


def diagnosis_sections(
    recording: Recording, simulated: Sequence[Trajectory], result: Mapping[str, Any]
) -> list[Section]:
    """Sections of a diagnosis.

    simulated : base model and refined model at the recording's times, extra "shown x" and the like what their sensors
    show, and behind them the user's own simulation where there is one.
    result : DiagnosisResult.model_dump(by_alias=True) (harness.diagnosis/2).
    """
    seen, answer = Curves(recording, simulated, result), result["statement"].replace("+-", "\u00b1")
    sections: list[Section] = [
        verdict_section(answer, gained(result), heading="Verdict"),
        before_section(seen),
    ]
    if result.get("own"):
        sections.append(own_section(result))
    if result["mechanisms"]:
        sections.append(mechanisms_section(result))
    if result["remainder"] is not None:
        sections.append(left_section(result))
    if result["tables"] or result.get("surface"):
        sections.append(tables_section(result))
    sections.append(models_section(result))
    if result["evidence"]:
        sections.append(evidence_section(result))
    sections += [mismatch_section(seen), phase_plane_section(seen), heldout_section(result)]
    if more := said(result):
        sections.append(verdict_section("", more, heading="What to know besides"))
    if result["attribution"] is not None:
        sections.append(shares_section(result["attribution"]))
        if change := to_change(result["attribution"]):
            sections.append(verdict_section("", change, heading="What to change in your simulation"))
    if result["engines"]:
        sections.append(engines_section(result))
    if result["rules"]:
        sections.append(rules_section(result))
    sections.append(made_with_section(result["machine"], result["files"], result["command"]))
    return sections


def to_change(attribution: Mapping[str, Any]) -> list[str]:
    """What a trace reads, and the changes, a sentence each; one of a parameter begins with its symbol."""
    changes = [(c["said"], c["kind"] == "parameter") for c in attribution.get("changes") or []]
    said = [f"{text}." if symbol else f"{text[0].upper()}{text[1:]}." for text, symbol in changes]
    return [*(attribution.get("sentences") or []), *said]


def diagnosis_title(result: Mapping[str, Any]) -> tuple[str, str]:
    """Title and subtitle of the page."""
    about = result["recording"]
    channels = ", ".join(about["channels"])
    name = "the recording on standard input" if about["file"] == "-" else PurePath(about["file"]).name
    if several := result.get("recordings"):
        name = f"{len(several)} recordings of one machine"
    line = f"{about['samples']} samples of {channels} at {about['rate_hz']:.6g} Hz, {about['duration_s']:.4g} s"
    return f"What a simulation leaves out of {name}", line


def gained(result: Mapping[str, Any]) -> list[str]:
    """What the better model gains, in the figures that everyone knows."""
    percent = result["fit_percent"]
    helped = bool(result["mechanisms"])
    sentences = []
    before, after = (result[side]["chi2_per_point"] for side in ("baseline", "refined"))
    if before is not None:
        sentences.append(f"Chi-square per point {_change(before, after, helped)} (1 when only noise is left).")
    for c, fit in (percent["baseline"] if percent else {}).items():
        sentences.append(f"Fit of {c} (NRMSE) {_change(fit, percent['refined'][c], helped, ' %')}.")
    return sentences


def _change(before: float, after: float, helped: bool, unit: str = "") -> str:
    """What a figure does from one model to the other; what it is where there is no other."""
    if not helped:
        return f"is {number(before, 4)}{unit}"
    way = "rises" if after > before else "falls"
    return f"{way} from {number(before, 4)} to {number(after, 4)}{unit}"


def said(result: Mapping[str, Any]) -> list[str]:
    """What else it could be, where, what would decide, warnings."""
    sentences = []
    for mechanism in result["mechanisms"]:
        others = [f"{a['name']} (worse by {number(a['delta_bic'], 2)} in BIC)" for a in mechanism["alternatives"]]
        if others:
            sentences.append(f"The data do not rule out, in place of {mechanism['name']}: {', '.join(others)}.")
    for place in result["where"]:
        if place["regime"] == "throughout":
            sentences.append(f"Simulation and recording part throughout: {place['condition']}.")
            continue
        share = "" if place["share"] is None else f", which holds {100.0 * place['share']:.0f} % of the mismatch"
        sentences.append(f"Simulation and recording part where {place['condition']}{share}.")
    sentences += filter(None, [result["next_experiment"], *result["warnings"], *result["recording"]["notes"]])
    return [f"{sentence[0].upper()}{sentence[1:]}" for sentence in sentences]


VERDICTS = {
    "missing_physics": "physics left out",
    "main_effect": "main effect",
    "one_of": "one of several",
    "adequate": "adequate",
    "unexplained": "unexplained",
    "error": "could not be diagnosed",
}


def index_title(answers: Sequence[Mapping[str, Any]]) -> tuple[str, str]:
    """Title and subtitle of the page."""
    counts = Counter(answer["verdict"] for answer in answers)
    said = ", ".join(f"{counts[verdict]} {words}" for verdict, words in VERDICTS.items() if counts[verdict])
    return f"What simulations leave out of {len(answers)} recordings", said


def index_sections(answers: Sequence[Mapping[str, Any]], command: str) -> list[Section]:
    """Sections of the page. answers : entries of harness.diagnosis/2, each with "link", its page or ""."""
    counts = Counter(m["name"] for answer in answers for m in answer["mechanisms"])
    named = ", ".join(f"{name} ({count})" for name, count in counts.most_common())
    headline = f"Left out: {named}." if named else "No physics was found to be left out."
    sentences = [
        f"{answer['recording']['file']}: {answer['error']}" for answer in answers if answer["verdict"] == "error"
    ]
    return [verdict_section(headline, sentences, heading="Over all recordings"), recordings_section(answers, command)]


def recordings_section(answers: Sequence[Mapping[str, Any]], command: str) -> Section:
    """answers : entries with "link". command : the line that makes it again."""
    rows = [
        {
            "name": PurePath(answer["recording"]["file"]).name,
            "link": answer["link"],
            "verdict": VERDICTS[answer["verdict"]],
            "names": ", ".join(m["name"] for m in answer["mechanisms"]),
            "others": ", ".join(a["name"] for m in answer["mechanisms"] for a in m["alternatives"]),
            "before": number((answer.get("baseline") or {}).get("chi2_per_point"), 4),
            "after": number((answer.get("refined") or {}).get("chi2_per_point"), 4),
        }
        for answer in answers
    ]
    return Section("Recordings", "recordings.html.j2", {"rows": rows, "command": command})


def own_section(result: Mapping[str, Any]) -> Section:
    """A row a recording. result : as in harness.diagnosis/2, of several recordings."""
    own = result["own"]
    channels = list(own[0]["rmse"])
    length = own[0]["start"]["x0"]["unit"]
    zero = [Column("zero", length)] if own[0]["zero"] else []
    columns = [Column("begins at", "s", "on the axis of time on which all lie"), Column("start", length), *zero]
    for c in channels:
        columns += [Column(f"noise of {c}"), Column(f"rmse of {c}", "", "viscous and Coulomb")]
        columns += [Column("refined", "", f"rmse of {c}")] if result["mechanisms"] else []
    alone = [Column(name, p["unit"]) for name, p in own[0]["alone"].items()]
    rows = [Row(_name(one), [_cell(p) for p in one["alone"].values()]) for one in own]
    return Section(
        "Recordings of one machine",
        "table.html.j2",
        {
            "tables": [
                Table("recording", columns, [_row(result, one, channels) for one in own]),
                Table("recording", alone, rows, "Viscous and Coulomb friction fitted to each by itself."),
                *repeated_tables(result.get("together", {})),
            ]
        },
    )


def _row(result: Mapping[str, Any], one: Mapping[str, Any], channels: list[str]) -> Row:
    cells = [Cell(number(one["begins_s"], 4)), _cell(one["start"]["x0"])]
    cells += [_cell(one["zero"])] if one["zero"] else []
    for c in channels:
        noise, before = one["noise"][c], number(one["baseline_rmse"][c], 3)
        cells += [Cell(noise if isinstance(noise, str) else number(noise, 3)), Cell(before)]
        cells += [Cell(number(one["rmse"][c], 3))] if result["mechanisms"] else []
    return Row(_name(one), cells, "; ".join(one["differs"]))


def repeated_tables(together: Mapping[str, Any]) -> list[Table]:
    """What recordings say together of each parameter; none of one recording."""
    columns = [
        Column("of all", "", "its error counts the spread between recordings"),
        Column("error of one", "", "standard error of a single recording's value"),
        Column("spread between", "", "standard deviation beyond those errors"),
        Column("stands out"),
    ]
    rows = [
        Row(
            f"{name}, {one['value']['unit']}",
            [
                _cell(one["value"]),
                Cell(number(one["within"], 2)),
                Cell(number(one["between"], 2)),
                Cell(", ".join(PurePath(file).name for file in one["outliers"]) or "none"),
            ],
        )
        for name, one in together.items()
    ]
    return [Table("parameter", columns, rows, "The model above fitted to each by itself.")] if rows else []


def _name(one: Mapping[str, Any]) -> str:
    return PurePath(one["file"]).name


def _cell(p: Mapping[str, Any]) -> Cell:
    value, error, _ = quantity(p)
    return Cell(value, [f"\u00b1 {error}"] if error else [])

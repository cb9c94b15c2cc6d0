"""The page of a diagnosis: what was left out, where, how well the model that has it does, and in which engines."""

import os
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path, PurePath
from typing import TypeAlias

from harness.core.errors import short_names
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.core.wording import capitalised
from harness.results.diagnosis import (
    AttributionResult,
    DiagnosisResult,
    FailedDiagnosis,
    MechanismResult,
    PredictionResult,
)
from harness.results.fleet import FleetResult
from harness.show import blocks as b
from harness.show.numbers import NONE, SHOWN, number, quantity, shown_number, shown_unit, systematic
from harness.show.report.curves import damping_section, law_section, statements
from harness.show.report.diagnosis_figures import Curves, evidence, left, model_names, nameless, probabilities, shares
from harness.show.report.identify import samples_of
from harness.show.report.page import made_with
from harness.show.report.repeated import repeated_table
from harness.show.report.robot import fleet_sections, joint_beside
from harness.show.report.run import settings_of
from harness.show.stored import Shown

Answer: TypeAlias = DiagnosisResult | FailedDiagnosis
VERDICTS = {
    "missing_physics": "missing physics",
    "main_effect": "main effect",
    "one_of": "several candidates",
    "adequate": "adequate",
    "unexplained": "unexplained",
    "error": "could not be diagnosed",
}
_GRADES = {
    "explains": "explains it",
    "main": "main effect",
    "one-of": "candidate",
    "part": "part of it",
    "minor": "minor part",
    "tabulated": "tabulated",
}
_ENGINES = (
    "The base model and the refined model simulated by each engine, sensors applied, against the recording. The last "
    "column of each channel is what the engine's own step adds, in units of the noise."
)
_MOST_SPANS = 8
_ONE = "standard error of a single recording's value"


def diagnosis_page(
    result: DiagnosisResult, recording: Recording, simulated: Sequence[Trajectory], robot: Shown | None = None
) -> b.Page:
    """simulated : base model and refined model at the recording's times, extra "shown x" and the like what their
    sensors show, and behind them the user's own simulation where there is one. robot : where it is of a robot's joint.
    """
    seen, told = Curves(recording, simulated, result), result.attribution
    law = [law_section(result)] if result.laws else []
    sections = [
        b.verdict(result.statement, gained(result), heading="Verdict"),
        *([] if robot is None else joint_beside(result, robot)),
        *(law if recording.steady else []),
        seen.residual_section(),
        *([] if recording.steady else law),
        *([nameless(result)] if result.tables or result.surface else []),
        *([] if recording.steady else [seen.phase_plane(_places(result))]),
        _numbers(result),
        *([_own(result)] if result.own else []),
        *([_evidence(result)] if result.mechanisms or result.posterior else []),
        *_to_know(result),
    ]
    if told is not None and result.has_own_simulation and (change := to_change(told)):
        sections.append(b.verdict("", change, heading="What to change in your simulation"))
    sections += [
        b.Section("Details", _details(result, seen)),
        made_with(result.machine, result.files, result.command),
    ]
    about = result.recording
    name = "the recording on standard input" if about.file == "-" else PurePath(about.file).name
    if result.recordings:
        name = f"{len(result.recordings)} recordings of one machine"
    return b.Page(f"Diagnosis of {name}", samples_of(about), sections)


def to_change(attribution: AttributionResult) -> list[str]:
    """What a trace reads, and the changes, a sentence each; one of a parameter begins with its symbol."""
    changes = [one.said if one.kind == "parameter" else capitalised(one.said) for one in attribution.changes]
    return [*attribution.sentences, *(f"{change}." for change in changes)]


def gained(result: DiagnosisResult) -> list[str]:
    """What the better model gains, in the figures that everyone knows."""
    helped = bool(result.mechanisms)
    sentences = []
    before, after = result.baseline.chi2_per_point, result.refined.chi2_per_point
    if before is not None:
        sentences.append(f"Chi-square per point {_change(before, after, helped)} (1 when only noise is left).")
    percent = result.fit_percent
    for c, fit in (percent.baseline if percent else {}).items():
        refined = percent.refined[c] if percent and helped else None
        sentences.append(f"Fit of {c} (NRMSE) {_change(fit, refined, helped, ' %')}.")
    return sentences


def _change(before: float, after: float | None, helped: bool, unit: str = "") -> str:
    """What a figure does from one model to the other; what it is where there is no other."""
    if not helped or after is None:
        return f"is {number(before, 4)}{unit}"
    way = "rises" if after > before else "falls"
    return f"{way} from {number(before, 4)} to {number(after, 4)}{unit}"


def said(result: DiagnosisResult) -> list[str]:
    """What else it could be, where, what would decide, warnings."""
    return [*_places(result), *notes(result)]


def notes(result: DiagnosisResult) -> list[str]:
    """What would decide, what else it could be, cautions, what was done to the recording."""
    sentences = [result.next_experiment]
    for mechanism in result.mechanisms:
        others = [f"{a.name} (worse by {number(a.delta_bic, 2)} in BIC)" for a in mechanism.alternatives]
        if others:
            sentences.append(f"The data do not rule out, in place of {mechanism.name}: {', '.join(others)}.")
    return [capitalised(sentence) for sentence in [*sentences, *result.warnings, *result.recording.notes] if sentence]


def _places(result: DiagnosisResult) -> list[str]:
    """Where simulation and recording differ."""
    sentences = []
    for place in result.where:
        if place.regime == "throughout":
            sentences.append(f"Simulation and recording differ throughout: {place.condition}.")
            continue
        share = "" if place.share is None else f", which holds {100.0 * place.share:.0f} % of the mismatch"
        sentences.append(f"Simulation and recording differ where {place.condition}{share}.")
    return sentences


def _to_know(result: DiagnosisResult) -> list[b.Section]:
    """The next step and the first caution; the others folded."""
    first, *rest = notes(result) or [""]
    if not first:
        return []
    shown, more = ([first], rest) if not result.next_experiment else ([first, *rest[:1]], rest[1:])
    folded = [b.Folded(f"{len(more)} more", [b.Items(more)])] if more else []
    return [b.Section("Next step" if result.next_experiment else "To know besides", [b.Items(shown), *folded])]


def _details(result: DiagnosisResult, seen: Curves) -> list[b.Block]:
    """What is looked at on demand."""
    told, found = result.attribution, list[b.Block]()
    parts = [
        *([] if seen.recording.steady else [("Recording against simulation", seen.over_time())]),
        *([("Damping over amplitude", damping_section(result.damping).blocks)] if result.damping is not None else []),
        *([("Every name of the catalogue, tried alone", evidence(result))] if result.evidence else []),
        *([("What the best model leaves", left(result))] if result.remainder is not None else []),
        *([("Whose mismatch it is", shares(told))] if told is not None else []),
        *([("In the engines", _engines(result))] if result.engines else []),
        *([("Rules that decided", _rules(result))] if result.rules else []),
    ]
    for title, blocks in parts:
        found.append(b.Folded(title, blocks))
    return found


def index_page(
    answers: Sequence[Answer], folder: Path, command: str, fleet: FleetResult | None = None, advice: str = ""
) -> b.Page:
    """The page of many, which lies in ``folder``. fleet : what they say together, of one robot. advice : what to try
    next, "" for nothing.
    """
    counts = Counter(m.name for answer in answers for m in answer.mechanisms)
    named = ", ".join(f"{name} ({count})" for name, count in counts.most_common())
    headline = f"Missing: {named}." if named else "No physics was found to be missing."
    failed = [_failure(one) for one in answers if isinstance(one, FailedDiagnosis)]
    heads = ("verdict", "missing", "not ruled out", "chi-square per point before", "after")
    columns = [b.Column(head, b.by(i, lambda answer, i: _entry(answer)[i])) for i, head in enumerate(heads)]
    names = short_names([answer.recording.file for answer in answers])
    table = b.tabulated(
        "recording",
        columns,
        answers,
        lambda answer: names[answer.recording.file],
        link=lambda answer: _link(answer, folder),
    )
    blocks: list[b.Block] = [table]
    if command:
        blocks.append(b.Code(command, intro="This command makes it again:"))
    first = (
        fleet_sections(fleet)
        if fleet
        else [b.verdict(headline, [*failed, *filter(None, [advice])], heading="Over all recordings")]
    )
    verdicts = Counter(str(answer.verdict) for answer in answers)
    line = ", ".join(f"{verdicts[verdict]} {words}" for verdict, words in VERDICTS.items() if verdicts[verdict])
    return b.Page(f"Diagnoses of {len(answers)} recordings", line, [*first, b.Section("Recordings", blocks)])


def _failure(answer: FailedDiagnosis) -> str:
    """The error with its file, which most errors name themselves."""
    file = answer.recording.file
    return answer.error if answer.error.startswith(file) else f"{file}: {answer.error}"


def _link(answer: Answer, folder: Path) -> str:
    report = answer.files.get("report") if isinstance(answer, DiagnosisResult) else None
    return os.path.relpath(report, folder) if report else ""


def _entry(answer: Answer) -> list[str]:
    if isinstance(answer, FailedDiagnosis):
        return [VERDICTS["error"], "", "", NONE, NONE]
    others = ", ".join(a.name for m in answer.mechanisms for a in m.alternatives)
    chi2 = [number(fit.chi2_per_point, 4) for fit in (answer.baseline, answer.refined)]
    return [VERDICTS[answer.verdict], ", ".join(m.name for m in answer.mechanisms), others, *chi2]


def _own(result: DiagnosisResult) -> b.Section:
    """A row a recording, of several."""
    first, helped = result.own[0], bool(result.mechanisms)
    length = shown_unit(first.start["x0"].unit)
    columns = [
        b.Column("begins at", lambda one: one.begins_s, "s", "on the axis of time on which all lie"),
        b.Column("start", lambda one: b.measured(one.start["x0"]), length),
        *([b.Column("zero", lambda one: b.measured(one.zero), length)] if first.zero else []),
    ]
    for c in first.rmse:
        of, shown = (c, _units(result).get(c, "")), shown_unit(_units(result).get(c, ""))
        columns += [
            b.Column(f"noise of {c}", b.by(of, lambda one, of: _level(one.noise[of[0]], of[1])), shown),
            b.Column(
                f"rmse of {c}",
                b.by(of, lambda one, of: _level(one.baseline_rmse[of[0]], of[1])),
                shown,
                "viscous and Coulomb",
            ),
        ]
        refined = b.Column("refined", b.by(of, lambda one, of: _level(one.rmse[of[0]], of[1])), shown, f"rmse of {c}")
        columns += [refined] if helped else []
    alone = [
        b.Column(n, b.by(n, lambda one, n: b.measured(one.alone[n])), shown_unit(p.unit))
        for n, p in first.alone.items()
    ]
    caption, names = "Viscous and Coulomb friction fitted to each by itself.", short_names([o.file for o in result.own])
    tables = [
        b.tabulated("recording", columns, result.own, lambda one: names[one.file], lambda one: "; ".join(one.differs)),
        b.tabulated("recording", alone, result.own, lambda one: names[one.file], caption=caption),
    ]
    if result.together:
        tables.append(repeated_table(result.together, "The model above fitted to each by itself."))
    return b.Section("Recordings of one machine", tables)


def _level(value: float | str | None, unit: str) -> str:
    """A noise or an error in the unit shown, or what is said of it."""
    return str(value) if isinstance(value, str) else shown_number(value, unit, 3)


def _units(result: DiagnosisResult) -> dict[str, str]:
    """Unit of a rmse by channel."""
    angular = any("rad" in p.unit for name, p in result.baseline.parameters.items() if name != "omega_n")
    return dict(zip("xvau", ("rad", "rad/s", "rad/s²", "N m") if angular else ("m", "m/s", "m/s²", "N"), strict=True))


_SYMBOLS = {"omega_n": "ωₙ", "zeta": "ζ", "x_k": "xₖ", "f_k": "fₖ", "f_s": "fₛ", "v_s": "vₛ"}


def _numbers(result: DiagnosisResult) -> b.Section:
    """Both models and the noise in one table: what they have, what they leave, what they predict."""
    reasons, units, noise, names = b.Reasons(), _units(result), result.recording.noise, model_names(result)
    fits = (result.baseline, result.refined)[: len(names)]
    percents = [{}, {}] if result.fit_percent is None else [result.fit_percent.baseline, result.fit_percent.refined]
    held, rows = result.holdout, list[b.Row]()

    def row(head: str, unit: str, cells: Sequence[b.Shown], last: b.Shown = "") -> None:
        whole = [b.cell(one) for one in (*cells[: len(names)], last)]
        rows.append(b.Row(f"{head}, {unit}" if unit else head, whole))

    for name, p in result.baseline.parameters.items():
        whose = f" of {PurePath(result.own[0].file).name}" if name in result.of_first else ""
        cells = [b.measured(fit.parameters.get(name), reasons) for fit in fits]
        row(f"{_SYMBOLS.get(name, name)}{whose}", quantity(p)[2], cells)
    in_it = {term.name for term in result.refined_model.terms}
    for one in (m for m in result.mechanisms if m.name in in_it):
        for name, p in one.parameters.items():
            label = f"{_SYMBOLS.get(name, name)} ({one.name})"
            row(label, quantity(p)[2], [NONE, b.measured(p, reasons)])
    row("chi-square per point", "", [number(fit.chi2_per_point, 4) for fit in fits], "1")
    for c in result.baseline.rmse:
        unit, factor = SHOWN.get(units.get(c, ""), (units.get(c, ""), 1.0)) if c == "x" else (units.get(c, ""), 1.0)

        def shown(y: float | None, factor: float = factor) -> str:
            return number(None if y is None else factor * y, 3)

        level = noise.get(c)
        last = shown(level) if isinstance(level, float) else str(level or NONE)
        if result.fit_percent is not None:
            row(f"fit of {c} (NRMSE)", "%", [number(percent.get(c), 4) for percent in percents])
        row(f"rmse of {c}", unit, [shown(fit.rmse.get(c)) for fit in fits], last)
        if held.spans_s and c in held.baseline_rmse:
            values = [shown(one.get(c)) for one in (held.baseline_rmse, held.refined_rmse)]
            row(f"rmse of {c}, held out", unit, values, last)
    columns = [b.Column(name, str) for name in (*names, "noise")]
    told = [p for fit in fits for p in fit.parameters.values()] + [
        p for one in result.mechanisms if one.name in in_it for p in one.parameters.values()
    ]
    shifted = any(systematic(p) for p in told)
    caption = f"Below each value: one standard error{', and a larger systematic one' if shifted else ''}."
    return b.Section(
        "Model and numbers",
        [b.Table("", columns, rows, caption, "", reasons.footnotes), *([_held_out(result)] if held.spans_s else [])],
    )


def _held_out(result: DiagnosisResult) -> b.Text:
    """What took no part in a fit."""
    held = result.holdout
    spans = ", ".join(f"{low:.4g} to {high:.4g} s" for low, high in held.spans_s[:_MOST_SPANS])
    more = f" and {len(held.spans_s) - _MOST_SPANS} more" if len(held.spans_s) > _MOST_SPANS else ""
    graded = any(one.holdout is not None for one in result.mechanisms)
    swings = result.motion is None or result.motion.kind in ("free-decay", "several-decays")
    what = "each of these blocks of cycles" if graded else f"every second {'full period' if swings else 'window'}"
    caption = f"Held out: {what}, predicted by a fit to the rest ({spans}{more}). Terms were chosen on the whole."
    if held.given:
        caption += f" Given, not predicted: {', '.join(held.given)}."
    return b.Text(caption, "table-caption")


def _evidence(result: DiagnosisResult) -> b.Section:
    """How likely each name is, and what speaks for it."""
    blocks: list[b.Block] = [probabilities(result)] if result.posterior else []
    if result.mechanisms:
        blocks += [] if result.laws else statements(result)
        asked: list[tuple[str, Callable[[MechanismResult], b.Shown]]] = [
            ("grade", lambda one: _GRADES[one.grade]),
            ("probability", lambda one: number(one.probability, 2)),
            ("share of the misfit, %", lambda one: number(None if one.share is None else 100.0 * one.share, 3)),
            ("held-out error, after / before", lambda one: _ratios(one.holdout)),
            ("free-run error, after / before", lambda one: _ratios(one.forward)),
            ("BIC lost without it", lambda one: number(one.delta_bic, 4)),
            ("not ruled out (BIC)", _others),
        ]
        rows = [(head, [b.cell(of(one)) for one in result.mechanisms]) for head, of in asked]
        columns = [b.Column(one.name, str) for one in result.mechanisms]
        kept = [b.Row(head, cells) for head, cells in rows if any(cell.text != NONE for cell in cells)]
        caption = "Free run: the last 40 %, from a fit of the first 60 %."
        blocks.append(b.Table("", columns, kept, caption if any(one.forward for one in result.mechanisms) else ""))
    return b.Section("Evidence", blocks)


def _others(one: MechanismResult) -> b.Cell:
    found = [f"{a.name} ({number(a.delta_bic, 2)})" for a in one.alternatives]
    return b.lines(found or [NONE])


def _ratios(found: PredictionResult | None) -> b.Cell:
    """Error after over before: the largest of the channels, all of them below it."""
    if found is None:
        return b.Cell(NONE)
    notes = [f"{c} {number(ratio, 2)}" for c, ratio in found.ratios.items()] if len(found.ratios) > 1 else []
    return b.Cell(number(found.ratio, 2), notes)


def _rules(result: DiagnosisResult) -> list[b.Block]:
    """Numbers that moved the verdict."""
    columns = [
        b.Column("value", lambda rule: rule.value),
        b.Column("unit", lambda rule: rule.unit),
        b.Column("origin", lambda rule: b.Cell("", [rule.origin])),
    ]
    table = b.tabulated("rule", columns, result.rules, lambda rule: rule.name)
    return [table]


def _engines(result: DiagnosisResult) -> list[b.Block]:
    units, channels = _units(result), list(result.baseline.rmse)
    columns = []
    for c in channels:
        unit = units.get(c, "")
        columns += [b.Column(f"rmse of {c} before", str, unit), b.Column(f"rmse of {c} after", str, unit)]
        hint = "rms against the exact motion of the refined model"
        columns.append(b.Column(f"own error in {c}", str, "noise", hint))
    rows, cards = [], []
    for name, engine in result.engines.items():
        label = f"{name} {engine.version}".strip()
        if engine.error:
            rows.append(b.Row(label, [b.Cell("could not be run"), *[b.Cell(NONE)] * (len(columns) - 1)], engine.error))
            continue
        found = (engine.baseline_rmse, engine.refined_rmse, engine.own_error)
        step = engine.settings.get("dt")
        cells = [b.Cell(number(one.get(c), 4)) for c in channels for one in found]
        rows.append(b.Row(label, cells, f"step {step * 1e3:.4g} ms" if step else ""))
        line = f"step {step * 1e3:.6g} ms" if step else ""
        cards.append(b.Card(label, "var(--muted)", line, engine.ignored, settings_of(engine.settings)))
    blocks: list[b.Block] = [b.Table("engine", columns, rows, _ENGINES), b.Cards(cards)]
    if result.model_left_out:
        blocks.append(b.Items(result.model_left_out, "What the exported MJCF and URDF cannot say"))
    return blocks

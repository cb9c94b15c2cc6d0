"""What harness diagnose says at a terminal."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from harness.cli.output import say, say_as_it_is, with_error
from harness.cli.tables import show

if TYPE_CHECKING:
    from rich.table import Table

    from harness.app.diagnose.many import Many
    from harness.results.common import RepeatedResult
    from harness.results.diagnosis import (
        AttributionResult,
        DiagnosisResult,
        FitResult,
        MechanismResult,
        PredictionResult,
    )
    from harness.results.fleet import FleetResult
    from harness.results.robot import RobotResult, SimulatedResult


def say_diagnosis(result: "DiagnosisResult") -> None:
    """One diagnosis: the sentence, both fits, what was named, and what stands beside it."""
    for line in result.recording.notes:
        say(f"- {line}")
    say(result.statement)
    show(_fits(result))
    if result.own:
        show(_own(result))
        show(repeated_table(result.together))
        for one in result.own:
            for line in one.differs:
                say(f"- {Path(one.file).name}: {line}")
    graded = [m for m in result.mechanisms if m.grade != "explains"]
    if graded:
        show(_grades(graded))
        say("P: probability of being the main effect")
        say("of misfit: share of the mean square beyond noise that it takes off alone")
        say("held out: error after over before, blocks of cycles; free run: the last 40 %")
    if result.holdout.given:
        say(f"- held out: {_held_out(result)}; {', '.join(result.holdout.given)} given, not predicted")
    for mechanism in result.mechanisms:
        if mechanism.grade == "explains":
            say(f"- {mechanism.name}: BIC {mechanism.delta_bic:.0f} in favour")
        if mechanism.alternatives:
            others = ", ".join(f"{a.name} (by {a.delta_bic:.1f})" for a in mechanism.alternatives)
            say(f"- not ruled out in place of {mechanism.name}: {others}")
    if result.robot is not None:
        _print_robot(result.robot)
    if result.attribution is not None and (result.settings.get("sim") or result.settings.get("model")):
        _print_shares(result.attribution)
    for line in [*([result.next_experiment] if result.next_experiment else []), *result.warnings]:
        say(f"- {line}")
    say_as_it_is(f"report: {result.files['report']}")


def _matches(found: "RobotResult") -> "Table":
    """The log against its model, joint by joint."""
    from rich.table import Table

    table = Table(title="logged on modelled torque")
    for column in ("joint", "by", "correlation", "slope", "what looks wrong"):
        table.add_column(column)
    for one in found.match:
        numbers = ("-" if x is None else f"{x:.3g}" for x in (one.correlation, one.slope))
        table.add_row(one.joint, one.by or "-", *numbers, one.suspicion or "-")
    return table


def _print_robot(found: "RobotResult") -> None:
    """The log against its model, the joint's own equation, and what to paste."""
    if found.match:
        show(_matches(found))
    if found.reduction is not None:
        say(f"- {found.reduction.said}")
    if found.confounded:
        say(f"- this log cannot tell apart: {'; '.join(' and '.join(pair) for pair in found.confounded)}")
    if found.simulated:
        _print_simulated(found.simulated)
    if not found.paste.mjcf:
        return
    if found.paste.warning:
        say(found.paste.warning)
    say("to paste into your model (MJCF; URDF with PyBullet's calls):")
    for line in (found.paste.mjcf, *found.paste.urdf.splitlines()):
        say_as_it_is(f"  {line}")


def _print_simulated(simulated: list["SimulatedResult"]) -> None:
    """The model in engines against the log, as it is and with what is pasted."""
    from rich.table import Table

    windows = next((f", windows of {one.window_s:g} s" for one in simulated if one.window_s), "")
    say(f"your model driven by the torque of the log, rms of simulation minus log{windows}:")
    table = Table()
    for heading in ("engine", "x as it is", "x pasted", "v as it is", "v pasted"):
        table.add_column(heading, justify="left" if heading == "engine" else "right", no_wrap=True)
    for one in simulated:
        if one.error is not None:
            say(f"- {one.engine}: {one.error}")
            continue
        table.add_row(one.engine, *(f"{side[c]:.3g}" for c in ("x", "v") for side in (one.before, one.after)))
    show(table)


def _units(result: "DiagnosisResult") -> dict[str, str]:
    """Unit of a channel, as the base parameters have it."""
    turns = any("rad" in p.unit or p.unit == "kg m^2" for n, p in result.baseline.parameters.items() if n != "omega_n")
    if turns:
        return {"x": "rad", "v": "rad/s", "a": "rad/s^2", "u": "N m"}
    return {"x": "m", "v": "m/s", "a": "m/s^2", "u": "N"}


def _held_out(result: "DiagnosisResult") -> str:
    """Errors on what took no part in the fits, before and after."""
    held = result.holdout
    units = _units(result)
    both = (f"rmse {c} {y:.4g} to {held.refined_rmse[c]:.4g} {units[c]}" for c, y in held.baseline_rmse.items())
    return ", ".join(both) or "no figure"


def _print_shares(found: "AttributionResult") -> None:
    """Whose mismatch it is, what the simulation reads beside the recording, and what to change in it."""
    from rich.table import Table

    say("whose mismatch it is, % of the mean square:")
    table = Table()
    for bar in found.bars:
        table.add_column(bar.name, justify="right")
    table.add_row(*(f"{100.0 * bar.share:.1f}" for bar in found.bars))
    show(table)
    if found.reads is not None:
        table = Table()
        own = "your trace reads" if found.engine is None else "your simulation has"
        for heading in ("", own, "the recording reads"):
            table.add_column(heading, justify="right" if heading else "left", no_wrap=True)
        for name, read in found.reads.items():
            if name in found.recording:
                table.add_row(name, with_error(read), with_error(found.recording[name]))
        show(table)
    for sentence in found.sentences:
        say(f"- {sentence}")
    if found.changes:
        say("to change in your simulation:")
        for change in found.changes:
            say(f"- {change.said}")


def _fits(result: "DiagnosisResult") -> "Table":
    """Both models side by side: a column each, so that a terminal of 80 columns holds every digit."""
    from rich.table import Table

    fits = [result.baseline, *([result.refined] if result.mechanisms else [])]
    units = _units(result)
    table = Table()
    table.add_column("", no_wrap=True)
    for heading in ("viscous and Coulomb", "refined")[: len(fits)]:
        table.add_column(heading, justify="right", no_wrap=True)
    if result.mechanisms:
        # several that explain are in one model together; of several that are graded the best alone, or a table
        added = dict.fromkeys(term.name for term in result.refined_model.terms)
        table.add_row("term", "-", "\n".join(added) or "-")
    table.add_row("chi2 a point", *(_chi2(fit) for fit in fits))
    if result.fit_percent is not None:
        sides = [result.fit_percent.baseline, result.fit_percent.refined]
        for c in result.fit_percent.baseline:
            table.add_row(f"fit of {c}", *(f"{side[c]:.4g} %" for side in sides[: len(fits)]))
    for c in result.baseline.rmse:
        table.add_row(f"rmse {c}", *(f"{fit.rmse[c]:.4g} {units[c]}" for fit in fits))
    for name in dict.fromkeys(name for fit in fits for name in fit.parameters):
        table.add_row(name, *(with_error(f.parameters[name]) if name in f.parameters else "-" for f in fits))
    return table


def _own(result: "DiagnosisResult") -> "Table":
    """A line a recording: where it starts, its zero, and what both models leave of it."""
    from rich.table import Table

    table = Table()
    channel = next(iter(result.baseline.rmse))
    unit = _units(result)[channel]
    columns = ["recording", "x0", *(["zero"] if result.own[0].zero else []), f"noise {channel}\n{unit}"]
    for heading in (*columns, f"rmse {channel}\n{unit}", *([f"refined\n{unit}"] if result.mechanisms else [])):
        table.add_column(heading, justify="left" if heading == "recording" else "right", no_wrap=heading != "recording")
    for one in result.own:
        noise = one.noise[channel]
        cells = [Path(one.file).name, f"{one.start['x0'].value:.4g} {one.start['x0'].unit}"]
        cells += [f"{one.zero.value:.4g} {one.zero.unit}"] if one.zero else []
        cells += [noise if isinstance(noise, str) else f"{noise:.3g}", f"{one.baseline_rmse[channel]:.3g}"]
        table.add_row(*cells, *([f"{one.rmse[channel]:.3g}"] if result.mechanisms else []))
    return table


def repeated_table(together: Mapping[str, "RepeatedResult"]) -> "Table":
    """A line a parameter: value from all recordings, error of one, spread beyond it, who stands out."""
    from rich.table import Table

    table = Table()
    for heading in ("parameter", "of all", "error of one", "spread between", "stands out"):
        table.add_column(heading, justify="left" if heading in ("parameter", "stands out") else "right")
    for name, one in together.items():
        out = ", ".join(Path(file).name for file in one.outliers)
        table.add_row(name, with_error(one.value), f"{one.within:.2g}", f"{one.between:.2g}", out or "-")
    return table


def _grades(mechanisms: list["MechanismResult"]) -> "Table":
    """A line a mechanism: how much of what is missing it is, and how it predicts."""
    from rich.table import Table

    table = Table()
    for heading in ("mechanism", "grade", "P", "of misfit", "held out", "free run"):
        justify: Literal["left", "right"] = "left" if heading in ("mechanism", "grade") else "right"
        table.add_column(heading, justify=justify, no_wrap=True)
    for m in mechanisms:
        share = "-" if m.share is None else f"{100.0 * m.share:.0f} %"
        likely = "-" if m.probability is None else f"{m.probability:.2f}"
        table.add_row(m.name, m.grade, likely, share, _ratio(m.holdout), _ratio(m.forward))
    return table


def _ratio(found: "PredictionResult | None") -> str:
    """Error after over before, of the channel where it is largest."""
    if found is None:
        return "-"
    ratios = [found.refined_rmse[c] / before for c, before in found.baseline_rmse.items() if before > 0.0]
    return f"x {max(ratios):.2g}" if ratios else "-"


def _chi2(fit: "FitResult") -> str:
    return "-" if fit.chi2_per_point is None else f"{fit.chi2_per_point:.4g}"


def say_many(many: "Many") -> None:
    """Several: a line each."""
    from rich.table import Table

    from harness.results.diagnosis import FailedDiagnosis

    table = Table()
    for heading in ("recording", "verdict", "left out", "chi2 a point before", "after"):
        table.add_column(heading, justify="right" if "chi2" in heading or heading == "after" else "left")
    for answer in many.answers:
        name = Path(answer.recording.file).name
        if isinstance(answer, FailedDiagnosis):
            table.add_row(name, "error", answer.error, "", "")
            continue
        left_out = ", ".join(m.name for m in answer.mechanisms) or "-"
        table.add_row(name, answer.verdict, left_out, _chi2(answer.baseline), _chi2(answer.refined))
    show(table)
    say(f"{len(many.answers)} recordings, {many.failed} failed")
    if many.fleet is not None:
        _print_fleet(many.fleet)
    say_as_it_is(f"report: {many.folder / 'index.html'}")


def _print_fleet(fleet: "FleetResult") -> None:
    """Friction of joints over logs of one robot."""
    from rich.table import Table

    table = Table()
    heads = ("joint", *(Path(log.file).name for log in fleet.logs), "the same?")
    for heading in heads:
        table.add_column(heading, justify="left" if heading == "joint" else "right")
    for row in fleet.rows:
        cells = ["-" if value is None else with_error(value) for value in row.values]
        table.add_row(f"{row.joint} {row.parameter}", *cells, "differs" if row.differs else f"{row.chance:.2g}")
    show(table)
    for said in fleet.statements:
        say(f"- {said}")

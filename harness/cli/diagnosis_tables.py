"""What harness diagnose says at a terminal."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from harness.cli.output import figure, say, say_all, say_as_it_is, say_paste, show_rows, with_error
from harness.core.errors import short_names

if TYPE_CHECKING:
    from harness.app.diagnose.many import Many
    from harness.results.common import MotionResult, RepeatedResult
    from harness.results.compare import ChangeResult
    from harness.results.diagnosis import AttributionResult, DiagnosisResult, PredictionResult
    from harness.results.fleet import FleetResult
    from harness.results.robot import ArmResult, RobotResult, ServoResult, SimulatedResult


def say_diagnosis(result: "DiagnosisResult") -> None:
    """One diagnosis: the sentence, both fits, what was named, and what stands beside it."""
    say(result.statement)
    if result.robot is not None and result.robot.servo is not None:
        _servo(result.robot.servo)
        _robot(result.robot)
        _ending(result)
        return
    if result.robot is not None and result.robot.arm is not None and "f_k" not in result.baseline.parameters:
        _every_joint(result.robot.arm)
    else:
        _fits(result)
    if result.own:
        _own(result)
        show_repeated(result.together)
        say_all(f"{Path(one.file).name}: {line}" for one in result.own for line in one.differs)
    if graded := [m for m in result.mechanisms if m.grade != "explains"]:
        columns: dict[str, list[str]] = {
            "mechanism": [m.name for m in graded],
            "grade": [m.grade for m in graded],
            "P": [figure(m.probability, ".2f") for m in graded],
            "of misfit": [figure(m.share, ".0f", " %", 100.0) for m in graded],
            "held out": [_ratio(m.holdout) for m in graded],
            "free run": [_ratio(m.forward) for m in graded],
        }
        shown = {name: cells for name, cells in columns.items() if set(cells) != {"-"}}
        show_rows(tuple(shown), zip(*shown.values(), strict=True), ("mechanism", "grade"))
        say("P: probability of being the main effect")
        say("of misfit: share of the mean square beyond noise that it explains alone")
        over = {
            "held out": "held out: error after over before, blocks of cycles",
            "free run": "free run: the last 40 %",
        }
        ratios = "; ".join(said for name, said in over.items() if name in shown)
        if ratios:
            say(ratios)
    if result.holdout.given:
        say(f"- held out: {_held_out(result)}; {', '.join(result.holdout.given)} given, not predicted")
    for mechanism in result.mechanisms:
        if mechanism.grade == "explains":
            say(f"- {mechanism.name}: BIC +{mechanism.delta_bic:.4g}")
        if mechanism.alternatives:
            others = ", ".join(f"{a.name} (by {a.delta_bic:.1f})" for a in mechanism.alternatives)
            say(f"- not ruled out in place of {mechanism.name}: {others}")
    if result.robot is not None:
        _robot(result.robot)
    if result.attribution is not None and result.has_own_simulation:
        _shares(result.attribution)
    _ending(result)


def _ending(result: "DiagnosisResult") -> None:
    """How it was read, the next step, the first caution; the others are on the page."""
    say_motion(result.motion)
    say_all(result.recording.notes[:1])
    if result.next_experiment:
        say(f"- next: {result.next_experiment}")
    wanted = "" if result.motion is None else result.motion.wanted
    warnings = [said for said in result.warnings if said != wanted]
    say_all(warnings[:1])
    more = len(warnings[1:]) + len(result.recording.notes[1:])
    if more:
        say(f"- {more} more note{'s' * (more > 1)} on the page")
    say_as_it_is(f"report: {result.files['report']}")


def say_motion(found: "MotionResult | None") -> None:
    """Its kind, why, and what would tell more, in a line."""
    if found is not None:
        say(f"motion: {found.kind}, {found.reason}{'; ' if found.wanted else ''}{found.wanted}")


_TOLD = {"identifiable": "identifiable", "weak": "weakly identifiable", "not": "not identifiable"}


def _servo(found: "ServoResult") -> None:
    """What a servo's log says: free runs, terms, numbers, and what it cannot part."""
    say_all(found.understood)
    runs = [*found.fitted, *(one.model_copy(update={"of": f"held out: {one.of}"}) for one in found.held_out)]
    if found.terms or len(runs) > 1:
        heads = ["free run", "viscous and Coulomb", *(["with the terms found", "factor"] if found.terms else [])]
        rows = [
            [
                one.of,
                f"{one.before:.3g}",
                f"{one.after:.3g}",
                figure(one.after / one.before if one.before else None, ".2f"),
            ]
            for one in runs
        ]
        rows = [row[: len(heads)] for row in rows]
        show_rows(heads, rows, ("free run",), "mean absolute error of position, mrad")
    for term in found.terms:
        held = " to ".join(f"{x:.3g}" for x in term.held_out_mrad)
        out = f"; held out {held} mrad" if held else ""
        ties = ", ".join(f"{name} (by {worse:.1f})" for name, worse in term.rivals.items())
        tied = f"; not ruled out in its place: {ties}" if ties else ""
        say(f"- {term.name}: {term.said} (evidence {term.evidence:.0f}{out}{tied})")
    told = {one.parameter: one for one in found.identifiable}
    sides = [found.base, found.parameters] if found.terms else [found.parameters]
    above = ("number", *(["viscous and Coulomb", "with the terms found"] if found.terms else ["value"]), "identifiable")
    numbers: list[list[str]] = [
        [name, *(with_error(side.get(name)) for side in sides), told[name].verdict if name in told else "given"]
        for name in found.parameters
    ]
    show_rows(above, numbers, ("number", "identifiable"))
    say_all(f"{one.parameter} is {_TOLD[one.verdict]}: {one.why}." for one in found.identifiable if one.why)
    say_all(f"{line}." for line in found.confounded)
    if found.bam:
        text = ", ".join(f'"{k}": {v:.6g}' if isinstance(v, float) else f'"{k}": "{v}"' for k, v in found.bam.items())
        say("as BAM's parameters:")
        say_as_it_is(f"  {{{text}}}")
        say_all(f"{line}." for line in found.not_in_bam)


def _robot(found: "RobotResult") -> None:
    """The log against its model, the joint's own equation, and what to paste."""
    if found.match:
        heads = ("joint", "by", "correlation", "slope", "what looks wrong")
        rows = [
            (m.joint, m.by or "-", figure(m.correlation, ".3g"), figure(m.slope, ".3g"), m.suspicion or "-")
            for m in found.match
        ]
        most = len(heads) if any(m.suspicion for m in found.match) else len(heads) - 1
        show_rows(heads[:most], [row[:most] for row in rows], heads, "logged on modelled torque")
    if found.reduction is not None:
        say(f"- {found.reduction.said}")
    own = [
        one
        for one in found.identifiable
        if found.joint in ("all", one.joint) and one.verdict != "identifiable" and one.error
    ]
    say_all(f"{one.joint}, {one.parameter}: {_TOLD[one.verdict]}, {one.why}; {one.mend}" for one in own)
    if found.confounded:
        say(f"- this log cannot distinguish: {'; '.join(' and '.join(pair) for pair in found.confounded)}")
    if found.simulated:
        _simulated(found.simulated)
    if found.paste.mjcf:
        if found.paste.warning:
            say(found.paste.warning)
        say_paste(found.paste)


def _every_joint(arm: "ArmResult") -> None:
    """A line a joint: what is pasted, the law that says its curve, what is named, and torque that was not fitted."""
    rows = []
    for one in arm.joints:
        named = ", ".join(e.name for e in arm.found if e.joint == one.joint) or "-"
        f_k, c = (one.f_k, one.c) if one.curve is None else one.curve.line
        law = "-" if one.curve is None else one.curve.laws[0].name
        left = f"{figure(one.held_out_before, '.3g')} to {figure(one.held_out_after, '.3g')}"
        rows.append((one.joint, with_error(f_k), with_error(c), law, named, left))
    heads = ("joint", "dry friction", "damping", "law", "other effects", "residual torque")
    show_rows(heads, rows, ("joint", "law", "other effects"))
    of_arm = ", ".join(e.name for e in arm.found if e.joint is None)
    say_all([f"of the whole arm: {of_arm}"] if of_arm else [])


def _simulated(simulated: list["SimulatedResult"]) -> None:
    """The model in engines against the log, as it is and with what is pasted."""
    servo = all(one.windows == 1 and "v" not in one.after for one in simulated if one.error is None)
    if servo:
        say("the joint in engines against the first log, rms of position, mrad:")
        say_all(f"{one.engine}: {one.error}" for one in simulated if one.error is not None)
        named = [one for one in simulated if one.error is None]
        sides = [[figure(side.get("x"), ".3g", "", 1e3) for side in (one.before, one.after)] for one in named]
        rows = [(one.engine, *side) for one, side in zip(named, sides, strict=True)]
        show_rows(("engine", "as your file has it", "as pasted"), rows)
        return
    windows = next((f", windows of {one.window_s:g} s" for one in simulated if one.window_s), "")
    units = "rad and rad/s, of a slide m and m/s"
    say(f"your model driven by the torque of the log, rms of simulation minus log ({units}){windows}:")
    say_all(f"{_who(one)}: {one.error}" for one in simulated if one.error is not None)
    rows = [
        (_who(one), *(f"{side[c]:.3g}" for c in ("x", "v") for side in (one.before, one.after)))
        for one in simulated
        if one.error is None
    ]
    show_rows(("engine", "x as it is", "x pasted", "v as it is", "v pasted"), rows)


def _who(one: "SimulatedResult") -> str:
    return one.engine if one.joint is None else f"{one.joint}, {one.engine}"


def _units(result: "DiagnosisResult") -> dict[str, str]:
    """Unit of a channel, as the base parameters have it."""
    turns = any("rad" in p.unit or p.unit == "kg m^2" for n, p in result.baseline.parameters.items() if n != "omega_n")
    if turns:
        return {"x": "rad", "v": "rad/s", "a": "rad/s^2", "u": "N m"}
    return {"x": "m", "v": "m/s", "a": "m/s^2", "u": "N"}


def _held_out(result: "DiagnosisResult") -> str:
    """Errors on what took no part in the fits, before and after."""
    held, units = result.holdout, _units(result)
    both = (f"rmse {c} {y:.4g} to {held.refined_rmse[c]:.4g} {units[c]}" for c, y in held.baseline_rmse.items())
    return ", ".join(both) or "no figure"


def _shares(found: "AttributionResult") -> None:
    """Whose mismatch it is, what the simulation reads beside the recording, and what to change in it."""
    say("whose mismatch it is, % of the mean square:")
    show_rows([bar.name for bar in found.bars], [[f"{100.0 * bar.share:.1f}" for bar in found.bars]], ("",))
    if found.reads is not None:
        own = "your trace reads" if found.engine is None else "your simulation has"
        rows = [
            (name, with_error(read), with_error(found.recording[name]))
            for name, read in found.reads.items()
            if name in found.recording
        ]
        show_rows(("", own, "the recording reads"), rows)
    say_all(found.sentences)
    if found.changes:
        say("to change in your simulation:")
        say_all(change.said for change in found.changes)


def _fits(result: "DiagnosisResult") -> None:
    """Both models side by side: a column each, so that a terminal of 80 columns holds every digit."""
    fits = [result.baseline, *([result.refined] if result.mechanisms else [])]
    units, rows = _units(result), list[tuple[str, ...]]()
    if result.mechanisms:
        # several that explain are in one model together; of several that are graded the best alone, or a table
        added = dict.fromkeys(term.name for term in result.refined_model.terms)
        rows.append(("term", "-", "\n".join(added) or "-"))
    rows.append(("chi2 a point", *(figure(fit.chi2_per_point) for fit in fits)))
    if result.fit_percent is not None:
        sides = [result.fit_percent.baseline, result.fit_percent.refined][: len(fits)]
        rows += [(f"fit of {c}", *(f"{side[c]:.4g} %" for side in sides)) for c in sides[0]]
    rows += [(f"rmse {c}", *(f"{fit.rmse[c]:.4g} {units[c]}" for fit in fits)) for c in result.baseline.rmse]
    for name in dict.fromkeys(name for fit in fits for name in fit.parameters):
        whose = f"\nof {Path(result.own[0].file).name}" if name in result.of_first else ""
        rows.append((f"{name}{whose}", *(with_error(f.parameters.get(name)) for f in fits)))
    rows = [row for row in rows if set(row[1:]) != {"-"}]  # why a number was refused stands on the page
    if rows:
        show_rows(("", "viscous and Coulomb", "refined")[: len(fits) + 1], rows)


def _own(result: "DiagnosisResult") -> None:
    """A line a recording: where it starts, its zero, and what both models leave of it."""
    channel = next(iter(result.baseline.rmse))
    unit = _units(result)[channel]
    heads = ["recording", "x0", *(["zero"] if result.own[0].zero else []), f"noise {channel}\n{unit}"]
    rows, placed = [], "x" in result.baseline.rmse
    names = short_names([one.file for one in result.own])
    for one in result.own:
        noise = one.noise[channel]
        start = f"{one.start['x0'].value:.4g} {one.start['x0'].unit}" if placed else "-"
        cells = [names[one.file], start]
        cells += [f"{one.zero.value:.4g} {one.zero.unit}"] if one.zero else []
        cells += [noise if isinstance(noise, str) else f"{noise:.3g}", f"{one.baseline_rmse[channel]:.3g}"]
        rows.append([*cells, *([f"{one.rmse[channel]:.3g}"] if result.mechanisms else [])])
    show_rows([*heads, f"rmse {channel}\n{unit}", *([f"refined\n{unit}"] if result.mechanisms else [])], rows)


def say_change(result: "ChangeResult") -> None:
    """What changed between two conditions."""
    say(result.statement)
    rows = [
        (
            "\n".join((one.said, *([one.before.unit] if one.before else []))),
            *(with_error(side, side.unit) if side else "-" for side in (one.before, one.after)),
            "\n".join((with_error(one.ratio), *(["changed"] if one.changed else []))),
        )
        for one in result.numbers
    ]
    show_rows(("", "before", "after", "after / before"), rows)
    say_all(result.warnings)
    say_as_it_is(f"report: {result.files['report']}")


def show_repeated(together: Mapping[str, "RepeatedResult"]) -> None:
    """A line a parameter: value from all recordings, as laboratories report it, spread, who stands out; trends."""
    rows = [
        (
            "\n".join((name, *([one.value.unit] if one.value.unit != "1" else []))),
            with_error(one.value, one.value.unit),
            figure(one.expanded, ".2g"),
            "-" if one.value.systematic is None else f"{one.value.systematic:.2g}",
            f"{one.within:.2g}",
            f"{one.between:.2g}",
            ", ".join(Path(file).name for file in one.outliers) or "-",
        )
        for name, one in together.items()
    ]
    heads = ("parameter", "of all\n(type A)", "U\nk = 2", "type B", "error\nof one", "spread\nbetween", "stands out")
    show_rows(heads, rows, ("parameter", "stands out"))
    say_all(f"{name}: {trend.said}" for name, one in together.items() for trend in one.trends if trend.differs)


def _ratio(found: "PredictionResult | None") -> str:
    return figure(None if found is None else found.ratio, ".2g", before="x ")


def say_many(many: "Many") -> None:
    """Several: a line each."""
    from harness.results.diagnosis import FailedDiagnosis

    rows, names = [], short_names([answer.recording.file for answer in many.answers])
    for answer in many.answers:
        name = names[answer.recording.file]
        if isinstance(answer, FailedDiagnosis):
            rows.append((name, "error", answer.error, "", ""))
            continue
        left_out = ", ".join(m.name for m in answer.mechanisms) or "-"
        chi2 = [figure(fit.chi2_per_point) for fit in (answer.baseline, answer.refined)]
        rows.append((name, answer.verdict, left_out, chi2[0], chi2[1]))
    heads = ("recording", "verdict", "missing", "chi2 a point before", "after")
    show_rows(heads, rows, heads[:3])
    say(f"{len(many.answers)} recordings, {many.failed} failed")
    if many.fleet is not None:
        _fleet(many.fleet)
    if many.advice:
        say(many.advice)
    say_as_it_is(f"report: {many.folder / 'index.html'}")


def _fleet(fleet: "FleetResult") -> None:
    """Friction of joints over logs of one robot."""
    rows, names = [], short_names([log.file for log in fleet.logs])
    for row in fleet.rows:
        same = "differs" if row.differs else f"{row.chance:.2g}"
        between = f"{row.between / abs(row.mean.value):.1%}" if row.mean.value else "-"
        unit = row.mean.unit
        at = "" if row.speed is None else f"\nat {row.speed:.2g} {'rad' if 'N m' in unit else 'm'}/s"
        values = (with_error(one, unit).replace(" +- ", "\n+- ") for one in row.values)
        rows.append((f"{row.joint}\n{row.parameter}, {unit}{at}", *values, between, same))
    show_rows(("joint", *(names[log.file] for log in fleet.logs), "between", "the same?"), rows)
    say_all(fleet.statements)

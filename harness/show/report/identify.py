"""The pages of a recording: as it was read, and what the estimators read from it, reversal by reversal."""

from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.common import P, RecordingInfo
from harness.results.identify import IdentifyResult
from harness.results.run import Estimates
from harness.show import scene as s
from harness.show.blocks import (
    Block,
    Column,
    Facts,
    Figure,
    Folded,
    Items,
    Page,
    Reasons,
    Section,
    by,
    measured,
    tabulated,
    verdict,
)
from harness.show.numbers import quantity, sentence_quantity, shown_unit, shown_value
from harness.show.plots import (
    ANGLES,
    CHANNELS,
    GROUP,
    Trace,
    axes,
    curve,
    dots,
    left_by,
    per,
    plain,
    upright_lines,
    zoom,
)
from harness.show.report.curves import damping_section
from harness.show.report.page import made_with
from harness.show.report.run import METHODS, QUANTITIES, estimated, letter, p_of

_HUES = ("#e4632d", "#2b7fd6", "#1f9e77", "#a45bc2", "#b58900", "#667080")
_ASSUMES = {"linear": "dry friction alone", "exponential": "viscous damping alone", "both": "dry and viscous"}
_PLAIN = {"zeta": "ζ", "x_k": "x<sub>k</sub>"}
_APART = 0.006
"""Shift of each method's points, as a share of the time shown, so that bars do not hide one another."""
All = Mapping[str, Estimates]


def identify_page(result: IdentifyResult, recording: Recording, fitted: Trajectory | None = None) -> Page:
    """fitted : the base model's motion, with extra "shown x" and the like."""
    read: list[Section]
    if result.slowing:
        read = [_slowing(result), Section("The recording and the fit", channel_figures(recording, result, fitted))]
    else:
        figures = [_by_reversal(result.estimates, name) for name in ("x_k", "zeta")]
        reversals = Section("Reversal by reversal", [figure for figure in figures if figure is not None])
        methods = methods_section(result.estimates, _lead_of(result.sensor_phase_rad))
        damping = [] if result.damping is None else [damping_section(result.damping)]
        read = [methods, *damping, _channels(recording, result, fitted), reversals]
    sections = [
        verdict(identify_headline(result), _cautions(result)),
        *read,
        made_with(result.machine, result.files, result.command),
    ]
    name = PurePath(result.recording.file).name
    return Page(f"Friction and damping of {name}", samples_of(result.recording), sections)


def samples_of(about: RecordingInfo) -> str:
    """What was read, in a line."""
    if about.speeds is not None:
        return f"{about.samples} steady speeds from {about.speeds}"
    channels = ", ".join(about.channels)
    return f"{about.samples} samples of {channels} at {about.rate_hz:.6g} Hz, {about.duration_s:.4g} s"


def _cautions(result: IdentifyResult) -> list[str]:
    """Warnings and what was done to read the file; a warning that a note says in full is said once."""
    notes = result.recording.notes
    return [*(one for one in result.warnings if not any(n.lower().startswith(one.lower()) for n in notes)), *notes]


def identify_headline(result: IdentifyResult) -> str:
    """The three figures of the first method that gives them all, or why none does; of what slows down, both of its."""
    if both := result.slowing.get("both"):
        return f"f_k = {sentence_quantity(both.f_k)}, c = {sentence_quantity(both.c)}, fitted together."
    for method in [*METHODS, *result.estimates]:
        found = result.estimates.get(method)
        if found and all(p_of(found, name).value is not None for name in QUANTITIES):
            x_k, zeta, omega_n = (sentence_quantity(p_of(found, name)) for name in QUANTITIES)
            return (
                f"x_k = {x_k}, zeta = {zeta}, omega_n = {omega_n}, "
                f"read by method {method} from {found.reversals} reversals."
            )
    every = (p_of(found, name).why for found in result.estimates.values() for name in QUANTITIES)
    whys = dict.fromkeys(why for why in every if why)
    return "No method gives all three figures: " + "; ".join(whys) + "." if whys else "No estimator was run."


def _slowing(result: IdentifyResult) -> Section:
    """A row an assumption."""
    reasons = Reasons()
    units = {name: getattr(next(iter(result.slowing.values())), name).unit for name in ("f_k", "c")}
    columns = [
        *(
            Column(name, by(name, lambda one, name: measured(getattr(one[1], name), reasons)), shown_unit(units[name]))
            for name in units
        ),
        Column("chi-square", lambda one: one[1].chi2_per_point, "a point", "1 where only noise is left"),
    ]
    table = tabulated(
        "assumes", columns, list(result.slowing.items()), lambda one: one[0], lambda one: _ASSUMES[one[0]],
        reasons=reasons, caption="Below each value: one standard error.",
    )  # fmt: skip
    return Section("Estimates", [table])


def _lead_of(phase: P) -> str:
    """What is said of the phase of the accelerometer over the displacement sensor, rad."""
    if phase.value is None:
        return f" Phase lead between the sensors: not estimated ({phase.why})."
    lead = "Phase lead of the accelerometer over the displacement sensor, removed before estimating"
    return f" {lead}: {sentence_quantity(phase)}."


def methods_section(estimates: All, more: str = "") -> Section:
    """A row a method that gives a number, the others below. more : of the caption."""
    reasons = Reasons(letter)
    usable = {
        method: one for method, one in estimates.items() if any(p_of(one, n).value is not None for n in QUANTITIES)
    }
    columns = []
    for name, label in QUANTITIES.items():
        unit = next((quantity(p_of(one, name))[2] for one in estimates.values()), "")
        columns.append(Column(label, by(name, lambda one, name: estimated(one[1], name, None, reasons)), unit))
    table = tabulated(
        "method",
        columns,
        list(usable.items()),
        lambda one: one[0],
        lambda one: f"{one[1].reversals} reversals",
        reasons=reasons,
        caption=f"Below each value: one standard error.{more}",
    )
    unused = [
        f"{method}: {next((why for n in QUANTITIES if (why := p_of(one, n).why)), '')}"
        for method, one in estimates.items()
        if method not in usable
    ]
    blocks: list[Block] = [table]
    if unused:
        summary = f"Not used: {len(unused)} method{'s' if len(unused) > 1 else ''}"
        blocks.append(Folded(summary, [Items(unused, small=True)]))
    return Section("Estimates", blocks)


def _reversal_times(estimates: All) -> FloatArray:
    """Times of the reversals that any method found, s, increasing."""
    for method in [*METHODS, *estimates]:
        rows = estimates[method].per_reversal if method in estimates else []
        if found := [one["t"] for one in rows if one.get("t") is not None]:
            return np.unique(np.asarray(found, dtype=np.float64))
    return np.empty(0)


def _channels(recording: Recording, result: IdentifyResult, fitted: Trajectory | None) -> Section:
    """The recording's channels with the reversals marked, the base fit, and what that leaves."""
    bar: list[Block] = [zoom(_reversal_times(result.estimates).tolist(), recording.duration)]
    title = "The recording and the fit" if fitted is not None else "The recording"
    return Section(title, [*bar, *channel_figures(recording, result, fitted)])


def channel_figures(recording: Recording, result: IdentifyResult, fitted: Trajectory | None = None) -> list[Figure]:
    """Each channel over time; with the base model's motion also what that leaves."""
    times, figures = _reversal_times(result.estimates), list[Figure]()
    around, lines, along, across = times[:64], upright_lines(times), recording.t, "time / s"
    if recording.steady:
        along, across = recording["v"], f"speed / {per('rad/s' if recording.angular else 'm/s')}"
    for name in (c for c in recording.channels if not recording.steady or c == "u"):
        label, unit, factor = (ANGLES if recording.angular else CHANNELS)[name]
        t, y = along, recording[name] * factor
        hover = {"hovertemplate": f"%{{y:.6g}} {unit}<br>%{{x:.6f}} s<extra></extra>"}
        traces, left = [curve(name, t, y, "ink", unit, 1.4, **hover)], list[Figure]()
        if fitted is not None and f"shown {name}" in fitted.extra:
            at = recording.t >= fitted.t[0]
            model = np.interp(recording.t[at], fitted.t, fitted.extra[f"shown {name}"]) * factor
            traces.append(curve("viscous and Coulomb", t[at], model, _HUES[0], unit, 1.2, **hover))
            residual = curve("residual", t[at], y[at] - model, _HUES[0], unit, 1.2, **hover)
            caption, noise = left_by("fit", result.recording.noise.get(name), unit, factor)
            layout = axes(across, f"residual / {per(unit)}", shapes=lines + noise, showlegend=False)
            left.append(Figure(f"residual-{name}", [residual], layout, caption, GROUP, 220, around))
        layout = axes(across, f"{label} / {per(unit)}", shapes=lines, showlegend=False)
        figures += [Figure(f"channel-{name}", traces, layout, "", GROUP, 300, around), *left]
    return figures


def recording_scene(recording: Recording, result: IdentifyResult) -> s.Scene:
    """Scene of a recording, with every reversal as the first method has it that reads each by itself."""
    said = [identify_headline(result), *_cautions(result)]
    notes = s.notes_of("What was read", said)
    side: list[s.Layout] = [s.Words("notes", notes)]
    for method, estimate in result.estimates.items():
        if rows := [row for row in estimate.per_reversal if row.get("x_k") is not None]:
            unit = estimate.x_k.unit
            texts = [f"{row['t']:.4g} s, {method}: x_k = {shown_value(row['x_k'], unit, 4)}" for row in rows]
            side.append(s.Events("reversals", np.array([row["t"] for row in rows]), texts))
            break
    layout = s.Columns([s.Rows(channel_figures(recording, result)), s.Rows(side)], [3.0, 2.0])
    return s.of_result(recording.file.rpartition("/")[2], layout, result, notes, {"recording": [recording]})


def _by_reversal(estimates: All, name: str) -> Figure | None:
    """Friction or damping as each single reversal gives it, against the method's own figure."""
    traces: list[Trace] = []
    unit, drawn = "", 0
    for index, (method, estimate) in enumerate(estimates.items()):
        found = [one for one in estimate.per_reversal if one.get(name) is not None]
        if not found:
            continue
        color, p = _HUES[index % len(_HUES)], p_of(estimate, name)
        unit = quantity(p)[2]
        factor = 1e3 if unit == "mm" else 1.0
        t = np.array([float(one["t"]) for one in found])
        y = np.array([float(one[name]) for one in found]) * factor
        hover = f"%{{y:.6g}} {unit}<br>%{{customdata:.4f}} s"
        marker = {"color": color, "size": 7}
        more = {"customdata": t, **_errors(name, found, factor, color)}
        traces.append(dots(method, t + drawn * _APART * (t[-1] - t[0]), y, marker, hover, **more))
        drawn += 1
        if p.value is not None:
            level: dict[str, Any] = {
                "showlegend": False,
                "hoverinfo": "skip",
                "line": {"color": color, "width": 1.2, "dash": "dash"},
            }
            both = np.full(2, p.value * factor)
            traces.append(plain("", np.array([t[0], t[-1]]), both, color, **level))
            del traces[-1]["name"]
    if not traces:
        return None
    title = f"{_PLAIN[name]}{f' / {unit}' if unit else ''}"
    begin = "Bars are one standard error; the" if any("error_y" in trace for trace in traces) else "The"
    caption = f"{QUANTITIES[name]} from single reversals. {begin} dashed line is what the method makes of all of them."
    layout = axes("time of the reversal / s", title, showlegend=True)
    return Figure(f"reversals-{name}", traces, layout, caption, "", 360)


def _errors(name: str, found: Sequence[Mapping[str, Any]], factor: float, color: str) -> dict[str, Any]:
    if name != "x_k" or any(one.get("stderr") is None for one in found):
        return {}
    errors = np.array([float(one["stderr"]) for one in found]) * factor
    return {"error_y": {"type": "data", "array": errors, "color": color, "thickness": 1.2, "width": 3}}


def recording_page(recording: Recording) -> Page:
    """Each channel over time, which column it is, and what was mended."""
    figures = []
    for name, values in recording.channels.items():
        label, unit, factor = (ANGLES if recording.angular else CHANNELS)[name]
        layout = axes("time / s", f"{label} / {per(unit)}", showlegend=False)
        traces = [curve(name, recording.t, values * factor, "ink", unit, 1.4)]
        figures.append(Figure(f"channel-{name}", traces, layout, "", GROUP, 300))
    said = f"{len(recording)} samples at {recording.rate:.6g} Hz, {recording.duration:.4g} s"
    sections = [
        Section("What was read", [Facts(dict(recording.columns)), Items(recording.notes)]),
        Section("The recording", [zoom([], recording.duration), *figures]),
    ]
    return Page(f"{PurePath(recording.file).name} as it was read", said, sections)

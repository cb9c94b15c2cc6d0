"""The page of a recording: what the estimators read from it, reversal by reversal."""

from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.show.decimate import keep
from harness.show.numbers import quantity, sentence_quantity
from harness.show.report.motion import GROUP, POINTS, noise_band, upright_lines, zoom_buttons
from harness.show.report.run import METHODS, QUANTITIES, cell, footnotes
from harness.show.report.section import Column, Figure, Row, Section, Table
from harness.show.report.verdict import made_with_section, verdict_section

CHANNELS = {
    "x": ("position", "mm", 1e3),
    "v": ("speed", "m/s", 1.0),
    "a": ("acceleration", "m/s²", 1.0),
    "u": ("force", "N", 1.0),
}
ANGLES = {
    "x": ("angle", "rad", 1.0),
    "v": ("speed", "rad/s", 1.0),
    "a": ("acceleration", "rad/s²", 1.0),
    "u": ("torque", "N m", 1.0),
}
_HUES = ("#e4632d", "#2b7fd6", "#1f9e77", "#a45bc2", "#b58900", "#667080")
_PLAIN = {"zeta": "ζ", "x_k": "x<sub>k</sub>"}
_APART = 0.006
"""Shift of each method's points, as a share of the time shown, so that bars do not hide one another."""


def identify_sections(
    recording: Recording, result: Mapping[str, Any], command: str = "", fitted: Trajectory | None = None
) -> list[Section]:
    """Sections of a recording.

    result : IdentifyResult.model_dump(by_alias=True) (harness.identify/1). fitted : the base model's motion, with extra
    "shown x" and the like.
    """
    return [
        verdict_section(identify_headline(result), [*result["warnings"], *result["recording"]["notes"]]),
        methods_section(result["estimates"], result["sensor_phase_rad"]),
        channels_section(recording, result, fitted),
        per_reversal_section(result["estimates"]),
        made_with_section(result["machine"], result["files"], command),
    ]


def identify_title(result: Mapping[str, Any]) -> tuple[str, str]:
    """Title and subtitle of the page of a recording."""
    about = result["recording"]
    channels = ", ".join(about["channels"])
    line = f"{about['samples']} samples of {channels} at {about['rate_hz']:.6g} Hz, {about['duration_s']:.4g} s"
    return f"Friction and damping of {PurePath(about['file']).name}", line


def identify_headline(result: Mapping[str, Any]) -> str:
    """The three figures of the first method that gives them all, or why none does."""
    for method in [*METHODS, *result["estimates"]]:
        found = result["estimates"].get(method)
        if found and all(found[name]["value"] is not None for name in QUANTITIES):
            x_k, zeta, omega_n = (sentence_quantity(found[name]) for name in QUANTITIES)
            return (
                f"x_k = {x_k}, zeta = {zeta}, omega_n = {omega_n}, "
                f"read by method {method} from {found['reversals']} reversals."
            )
    whys = dict.fromkeys(
        p["why"] for found in result["estimates"].values() for p in (found[n] for n in QUANTITIES) if p.get("why")
    )
    return "No method gives all three figures: " + "; ".join(whys) + "." if whys else "No estimator was run."


def methods_section(estimates: Mapping[str, Mapping[str, Any]], sensor_phase: Mapping[str, Any]) -> Section:
    """estimates : METHOD -> as in harness.identify/1. sensor_phase : a P, rad."""
    reasons: list[str] = []
    rows = []
    usable = {method: one for method, one in estimates.items() if _usable(one)}
    unused = {
        method: next((one[n]["why"] for n in QUANTITIES if one[n].get("why")), "")
        for method, one in estimates.items()
        if method not in usable
    }
    for method, estimate in usable.items():
        cells = [cell(estimate, name, None, reasons) for name in QUANTITIES]
        rows.append(Row(method, cells, f"{estimate['reversals']} reversals"))
    units = {name: next((quantity(e[name])[2] for e in estimates.values()), "") for name in QUANTITIES}
    columns = [Column(label, units[name]) for name, label in QUANTITIES.items()]
    phase = sensor_phase
    lead = (
        "Phase lead of the accelerometer over the displacement sensor, removed before estimating: "
        f"{sentence_quantity(phase)}."
        if phase["value"] is not None
        else f"Phase lead between the sensors: not estimated ({phase.get('why')})."
    )
    return Section(
        "Estimates",
        "table.html.j2",
        {
            "tables": [
                Table("method", columns, rows, f"Below each value: one standard error. {lead}", "", footnotes(reasons))
            ],
            "folded": [f"{method}: {why}" for method, why in unused.items()],
        },
    )


def _usable(estimate: Mapping[str, Any]) -> bool:
    """Whether a method gives any number."""
    return any(estimate[name]["value"] is not None for name in QUANTITIES)


def reversal_figures(estimates: Mapping[str, Mapping[str, Any]]) -> FloatArray:
    """Times of the reversals that any method found, s, increasing."""
    for method in [*METHODS, *estimates]:
        found = [one["t"] for one in estimates.get(method, {}).get("per_reversal", []) if one.get("t") is not None]
        if found:
            return np.unique(np.asarray(found, dtype=np.float64))
    return np.empty(0)


def channels_section(recording: Recording, result: Mapping[str, Any], fitted: Trajectory | None) -> Section:
    """The recording's channels with the reversals marked, the base fit, and what that leaves."""
    times = reversal_figures(result["estimates"])
    channels = list(recording.channels)
    chosen = keep(recording.t, [recording[name] for name in channels], times[:64], POINTS // (1 + len(channels)))
    t = recording.t[chosen]
    figures = []
    for name in channels:
        label, unit, factor = (ANGLES if recording.angular else CHANNELS)[name]
        trace = {
            "type": "scatter",
            "mode": "lines",
            "name": name,
            "x": t,
            "y": recording[name][chosen] * factor,
            "line": {"color": "ink", "width": 1.4},
            "marker": {"size": 4},
            "hovertemplate": f"%{{y:.6g}} {unit}<br>%{{x:.6f}} s<extra></extra>",
            "meta": {"curve": True},
        }
        layout = {
            "xaxis": {"title": {"text": "time / s"}},
            "yaxis": {"title": {"text": f"{label} / {f'({unit})' if '/' in unit else unit}"}},
            "shapes": upright_lines(times),
            "showlegend": False,
        }
        fit, residual = _fit(recording, result, fitted, name, chosen, trace, layout)
        figures.append(Figure(f"channel-{name}", [trace, *fit], layout, "", GROUP, 300))
        figures += residual
    return Section(
        "The recording and the fit" if fitted is not None else "The recording",
        "motion.html.j2",
        {"figures": figures, "buttons": zoom_buttons(times.tolist(), recording.duration), "group": GROUP},
    )


def _fit(
    recording: Recording,
    result: Mapping[str, Any],
    fitted: Trajectory | None,
    name: str,
    chosen: IntArray,
    trace: Mapping[str, Any],
    layout: Mapping[str, Any],
) -> tuple[list[dict[str, Any]], list[Figure]]:
    """The fit of a channel as a curve, and its residual as a figure; chosen (n,) : samples that are drawn."""
    if fitted is None or f"shown {name}" not in fitted.extra:
        return [], []
    _, unit, factor = (ANGLES if recording.angular else CHANNELS)[name]
    at = chosen[recording.t[chosen] >= fitted.t[0]]
    t, y = recording.t[at], recording[name][at]
    model = np.interp(t, fitted.t, fitted.extra[f"shown {name}"])
    line = {"color": _HUES[0], "width": 1.2}
    fit = {**trace, "name": "viscous and Coulomb", "x": t, "y": model * factor, "line": line}
    left = {**fit, "name": "residual", "y": (y - model) * factor}
    title = f"residual / {f'({unit})' if '/' in unit else unit}"
    caption, shapes = "Recording minus fit.", [*layout["shapes"]]
    sigma = result["recording"]["noise"].get(name)
    if isinstance(sigma, float):
        level = 2.0 * sigma * factor
        shapes += noise_band(level)
        caption = f"Recording minus fit; dashed: two standard deviations of the noise ({level:.3g} {unit})."
    below = {**layout, "yaxis": {"title": {"text": title}}, "shapes": shapes}
    return [fit], [Figure(f"residual-{name}", [left], below, caption, GROUP, 220)]


def per_reversal_section(estimates: Mapping[str, Mapping[str, Any]]) -> Section:
    """Friction and damping as each single reversal gives them, against the method's own figure."""
    return Section(
        "Reversal by reversal",
        "figures.html.j2",
        {"figures": [figure for name in ("x_k", "zeta") if (figure := _figure(estimates, name)) is not None]},
    )


def _figure(estimates: Mapping[str, Mapping[str, Any]], name: str) -> Figure | None:
    traces: list[dict[str, Any]] = []
    shown, factor = "", 1.0
    bars = False
    drawn = 0
    for index, (method, estimate) in enumerate(estimates.items()):
        color = _HUES[index % len(_HUES)]
        found = [one for one in estimate["per_reversal"] if one.get(name) is not None]
        if not found:
            continue
        p = estimate[name]
        shown = quantity(p)[2]
        factor = 1e3 if shown == "mm" else 1.0
        t = np.array([float(one["t"]) for one in found])
        y = np.array([float(one[name]) for one in found]) * factor
        traces.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": method,
                "x": t + drawn * _APART * (t[-1] - t[0]),
                "y": y,
                "customdata": t,
                "marker": {"color": color, "size": 7},
                "hovertemplate": f"%{{y:.6g}} {shown}<br>%{{customdata:.4f}} s",
            }
            | _bars(name, found, factor, color)
        )
        drawn += 1
        bars = bars or "error_y" in traces[-1]
        if p["value"] is not None:
            ends = np.array([t[0], t[-1]])
            line = {"color": color, "width": 1.2, "dash": "dash"}
            level = np.full(2, p["value"] * factor)
            traces.append(
                {
                    "type": "scatter",
                    "mode": "lines",
                    "x": ends,
                    "y": level,
                    "line": line,
                    "showlegend": False,
                    "hoverinfo": "skip",
                }
            )
    if not traces:
        return None
    title = f"{_PLAIN[name]}{f' / {shown}' if shown else ''}"
    layout = {
        "xaxis": {"title": {"text": "time of the reversal / s"}},
        "yaxis": {"title": {"text": title}},
        "showlegend": True,
    }
    begin = "Bars are one standard error; the" if bars else "The"
    caption = f"{QUANTITIES[name]} from single reversals. {begin} dashed line is what the method makes of all of them."
    return Figure(f"reversals-{name}", traces, layout, caption, "", 360)


def _bars(name: str, found: Sequence[Mapping[str, Any]], factor: float, color: str) -> dict[str, Any]:
    if name != "x_k" or any(one.get("stderr") is None for one in found):
        return {}
    errors = np.array([float(one["stderr"]) for one in found]) * factor
    return {"error_y": {"type": "data", "array": errors, "color": color, "thickness": 1.2, "width": 3}}

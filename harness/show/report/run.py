"""The page of a run: which sections, in which order."""

from collections.abc import Mapping, Sequence
from typing import Any

from harness.core.trajectory import Trajectory
from harness.show.decimate import reversal_times
from harness.show.motion_units import TURNS, units_of, without_step
from harness.show.palette import colors
from harness.show.report.curves import turning
from harness.show.report.estimates import estimates_section
from harness.show.report.motion import motion_section, phase_section, reversal_section
from harness.show.report.scorecard import scorecard_section
from harness.show.report.section import Section
from harness.show.report.sources import made_with_section, sources_section
from harness.show.report.verdict import headline, verdict_section

_SLIDING = (("m", "m", "kg"), ("k", "k", "N/m"), ("c", "c", "N s/m"), ("f_k", "f_k", "N"))
_TURNING = (("J", "m", "kg m²"), ("k", "k", "N m/rad"), ("c", "c", "N m s/rad"), ("f_k", "f_k", "N m"))


def run_sections(trajectories: Sequence[Trajectory], result: Mapping[str, Any], command: str = "") -> list[Section]:
    """Sections of a run: the answer and its plots, then what differs and why, then tables.

    trajectories : the first is the reference, in the order of those of result["traces"] that have no error.
    result : RunResult.model_dump(mode="json", by_alias=True) (harness.run/1). command : the line that makes it again,
    "" when it is not known.
    """
    traces = [trace for trace in result["traces"] if not trace.get("error")]
    labels = [f"{trace['source']} {trace['preset']}".strip() for trace in traces]
    failed = [
        f"{trace['source']} {trace['preset']}".strip() + f" could not be run: {trace['error']}"
        for trace in result["traces"]
        if trace.get("error")
    ]
    palette = ["var(--ink)", *colors([trajectory.source for trajectory in trajectories])[1:]]
    decays = result["scenario"].get("action") is None
    units = units_of(result["scenario"])
    turns = len(turning(trajectories[0].events)) > 0 and reversal_times(trajectories[0]).size > 0
    conclusions = result["conclusions"]
    return [
        verdict_section(headline(traces, units), failed),
        *([reversal_section(trajectories, units)] if turns else []),
        motion_section(trajectories, units),
        *([verdict_section("", conclusions, labels, "Engine by engine")] if conclusions else []),
        scorecard_section(traces, result["scenario"], palette),
        *([estimates_section(traces, result["scenario"], palette)] if decays else []),
        phase_section(trajectories, decays, units),
        sources_section(traces, palette, without_step(result["scenario"])),
        made_with_section(result["machine"], result["files"], command),
    ]


def run_title(result: Mapping[str, Any]) -> tuple[str, str]:
    """Title and subtitle of the page of a run."""
    scenario = result["scenario"]
    engines = ", ".join(dict.fromkeys(f"{trace['source']} {trace['version']}" for trace in result["traces"][1:]))
    slider = scenario.get("slider")
    what = "Dry friction, engine by engine"
    if not isinstance(slider, Mapping):
        return what, f"{scenario.get('name', 'run')}: {engines}"
    name = str(scenario.get("name", "run")).replace("-", " ")
    what_acts = _ACTING.get((scenario.get("action") or {}).get("kind", ""), "").format(**(scenario.get("action") or {}))
    values = ", ".join(
        f"{symbol} = {slider[key]:g} {unit}"
        for symbol, key, unit in (_TURNING if units_of(scenario) is TURNS else _SLIDING)
        if isinstance(slider.get(key), (int, float))
    )
    thing = "pendulum" if units_of(scenario) is TURNS else "slider"
    of = "" if thing in name else f" of a {thing}"
    about = f"{name}: a {thing} {what_acts}" if what_acts else f"{name}{of}"
    return what, f"{about}, {values}: {engines or 'reference only'}"


_ACTING = {
    "Hold": "under a load of {force:.4g} N",
    "Belt": "on a belt at {speed:.4g} m/s",
    "Harmonic": "driven with {amplitude:.4g} N at {omega:.4g} rad/s",
}
"""What acts on the slider, by the kind of action."""

"""Two traces of any origin against each other, before any model is fitted: harness compare."""

import math
import shlex
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from harness.app.shared.columns import in_unit, mapping, refuse_misread
from harness.app.shared.estimates import estimate
from harness.app.shared.leaving import FILES, leave, leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import read, read_sim, recording_info, thinned
from harness.app.signatures import signatures
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.diagnosis.alignment.align import GIVEN
from harness.diagnosis.alignment.match import Match, of_one_kind
from harness.diagnosis.alignment.pair import Clock
from harness.diagnosis.comparison import Comparison, compared
from harness.diagnosis.fit.rmse import percent_followed
from harness.diagnosis.motion import motion_of
from harness.estimate.every import METHODS
from harness.estimate.noise import Noise
from harness.estimate.result import Estimate
from harness.estimate.saturation import limit_said, limits
from harness.io.options import ReadOptions
from harness.results.common import Where
from harness.results.compare import Aligned, ChannelPair, CompareResult, Difference, Event, Largest, Reading
from harness.show.blocks import Page
from harness.show.report.compare import Shown, compare_headline, compare_page, compare_scene, rows_of
from harness.show.sentences import compare_sentences
from harness.show.stored import StoredTrace

FIGURES = ("omega_n", "zeta", "x_k", "amplitude", "rest")
UNITS = {"x": "m", "v": "m/s", "a": "m/s^2"}
ANGULAR = {"x": "rad", "v": "rad/s", "a": "rad/s^2"}
_OPTIONS = ("--sim-columns", "--columns")
"""How columns are named of the first trace and of the second."""
_UNITS = {1e3: "mm", 1e6: "um"}
_TURNED = {math.degrees(1.0): "deg"}
"""Factors of units beside m and rad."""
_AS_FAR = 0.2
"""How near the logarithm of what one trace goes over the other must lie: else one may hold where the other slips."""
_TINY = 1e-300
_STILL = 0.1
"""Share of a half-cycle that must follow the stop, for a rest to be seen."""
_MOST_OVERLAP = 0.98
"""An overlap below this share of the recording is worth a sentence."""


def compare(
    sim: Path,
    real: Path,
    options: tuple[ReadOptions, ReadOptions],
    traces: tuple[str | None, str | None] = (None, None),
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
    shift: float | None = None,
) -> CompareResult:
    """Read two traces, compare, and leave result.json, trace.rrd, report.html and the log in a folder.

    options, traces : for sim and real, how to read them and which trace of a .rrd to take. out : new or empty folder,
    None for reports/NAME-TIME here. command : the line that makes it again. shift : of sim, s; None to find it.

    Raises InputError when a trace cannot be read or the two have nothing in common, StoreError.
    """
    progress("reading", 0, 3)
    simulated, recorded = read_sim(sim, options[0], traces[0], ("columns",)), read(real, options[1], traces[1])
    return deliver(simulated, recorded, out, real.name.split(".")[0], progress, command, shift)


def deliver(
    simulated: Recording,
    recorded: Recording,
    out: Path | None = None,
    name: str = "recording",
    progress: Progress = SILENT,
    command: str = "",
    shift: float | None = None,
) -> CompareResult:
    """Compare, and leave everything in a folder, as ``compare`` does. name : of the default folder."""
    with leaving(f"compare-{name}", out) as output:
        progress("comparing", 1, 3)
        simulated, recorded = of_one_kind(thinned(simulated), thinned(recorded))
        outputs = {name: output.at(file) for name, file in FILES.items()}
        result, shown = result_of(simulated, recorded, command, outputs, shift)
        progress("writing trace and report", 2, 3)
        leave(output, result, compare_page(result, shown), compare_scene(simulated, recorded, shown, result))
    return result


def result_of(
    sim: Recording,
    real: Recording,
    command: str = "",
    outputs: dict[str, str] | None = None,
    shift: float | None = None,
) -> tuple[CompareResult, Shown]:
    """Compare two traces; shift : of the first, s, None to find it. Returns the result and what its page shows.

    Raises InputError when nothing is in common.
    """
    sim, real = of_one_kind(sim, real)
    _refuse_other_unit(sim, real)
    comparison = compared(sim, real, shift)
    for trace, checks, option in zip((sim, real), comparison.checks, _OPTIONS, strict=True):
        # one whose channels do not belong together may be compared as it is
        refuse_misread(trace, [one for one in checks if one.related or one.mirrored], option)
    found, names = comparison.match, names_of(sim.file, real.file)
    readings = (
        reading(sim, found.found[0], found.clock),
        reading(real, found.found[1], Clock(0.0)),
    )
    aligned = found.aligned
    alternatives = [{"shift_s": one.shift, "worse_by": one.worse_by} for one in aligned.alternatives]
    result = CompareResult.taken_from(
        comparison,
        files=[sim.file, real.file],
        aligned=Aligned.taken_from(
            aligned, shift_s=aligned.shift, scale_applied=not aligned.faster, alternatives=alternatives
        ),
        traces=dict(zip(names, readings, strict=True)),
        differences=[] if found.identical else differences(*readings),
        largest=_largest(found, real.angular),
        fit_percent={c: percent_followed(found.sim[c], y) for c, y in found.real.items()},
        noise={c: noise.said for c, noise in found.noise.items()},
        rmse={c: float(np.sqrt(np.mean(np.square(d)))) for c, d in found.difference.items()},
        where=[Where.taken_from(place, time_s=place.spans) for place in comparison.places],
        consistent_channels={
            name: {"-".join(c.pair): ChannelPair.taken_from(c, lag_s=c.lag) for c in pairs}
            for name, pairs in zip(names, comparison.checks, strict=True)
        },
        p_value=comparison.doubted.p_value,
        recordings=[recording_info(sim, found.found[0]), recording_info(real, found.found[1])],
        command=command,
        machine=this_machine(),
        outputs=outputs or {},
    )
    engines = signatures(names, readings, (sim, real), comparison)
    said = [*(one.sentence for one in engines), *compare_sentences(result, _limits(comparison, sim, real))]
    result = result.model_copy(update={"sentences": said, "signatures": engines})
    # position and speed of each are smoothed where they were not measured
    first, second = (motion_of(found.t, channels, found.omega) for channels in (found.sim, found.real))
    both = {c: (found.sim[c], found.real[c]) for c in found.real}
    shown = Shown(found.t, both, ((first.x, first.v), (second.x, second.v)), names, real.angular)
    motions = {
        name: {"t": found.t, "x": x, "v": v} | {c: pair[i] for c, pair in both.items()}
        for i, (name, (x, v)) in enumerate(zip(names, shown.motion, strict=True))
    }
    return result.drawn(partial(compare_page, shown=shown), motions), shown


def _refuse_other_unit(sim: Recording, real: Recording) -> None:
    """Raise InputError where a channel goes as much farther in one trace as a unit makes it.

    No shift and no difference of theirs means anything then.
    """
    for c in (c for c in UNITS if c in sim and c in real):
        times = float(np.ptp(real[c])) / max(float(np.ptp(sim[c])), _TINY)
        for factor, unit in (_UNITS | (_TURNED if real.angular else {})).items():
            if abs(abs(math.log(max(times, _TINY))) - math.log(factor)) < _AS_FAR:
                large = int(times > 1.0)
                trace, option = (sim, real)[large], _OPTIONS[large]
                columns = dict(trace.columns) or {"t": "t", c: c}
                columns = in_unit(columns, c, unit + UNITS[c].removeprefix("m"))
                found = f"goes {max(times, 1.0 / times):.4g} times as far as that of {(real, sim)[large].file}"
                accepted = f"the same unit in both. Try: {option} {shlex.quote(mapping(columns))}"
                raise InputError(f"{trace.file}: channel {c}", found, accepted)


def summary(result: CompareResult) -> tuple[str, list[tuple[str, list[str]]]]:
    """The verdict in a sentence, and the figures side by side: a label, the first's, the second's, their distance."""
    return compare_headline(result), rows_of(result)


def again(stored: StoredTrace, data: Any) -> tuple[CompareResult, Page]:
    """A comparison made again from the two traces that a .rrd of it holds; data : its result, of this version or 1."""
    aligned = data["aligned"]["shift_s"]
    shift = aligned["value"] if aligned.get("why") == GIVEN else None
    sim, real = stored.recordings
    result, shown = result_of(sim, real, data["command"], data["outputs"], shift)
    kept = {"machine": data["machine"], "outputs": data["outputs"]}
    result = CompareResult.model_validate(result.model_dump(by_alias=True) | kept)
    return result, compare_page(result, shown)


def names_of(first: str, second: str) -> tuple[str, str]:
    """What the two traces are called: the stems of their files, where these differ."""
    stems = tuple(Path(file).name.split(".")[0] for file in (first, second))
    return (stems[0], stems[1]) if stems[0] != stems[1] and all(stems) else ("sim", "real")


def _largest(found: Match, angular: bool) -> Largest:
    """Of the first channel of x, v, a in common; single samples next to a jump of the others would mislead."""
    c = next(c for c in UNITS if c in found.real)
    apart = found.difference[c]
    i = int(np.argmax(np.abs(apart)))
    return Largest(channel=c, value=float(apart[i]), unit=(ANGULAR if angular else UNITS)[c], time_s=float(found.t[i]))


def _limits(comparison: Comparison, sim: Recording, real: Recording) -> list[str]:
    """What limits the comparison, in sentences."""
    found = comparison.match
    said = [comparison.doubted.sentence] if comparison.verdict == "same within noise" else []
    for name, trace, noise in zip(names_of(sim.file, real.file), (sim, real), found.found, strict=True):
        # beside another channel their pair says so
        if "a" in trace and len(noise) == 1 and (ends := limits(trace.t, trace["a"], noise["a"])):
            said.append(f"{name}: {limit_said(ends, trace.angular)}")
    silent = [c for c, noise in found.noise.items() if not noise.found]
    if silent and not found.identical:
        said.append(f"no noise was found in {', '.join(silent)}: 1e-5 of the channel's rms is taken for it")
    if found.interpolated:
        said.append("the two are sampled at different times: single samples next to a jump are set aside")
    overlap = float(found.t[-1] - found.t[0]) / real.duration
    if overlap < _MOST_OVERLAP:
        said.append(f"the two overlap for {100.0 * overlap:.3g} % of {Path(real.file).name}")
    return said


def reading(trace: Recording, noise: Mapping[str, Noise], clock: Clock) -> Reading:
    """Figures and events of one trace. noise : by channel. clock : its clock in that of the second trace.

    A trace that is driven, or shows no free decay, has figures refused with the reason. Figures are those of the first
    method that gives all three, else of the one that gives most.
    """

    def known(one: Estimate) -> int:
        return sum(figure.value is not None for figure in (one.omega_n, one.zeta, one.x_k))

    method, edges = None, np.empty(0)
    try:
        every = estimate(trace)
    except InputError as error:
        unit = (ANGULAR if trace.angular else UNITS)["x"]
        found = Estimate.refused(error.found.removeprefix("no estimate is possible: "), unit)
    else:
        name = max(METHODS, key=lambda one: known(every[one]))
        found, edges = every[name], every.edges
        method = name if known(found) else None
    return Reading.taken_from(
        found,
        method=method,
        omega_n=_scaled(found.omega_n, 1.0 / clock.scale),
        amplitude=_amplitude(trace, noise),
        rest=_rest(trace, noise, edges),
        events=_events(trace, edges, clock),
    )


def _scaled(one: Quantity, by: float) -> Quantity:
    """A frequency by the second trace's clock."""
    if one.value is None or by == 1.0:
        return one
    return Quantity(one.value * by, None if one.stderr is None else one.stderr * by, one.unit, one.why)


def _amplitude(trace: Recording, noise: Mapping[str, Noise]) -> Quantity:
    """Half of the range of the first channel of x, v, a."""
    c = next(c for c in UNITS if c in trace)
    unit = (ANGULAR if trace.angular else UNITS)[c]
    # the extremes are of single samples, whose noise is as likely to add as to take
    return Quantity(0.5 * float(np.ptp(trace[c])), noise[c].sigma / math.sqrt(2.0), unit)


def _rest(trace: Recording, noise: Mapping[str, Noise], edges: np.ndarray) -> Quantity:
    """Where the displacement stands after the stop."""
    unit = (ANGULAR if trace.angular else UNITS)["x"]
    if "x" not in trace:
        return Quantity.refused(unit, "the displacement was not given")
    if edges.size < 2:
        return Quantity.refused(unit, "no stop was found")
    half = float(np.median(np.diff(edges)))
    still = trace["x"][trace.t > edges[-1] + _STILL * half]
    if still.size < 8 or trace.t[-1] - edges[-1] < 0.5 * half:
        return Quantity.refused(unit, "the trace ends before it rests")
    own = noise["x"]
    error = own.sigma * math.sqrt(own.inflation(0.0, trace.interval) / still.size)
    # a quantised sensor at rest says one thing over and over
    return Quantity(float(np.mean(still)), max(error, own.step / math.sqrt(12.0)), unit)


def _events(trace: Recording, edges: np.ndarray, clock: Clock) -> list[Event]:
    if edges.size < 2:
        return []
    values = np.interp(edges, trace.t, trace["x"]) if "x" in trace else [None] * edges.size
    slack = 2.0 * trace.interval
    kinds = ["reversal"] * edges.size
    kinds[0] = "release" if edges[0] > trace.t[0] + slack else "start"
    kinds[-1] = "stop" if edges[-1] < trace.t[-1] - slack else "end"
    shown = clock.onto(edges)
    return [
        Event.model_validate({"time_s": float(t), "kind": kind, "value": None if x is None else float(x)})
        for t, kind, x in zip(shown, kinds, values, strict=True)
    ]


def differences(first: Reading, second: Reading) -> list[Difference]:
    """Every figure that both have, the most significant first."""
    found = []
    for what in FIGURES:
        one, other = getattr(first, what), getattr(second, what)
        if one.value is None or other.value is None:
            continue
        error = None if one.stderr is None or other.stderr is None else math.hypot(one.stderr, other.stderr)
        apart = abs(one.value - other.value)
        significance = None if not error else apart / error
        found.append(Difference(what=what, first=one, second=other, significance=significance))
    return sorted(found, key=lambda one: -(one.significance or 0.0))

"""Two traces of any origin against each other, before any model is fitted."""

from pathlib import Path
from typing import Any

import numpy as np

from harness.app.compare.reading import ANGULAR, UNITS, differences, reading
from harness.app.shared.deliver import to_json
from harness.app.shared.machine import this_machine
from harness.app.shared.parts import where_of_place
from harness.app.shared.progress import NAME as LOG
from harness.app.shared.progress import SILENT, Progress, journal
from harness.app.shared.reading import read, read_sim, recording_info, thinned
from harness.core.recording import Recording
from harness.diagnosis.alignment.align import GIVEN
from harness.diagnosis.alignment.consistency import Consistency
from harness.diagnosis.alignment.match import Match, of_one_kind
from harness.diagnosis.alignment.pair import Clock
from harness.diagnosis.comparison import Comparison, compared
from harness.diagnosis.fit.rmse import percent_followed
from harness.diagnosis.motion import motion_of
from harness.estimate.saturation import limit_said, limits
from harness.io.options import ReadOptions
from harness.io.store import output_folder
from harness.results.common import P
from harness.results.compare import Aligned, ChannelPair, CompareResult, Largest, OtherShift
from harness.show.report.compare import Shown, compare_headline, compare_page, compare_scene, rows_of
from harness.show.report.page import write_report
from harness.show.sentences.compare import compare_sentences
from harness.show.stored import StoredTrace
from harness.show.trace import write_trace


def _shown(result: CompareResult, found: Match, angular: bool) -> Shown:
    """What both show at shared times, with position and speed of each, smoothed where they were not measured."""
    names = (*result.traces,)
    motions = [motion_of(found.t, channels, found.omega) for channels in (found.sim, found.real)]
    return Shown(
        found.t,
        {c: (found.sim[c], found.real[c]) for c in found.real},
        ((motions[0].x, motions[0].v), (motions[1].x, motions[1].v)),
        (names[0], names[1]),
        angular,
    )


def write_compare_page(path: Path, result: CompareResult, found: Match, angular: bool) -> None:
    """Write the page; raises StoreError."""
    write_report(path, compare_page(result, _shown(result, found, angular)))


def write_compare_trace(path: Path, result: CompareResult, sim: Recording, real: Recording, found: Match) -> None:
    """Write trace.rrd, with both traces as they were read; raises StoreError."""
    shown = _shown(result, found, real.angular)
    write_trace(path, compare_scene(sim, real, shown, result))


def summary(result: CompareResult) -> tuple[str, list[tuple[str, list[str]]]]:
    """The verdict in a sentence, and the figures side by side: a label, the first's, the second's, their distance."""
    return compare_headline(result), rows_of(result)


FILES = {"result": "result.json", "report": "report.html", "rrd": "trace.rrd", "log": LOG}


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
    with output_folder(f"compare-{name}", out) as output, journal(output / LOG):
        progress("comparing", 1, 3)
        outputs = {name: output.at(file) for name, file in FILES.items()}
        simulated, recorded = of_one_kind(thinned(simulated), thinned(recorded))
        result, found = result_of(simulated, recorded, command, outputs, shift)
        progress("writing trace and report", 2, 3)
        (output / FILES["result"]).write_text(to_json(result), encoding="utf-8")
        write_compare_trace(output / FILES["rrd"], result, simulated, recorded, found)
        write_compare_page(output / FILES["report"], result, found, recorded.angular)
        output.commit()
    return result


def result_of(
    sim: Recording,
    real: Recording,
    command: str = "",
    outputs: dict[str, str] | None = None,
    shift: float | None = None,
) -> tuple[CompareResult, Match]:
    """Compare two traces; shift : of the first, s, None to find it. Raises InputError when nothing is in common."""
    sim, real = of_one_kind(sim, real)
    comparison = compared(sim, real, shift)
    found, names = comparison.match, names_of(sim.file, real.file)
    readings = (
        reading(sim, found.found[0], found.clock),
        reading(real, found.found[1], Clock(0.0)),
    )
    aligned = found.aligned
    result = CompareResult(
        files=[sim.file, real.file],
        aligned=Aligned(
            shift_s=P.of(aligned.shift),
            scale=P.of(aligned.scale),
            scale_applied=not aligned.faster,
            alternatives=[OtherShift(shift_s=one.shift, worse_by=one.worse_by) for one in aligned.alternatives],
        ),
        traces=dict(zip(names, readings, strict=True)),
        differences=[] if found.identical else differences(*readings),
        largest=_largest(found, real.angular),
        fit_percent={c: percent_followed(found.sim[c], y) for c, y in found.real.items()},
        noise={c: noise.said for c, noise in found.noise.items()},
        rmse={c: float(np.sqrt(np.mean(np.square(d)))) for c, d in found.difference.items()},
        where=[where_of_place(place) for place in comparison.places],
        consistent_channels={
            name: {"-".join(c.pair): channel_pair(c) for c in pairs}
            for name, pairs in zip(names, comparison.checks, strict=True)
        },
        verdict=comparison.verdict,
        p_value=comparison.doubted.p_value,
        sentences=[],
        recordings=[recording_info(sim, found.found[0]), recording_info(real, found.found[1])],
        command=command,
        machine=this_machine(),
        outputs=outputs or {},
    )
    said = compare_sentences(result, _limits(comparison, sim, real))
    return result.model_copy(update={"sentences": said}), found


def again(stored: StoredTrace, data: Any, page: Path) -> CompareResult:
    """A comparison made again from the two traces that a .rrd of it holds; data : its result, of this version or 1."""
    aligned = data["aligned"]["shift_s"]
    shift = aligned["value"] if aligned.get("why") == GIVEN else None
    sim, real = stored.recordings
    result, found = result_of(sim, real, data["command"], data["outputs"], shift)
    result = CompareResult.model_validate(
        result.model_dump(by_alias=True) | {"machine": data["machine"], "outputs": data["outputs"]}
    )
    write_compare_page(page, result, found, real.angular)
    return result


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


_MOST_OVERLAP = 0.98
"""An overlap below this share of the recording is worth a sentence."""


def channel_pair(found: Consistency) -> ChannelPair:
    """What one channel says of another, in the form of the results."""
    return ChannelPair(
        gain=P.of(found.gain),
        lag_s=P.of(found.lag),
        offset=P.of(found.offset),
        consistent=found.consistent,
        sentence=found.sentence,
    )

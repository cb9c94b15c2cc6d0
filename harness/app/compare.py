"""Two traces of any origin against each other, before any model is fitted."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import numpy as np

from harness.app.deliver import to_json
from harness.app.journal import NAME as LOG
from harness.app.journal import journal
from harness.app.machine import this_machine
from harness.app.progress import SILENT, Progress
from harness.app.reading import read, recording_info
from harness.core.recording import Recording
from harness.diagnosis.cleaned import isolated
from harness.diagnosis.consistency import Consistency, consistency
from harness.diagnosis.lackfit import LackOfFit, lack_of_fit
from harness.diagnosis.locate import Place, locate
from harness.diagnosis.match import Match, match, swing_of
from harness.diagnosis.motion import motion_of
from harness.io.recording import ReadOptions
from harness.io.store import output_folder
from harness.results.common import P, Where
from harness.results.compare import ChannelPair, CompareResult
from harness.show.compare_scene import compare_scene
from harness.show.report.compare import compare_sections, compare_title
from harness.show.report.page import write_report
from harness.show.trace import write_trace

FILES = {"result": "result.json", "report": "report.html", "rrd": "trace.rrd", "log": LOG}
_UNLIKELY = 0.01
_LOUD = 1.5
"""Mean square difference over that of the noise from which the two differ whatever its structure."""
_ONE_CHANNEL = 0.95


def compare(
    sim: Path,
    real: Path,
    options: tuple[ReadOptions, ReadOptions],
    traces: tuple[str | None, str | None] = (None, None),
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
) -> CompareResult:
    """Read two traces, compare, and leave result.json, trace.rrd, report.html and the log in a folder.

    options, traces : for sim and real, how to read them and which trace of a .rrd to take. out : new or empty folder,
    None for reports/NAME-TIME here. command : the line that makes it again.

    Raises InputError when a trace cannot be read or the two have nothing in common, StoreError.
    """
    progress("reading", 0, 3)
    simulated, recorded = read(sim, options[0], traces[0]), read(real, options[1], traces[1])
    with output_folder(f"compare-{real.name.split('.')[0]}", out) as output, journal(output / LOG):
        progress("comparing", 1, 3)
        outputs = {name: output.at(file) for name, file in FILES.items()}
        result, found = result_of(simulated, recorded, command, outputs)
        progress("writing trace and report", 2, 3)
        (output / FILES["result"]).write_text(to_json(result), encoding="utf-8")
        data = result.model_dump(mode="json", by_alias=True)
        write_trace(output / FILES["rrd"], compare_scene(simulated, recorded, found.shift_used, data))
        shown = {c: (found.sim[c], found.real[c]) for c in found.real}
        noise = {c: n.sigma for c, n in found.noise.items()}
        write_report(
            output / FILES["report"],
            *compare_title(data),
            compare_sections(found.t, shown, noise, recorded.angular, data),
        )
        output.commit()
    return result


def result_of(
    sim: Recording, real: Recording, command: str = "", outputs: dict[str, str] | None = None
) -> tuple[CompareResult, Match]:
    """Compare two traces; raises InputError when they have nothing in common."""
    found = match(sim, real)
    rest = motion_of(found.t, found.real, found.omega)
    doubted = lack_of_fit(
        found.whitened, found.t, found.omega, jacobian={c: d[:, None] for c, d in found.partial.items()}, motion=rest
    )
    judged = dict(found.whitened)
    if found.interpolated:
        judged = {c: np.where(isolated(r), 0.0, r) for c, r in judged.items()}
    loud = {c: float(np.mean(np.square(r))) for c, r in judged.items()}
    different = doubted.p_value < _UNLIKELY or max(loud.values()) > _LOUD
    verdict: Literal["same within noise", "different"] = "different" if different else "same within noise"
    unit = "rad" if real.angular else "m"
    places = locate(judged, found.t, rest, unit=unit) if different else ()
    where = [*_channel_alone(found, loud), *(_where(place) for place in places)]
    if different and not where:
        whole = [[float(found.t[0]), float(found.t[-1])]]
        where = [Where(time_s=whole, regime="throughout", condition="at all times", share=1.0)]
    # a trace in which nothing swings has no channels to hold against each other
    checks = {
        "sim": consistency(sim.t, sim.channels, found.found[0], swing_of(sim), sim.angular),
        "real": consistency(real.t, real.channels, found.found[1], found.omega, real.angular),
    }
    result = CompareResult(
        files=[sim.file, real.file],
        aligned={"shift_s": P.of(found.shift)},
        noise={c: noise.said for c, noise in found.noise.items()},
        rmse={c: float(np.sqrt(np.mean(np.square(d)))) for c, d in found.difference.items()},
        where=where,
        consistent_channels={
            name: {"-".join(c.pair): channel_pair(c) for c in pairs} for name, pairs in checks.items()
        },
        verdict=verdict,
        p_value=doubted.p_value,
        sentences=_sentences(found, doubted, loud, checks, (sim, real)),
        recordings=[recording_info(sim, found.found[0]), recording_info(real, found.found[1])],
        command=command,
        machine=this_machine(),
        outputs=outputs or {},
    )
    return result, found


def _where(place: Place) -> Where:
    return Where.model_validate(
        {
            "time_s": [list(span) for span in place.spans],
            "regime": place.regime,
            "condition": place.condition,
            "share": place.share,
        }
    )


def _channel_alone(found: Match, loud: Mapping[str, float]) -> list[Where]:
    """The one channel that holds nearly all of the mismatch, where the others agree within the noise."""
    excess = {c: max(power - 1.0, 0.0) for c, power in loud.items()}
    total = sum(excess.values())
    for channel, own in excess.items():
        others = [power for c, power in loud.items() if c != channel]
        if others and loud[channel] > _LOUD and own > _ONE_CHANNEL * total and max(others) < _LOUD:
            spans = [[float(found.t[0]), float(found.t[-1])]]
            return [Where(time_s=spans, regime="channel", condition=f"channel {channel}", share=own / total)]
    return []


def channel_pair(found: Consistency) -> ChannelPair:
    """What one channel says of another, in the form of the results."""
    return ChannelPair(
        gain=P.of(found.gain),
        lag_s=P.of(found.lag),
        offset=P.of(found.offset),
        consistent=found.consistent,
        sentence=found.sentence,
    )


def _sentences(
    found: Match,
    doubted: LackOfFit,
    loud: Mapping[str, float],
    checks: Mapping[str, tuple[Consistency, ...]],
    traces: tuple[Recording, Recording],
) -> list[str]:
    said = [f"{c}: the mean square difference is {power:.4g} times that of the noise" for c, power in loud.items()]
    said.append(doubted.sentence)
    for name, pairs in checks.items():
        said += [f"{name}: {pair.sentence}" for pair in pairs if not pair.consistent]
    silent = [c for c, noise in found.noise.items() if not noise.found]
    if silent:
        said.append(f"no noise was found in {', '.join(silent)}: 1e-5 of the channel's rms is taken for it")
    if found.interpolated:
        said.append(
            "the two are sampled at different times: single samples next to a jump of acceleration are set aside"
        )
    covered = float(found.t[-1] - found.t[0]) / traces[1].duration
    if covered < 0.98:
        said.append(f"the two overlap for {100.0 * covered:.3g} % of {Path(traces[1].file).name}")
    return said

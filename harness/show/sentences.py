"""What results say in sentences with numbers: two traces, the sources of a run, a sweep."""

from collections.abc import Mapping, Sequence
from typing import Any

from harness.core.scenario import Scenario
from harness.fidelity.scores import Card
from harness.results.common import P
from harness.results.compare import CompareResult, Difference
from harness.results.run import TraceResult
from harness.show.numbers import AT_REST, engine_name, heading, mm, number, sentence_quantity, shown_value

SHOWS = 3.0
"""Standard errors from which two figures differ."""
_CLOSE = 1.5
"""A shift whose mean square is at most this many times that of the best one is a rival."""
_WORDS = {
    "zeta": ("decays faster", "decays slower", "zeta"),
    "omega_n": ("swings faster", "swings slower", "omega_n"),
    "x_k": ("has more dry friction", "has less dry friction", "x_k"),
    "rest": ("rests further up", "rests further down", "at"),
    "amplitude": ("swings wider", "swings less wide", "amplitude"),
}
"""In the order in which they are said."""
_SHARP = 1e-4
"""Relative errors below this one add nothing for the eye."""
_SAME = {
    "omega_n": "frequency",
    "zeta": "damping",
    "x_k": "dry friction",
    "amplitude": "amplitude",
    "rest": "place of rest",
}


_ASSUMING = frozenset({"zeta", "x_k"})
_ASSUMED = (
    "zeta and x_k are those of viscous and dry friction alone: another law in one trace, or in both at different"
    " amplitudes, shows as a difference in them too"
)


def compare_sentences(result: CompareResult, limits: Sequence[str]) -> list[str]:
    """What differs, how far, how the clocks were set, and what limits the comparison."""
    name, other = result.traces
    said = []
    if result.verdict != "identical":
        differing = telling(result.differences)
        said += [f"{name} {difference_words(one)}" for one in differing]
        if any(one.what in _ASSUMING for one in differing):
            said.append(_ASSUMED)
        faster = not result.aligned.scale_applied
        alike = [
            _SAME[one.what] for one in result.differences if not shows(one) and not (faster and one.what == "omega_n")
        ]
        if alike:
            said.append(f"same within their errors: {', '.join(alike)}")
        most, value = result.largest, shown_value(abs(result.largest.value), result.largest.unit)
        said.append(f"largest difference: {value} in {most.channel} at {most.time_s:.4g} s")
        fits = ", ".join(f"{value:.1f} % of {c}" for c, value in result.fit_percent.items())
        said.append(f"{name} fits {other} by {fits} (NRMSE)")
    said += _clock(result, name)
    for trace, pairs in result.consistent_channels.items():
        said += [f"{trace}: {pair.sentence}" for pair in pairs.values() if not pair.consistent]
    return [*said, *limits]


def telling(differences: Sequence[Difference]) -> list[Difference]:
    """Those that are significant and show in their digits, what the motion is like first."""
    order = list(_WORDS)
    return sorted(filter(shows, differences), key=lambda one: order.index(one.what))


def shows(one: Difference) -> bool:
    """Whether two figures differ by more than their errors, and in the digits that are printed."""
    return (one.significance or 0.0) >= SHOWS and figure_words(one.first) != figure_words(one.second)


def figure_words(p: P) -> str:
    """A figure with its error, where that is to be seen: "0.0414 +- 0.0011"."""
    if p.value is None or p.stderr is None or p.stderr > _SHARP * abs(p.value):
        return sentence_quantity(p)
    return shown_value(p.value, p.unit, 5)


def difference_words(one: Difference) -> str:
    """ "decays faster: zeta 0.0730 +- 0.0010 against 0.0500 +- 0.0010 (16 standard errors)"."""
    first, second = one.first.value or 0.0, one.second.value or 0.0
    more, less, symbol = _WORDS[one.what]
    figures = [figure_words(p) for p in (one.first, one.second)]
    far = "" if one.significance is None else f" ({number(one.significance, 2)} standard errors)"
    return f"{more if first > second else less}: {symbol} {figures[0]} against {figures[1]}{far}"


def faster_words(result: CompareResult) -> str:
    """Both readings of a rate: "sim runs 1.68 +- 0.04 % faster: its stiffness is 3.4 % too high, or its clock slow"."""
    name, _ = result.traces
    scale, error = result.aligned.scale.value or 1.0, result.aligned.scale.stderr or 0.0
    more = scale > 1.0
    return (
        f"{name} runs {100.0 * abs(scale - 1.0):.3g} +- {100.0 * error:.1g} % {'faster' if more else 'slower'}: its"
        f" stiffness over mass is {100.0 * abs(scale**2 - 1.0):.3g} % too {'high' if more else 'low'}, or its clock is"
        f" {'slow' if more else 'fast'}"
    )


def _clock(result: CompareResult, name: str) -> list[str]:
    aligned = result.aligned
    said = []
    rate = aligned.scale
    if not aligned.scale_applied:
        # of two motions at different rates no shift tells anything
        return [f"{faster_words(result)}; nothing here decides which, so the two count as different"]
    if rate.value is not None and rate.stderr and abs(rate.value - 1.0) >= 4.0 * rate.stderr:
        error = f"{100.0 * abs(rate.value - 1.0):.3g} +- {100.0 * rate.stderr:.1g} %"
        which = "longer" if rate.value > 1.0 else "shorter"
        said.append(f"the clock of {name} runs at another rate: its second is {which} by {error}")
    close = [one for one in aligned.alternatives if one.worse_by < _CLOSE]
    if close:
        shifts = ", ".join(f"{one.shift_s:.4g}" for one in close)
        said.append(f"other shifts fit nearly as well: {shifts} s")
    return said


SMEARED = 0.9
"""An estimate at the reversal below this share of the guarded one means that the jump is spread out."""
CLOSE = 0.02
"""Estimates within this share of the truth are right for most purposes."""


def _x_k(trace: TraceResult, method: str) -> float | None:
    estimate = trace.estimates.get(method)
    return None if estimate is None else estimate.x_k.value


def _friction(trace: TraceResult, scenario: Scenario) -> str | None:
    """Whether friction jumps at the reversal or is spread around it."""
    true, step, lead = scenario.slider.x_k, trace.dt_s, trace.metrics.reversal_lead_s
    guarded, local = _x_k(trace, "acceleration"), _x_k(trace, "acceleration-local")
    if true == 0.0 or guarded is None or local is None or step is None:
        return None
    numbers = f"Estimated x_k: {mm(local)} at the reversal, {mm(guarded)} away from it (true: {mm(true)})"
    if abs(local) >= SMEARED * abs(guarded):
        return f"friction jumps at the reversal, as dry friction does. {numbers}."
    if lead is None or abs(lead) <= step:
        return f"friction reverses within one step of {step * 1e3:.3g} ms. {numbers}."
    return (
        f"friction is regularised: it ramps through zero {lead * 1e3:.2g} ms before the velocity reversal. {numbers}."
    )


def _rest(trace: TraceResult, scenario: Scenario) -> str | None:
    """Whether it comes to rest."""
    creep, error = trace.metrics.creep_m_s, trace.metrics.rest_error_m
    if creep is None or error is None:
        return None
    if abs(creep) > AT_REST:
        return f"it never sticks: it creeps at {mm(abs(creep))}/s towards the relaxed spring."
    return f"it comes to rest {mm(abs(error))} from the exact place."


def _damping(trace: TraceResult, scenario: Scenario) -> str | None:
    """Damping that the engine or its integrator adds."""
    estimate, true = trace.estimates.get("acceleration"), scenario.slider.zeta
    if estimate is None or estimate.zeta.value is None:
        return None
    found, x_k = estimate.zeta.value, estimate.x_k.value
    if abs(found - true) <= max(CLOSE * true, 1e-5):
        return None
    own = trace.settings.get("linearDamping")
    if isinstance(own, float) and own > 0.0 and found > true:
        why = f"its own linear damping of {own:g} (with a quadratic part) acts beside the damper"
    else:
        why = f"its integrator {'adds' if found > true else 'takes away'} damping"
    wrong = x_k is not None and abs(x_k - scenario.slider.x_k) > CLOSE * scenario.slider.x_k
    also = f"; it biases x_k too: {mm(x_k)} (true: {mm(scenario.slider.x_k)})" if wrong and x_k else ""
    return f"estimated zeta: {found:.4f} (true: {true:.4f}), because {why}{also}."


EXACT = 1e-5
"""A figure within this share of the exact one is called exact."""
MUCH = 0.1
"""Deviations above this share are said in whole percent."""
LIFTED = 1e-6
"""A box higher than this above where it rests, in m, has left the floor."""


def conclusions(traces: Sequence[TraceResult], scenario: Scenario) -> list[str]:
    """Sentences on every engine's trace, in their order; the exact reference, which comes first, needs none."""
    said = []
    for trace in traces[1:]:
        name = f"{trace.source} {trace.preset}"
        if trace.error is not None:
            said.append(f"{name} could not be run: {trace.error}")
            continue
        if scenario.action is None:
            found = [text for say in (_friction, _damping, _rest) if (text := say(trace, scenario)) is not None]
        else:
            found = [*_creep(trace), *_against(trace, traces[0])]
        if (trace.metrics.lift_m or 0.0) > LIFTED:
            found.append(f"it leaves what bears it, by at most {mm(trace.metrics.lift_m or 0.0)}.")
        if scenario.action is not None:
            found += filter(None, [position_error(trace)])
        said += [f"{name}: {text}" for text in found]
    return said


def _creep(trace: TraceResult) -> list[str]:
    """Whether it holds what it should hold."""
    creep, drift = trace.metrics.creep_m_s, (trace.metrics.model_extra or {}).get("drift_m")
    if creep is None:
        return []
    if abs(creep) > AT_REST:
        return [f"it does not hold but creeps at {mm(abs(creep))}/s, for as long as the load acts."]
    return ["it holds" + (f", and gives way by {mm(abs(drift))}." if drift is not None else ".")]


def _against(trace: TraceResult, reference: TraceResult) -> list[str]:
    """The figures that a scenario has of its own, each beside that of the exact motion."""
    exact = reference.metrics.model_extra or {}
    said = []
    for metric, value in (trace.metrics.model_extra or {}).items():
        true = exact.get(metric)
        if value is None or not true:
            continue
        about, off = heading(metric), value / true - 1.0
        shown = f"{about.head} {about.factor * value:.5g} {about.unit}".rstrip()
        if abs(off) < EXACT:
            said.append(f"{shown}, as in the exact motion")
        else:
            percent = f"{100.0 * off:+.0f}" if abs(off) >= MUCH else f"{100.0 * off:+.2g}"
            said.append(f"{shown}, exactly {about.factor * true:.5g} ({percent} %)")
    return ["; ".join(said) + "."] if said else []


def position_error(trace: TraceResult, angular: bool = False) -> str | None:
    """How far it is from the exact motion, an angle where it turns."""
    error = trace.metrics.max_error_m
    if error is None or trace.dt_s is None:
        return None
    return f"its position is at most {mm(error, angular)} from the exact one, at a step of {trace.dt_s * 1e3:.3g} ms."


ROUTES = {"joint": "joint friction", "contact": "contact friction", "law": "the clipped force law"}
WORDS = {"dt": "the step (s)", "leapfrog": "leapfrog (start half a step back, read speeds as means of two)"}
NOTICEABLE = 0.01
"""A distance from exact above this is worth a sentence."""
MOST = 3
"""Figures that a sentence names."""


def sentences(cards: Sequence[Card]) -> list[str]:
    """For every engine and route: what is wrong as shipped, what to change, what that mends, what stays wrong."""
    said = []
    pairs: dict[str, dict[str, Card]] = {}
    for card in cards:
        pairs.setdefault(about(card), {})[card.preset] = card
    for where, pair in pairs.items():
        shipped, tuned = pair.get("as-shipped"), pair.get("tuned")
        if shipped is not None:
            said.append(f"{where}: as shipped {_wrong(shipped, 'nothing is off by more than 1 %')}.")
        if shipped is not None and tuned is not None:
            change = _change(shipped, tuned)
            said.append(f"{where}: change {change}. Then {_mended(shipped, tuned)}.")
            said.append(f"{where}: what stays wrong after that: {_wrong(tuned, 'nothing above 1 %')}.")
    return said


def about(card: Card) -> str:
    """What a card is about, as its sentences begin."""
    place = f" ({card.environment})" if card.environment else ""
    return f"{engine_name(card.engine)} {card.version}{place}, {ROUTES.get(card.route, card.route)}"


def _known(card: Card) -> dict[str, float]:
    return {label: value for label, value in card.values.items() if value is not None}


def _wrong(card: Card, nothing: str) -> str:
    bad = sorted(((v, k) for k, v in _known(card).items() if v > NOTICEABLE), reverse=True)
    parts = [f"{label} off by {percent(value)}" for value, label in bad[:MOST]]
    more = f" and {len(bad) - MOST} more figures above 1 %" if len(bad) > MOST else ""
    return ", ".join(parts) + more if parts else nothing


def _mended(shipped: Card, tuned: Card) -> str:
    before, after = _known(shipped), _known(tuned)
    both = sorted(((before[k] - after[k], k) for k in before if k in after and before[k] > NOTICEABLE), reverse=True)
    parts = [f"{label} goes from {percent(before[label])} to {percent(after[label])}" for _, label in both[:MOST]]
    return ", ".join(parts) if parts else "nothing noticeable changes"


def _change(shipped: Card, tuned: Card) -> str:
    """The settings that tell the two apart and that the engine honours on this route."""
    first, second = _settings(shipped), _settings(tuned)
    ignored = " ".join(next(iter(tuned.rows.values()))["ignored"]) if tuned.rows else ""
    parts = [
        f"{WORDS.get(name, name)} to {_text(second[name])}"
        for name in second
        if first.get(name) != second[name] and f"{name}:" not in ignored and name not in ("route", "restoring")
    ]
    return ", ".join(parts) if parts else "nothing"


def _settings(card: Card) -> Mapping[str, Any]:
    rows = list(card.rows.values())
    settings: Mapping[str, Any] = rows[0]["settings"] if rows else {}
    return settings


def percent(value: float) -> str:
    """A share for people."""
    if value < 1e-5:
        return "less than 0.001 %"
    return f"{100.0 * value:.0f} %" if value >= 0.1 else f"{100.0 * value:.2g} %"


def _text(value: object) -> str:
    if isinstance(value, list):
        return "(" + " ".join(_text(inner) for inner in value) + ")"
    return f"{value:.6g}" if isinstance(value, float) else str(value)

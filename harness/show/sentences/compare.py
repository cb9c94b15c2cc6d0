"""What the comparison of two traces says, in sentences with numbers."""

from collections.abc import Sequence

from harness.results.common import P
from harness.results.compare import CompareResult, Difference
from harness.show.numbers import number, sentence_quantity, shown_value

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


def compare_sentences(result: CompareResult, limits: Sequence[str]) -> list[str]:
    """What differs, how far, how the clocks were set, and what limits the comparison."""
    name, other = result.traces
    said = []
    if result.verdict != "identical":
        said += [f"{name} {difference_words(one)}" for one in telling(result.differences)]
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

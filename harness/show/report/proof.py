"""The page of a sealed proof: what came out, figure by figure, name by name, and how it was sealed."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from markupsafe import Markup

from harness.results.prove import (
    BaselineMargin,
    ForcedFigure,
    MustFail,
    ProofCase,
    ProofFigure,
    ProofResult,
    RateResult,
)
from harness.show import blocks as b
from harness.show.numbers import number
from harness.show.report import proof_figures
from harness.show.report.page import made_with
from harness.show.report.proof_figures import BAD, GOOD, confusion, detection, intervals

MOST_ROWS = 200
"""Rows of a table on the page; the rest is in result.json."""
GROUPS = {
    "single": "One effect hidden",
    "control": "Nothing hidden",
    "pair": "Two effects hidden",
    "outside": "An effect that no catalogue holds",
    "main": "A machine with one large omission",
    "machine-control": "A machine with small omissions alone",
    "unknown": "A machine with a large omission that no catalogue holds",
    "path": "An effect in another form",
    "path-control": "Nothing hidden, on any way",
    "path-unknown": "An effect of a random family",
    "real-constructed": "A real machine with a constructed effect",
    "real-switched": "A real machine of which one cause was switched",
    "real-repeated": "A real machine twice in one condition",
}
TOLD = (
    "A seed was taken from the operating system, and its salted hash written down, before anything else.",
    "Every recording was drawn from the seed, by a source that shares no law and no code with the diagnosis. "
    "Names, recordings and answers follow from the seed alone.",
    "The hash of every recording and a salted hash of every answer were written down.",
    "Each recording was diagnosed by a process that got it on standard input, in an empty folder, without "
    "arguments or environment that tell; seed and answers were in no file meanwhile.",
    "The hash of every verdict was written down.",
    "Seed and answers were opened, and everything was scored.",
)
FROM_FILES = (
    "Every recording was made from files of real machines, of which the hashes were written down with the seed. Names, "
    "effects, and which condition comes first follow from the seed alone."
)
LIMITS = (
    "What this cannot show: that nobody ran many proofs and published the best, and that the machine itself was "
    "honest. Both are answered by running one: harness prove."
)
_AGAIN = "This recomputes every hash, every score and every recording, and names whatever was changed:"


def proof_page(result: ProofResult, order: Sequence[str], transcript: Sequence[Mapping[str, Any]]) -> b.Page:
    """order : names of the catalogue in their order. transcript : ("step", "at", "hash") of each entry."""
    sizes = result.sizes
    sentences = [f"Falls short: {line}." for line in result.shortfalls]
    if sizes.paths:
        sentences.append(
            f"The {len(result.cases)} recordings are of {len(result.paths.ways) if result.paths else 0} ways that give "
            "a verdict, half of them with nothing hidden, half without any option."
        )
    elif sizes.real:
        files = sum(one.files for one in result.real.machines) if result.real else 0
        sentences.append(
            f"{sizes.real} effects were constructed on {files} recordings of real machines, each diagnosed as it was "
            "measured as well: what is scored is the difference."
        )
        sentences += [f"Not at hand, not run: {', '.join(result.absent)}."] if result.absent else []
    elif sizes.machines:
        sentences.append(f"{sizes.machines} recordings are of machines, half of them with small omissions alone.")
    else:
        sentences.append(
            f"{sizes.singles} recordings hide one effect, {sizes.controls} none, {sizes.pairs} two, "
            f"{sizes.outside} one that no catalogue holds."
        )
    sentences += [f"Given up: {line}" for line in result.given_up]
    first = [] if result.paths is None else [proof_figures.curve(result.paths), _missed(result.cases)]
    sections = [
        b.verdict(_headline(result), sentences),
        *first,
        _figures(result.figures, result.forced, result.by_source),
        *([] if result.paths is None else [proof_figures.ways(result.paths)]),
        *([] if result.real is None else [proof_figures.machines(result.real)]),
    ]
    if result.confusion:
        sections.append(confusion(result.confusion, order))
        sections.append(_by_name(result.by_name, result.not_tested))
    if result.detection is not None:
        sections.append(detection(result.detection))
    others = [_baselines(result.baselines)] if result.baselines else []
    others += [_must_fail(result.must_fail)] if result.must_fail else []
    if others:
        sections.append(b.Section("Beside others", others))
    entries = b.tabulated(
        "transcript",
        [
            b.Column("at, UTC", lambda entry: entry["at"]),
            b.Column("hash of the entry", lambda entry: b.Cell(Markup("<code>{}</code>").format(entry["hash"]))),
        ],
        transcript,
        lambda entry: entry["step"],
    )
    sealed: list[b.Block] = [
        b.Items(TOLD if result.real is None else (TOLD[0], FROM_FILES, *TOLD[2:]), ordered=True),
        b.Code("harness prove --verify DIR", intro=_AGAIN),
        entries,
    ]
    sections += [
        *([] if first else [_missed(result.cases)]),
        b.Section("How it was sealed", [*sealed, b.Text(LIMITS)]),
        made_with(result.machine, result.files, result.command),
    ]
    kind = "" if result.evidence else "no evidence: "
    return b.Page(
        "The sealed proof", f"{kind}{len(result.cases)} recordings, sealed answers, seed {result.seed}", sections
    )


def _headline(result: ProofResult) -> str:
    figures = {figure.key: figure for figure in result.figures if figure.cases}
    parts = []
    for key, what in (("listed", "named or listed"), ("wrong", "called another")):
        if one := figures.get(f"machines_{key}"):
            parts.append(f"{one.hits} of {one.cases} main effects of machines were {what}")
    for key, what in (("told", "effects worth above 20 were named or listed"), ("alarms", "controls were claimed")):
        if one := figures.get(f"paths_{key}"):
            parts.append(f"{one.hits} of {one.cases} {what}")
    for key, what in (("switched", "switched causes were told"), ("told", "constructed laws were named or listed")):
        if one := figures.get(f"real_{key}"):
            parts.append(f"{one.hits} of {one.cases} {what}")
    if named := figures.get("named"):
        low = 100.0 * (named.low or 0.0)
        parts.append(f"{named.hits} of {named.cases} hidden effects were named (at least {low:.1f} % of such)")
    if alarms := figures.get("false_alarms"):
        parts.append(f"{alarms.hits} of {alarms.cases} recordings with nothing hidden raised a false alarm")
    said = "; ".join(parts) + "." if parts else "There is no figure to speak of."
    if not result.evidence:
        return f"No evidence: {len(result.cases)} recordings are too few for the figures to say anything. {said}"
    reached = "Every figure that is asked for is reached." if not result.shortfalls else ""
    return f"{said} {reached}".strip()


def _figures(
    figures: Sequence[ProofFigure], forced: ForcedFigure, by_source: Mapping[str, Sequence[ProofFigure]]
) -> b.Section:
    """forced : controls with a term forced in."""
    columns = [
        b.Column("found", lambda one: b.Cell(_amount(one.value, one.share), grade=_grade(one.met))),
        b.Column(
            "95 % interval",
            _interval,
            "",
            "exact (Clopper-Pearson) for a share, resampled for a median and over real machines",
        ),
        b.Column("cases", lambda one: str(one.cases)),
        b.Column("asked", lambda one: one.asked),
    ]
    caption = "Green: reached. Red: falls short. No colour: nothing is asked."
    table = b.tabulated("figure", columns, figures, lambda one: one.label, caption=caption)
    if by_source:  # recordings of machines alone have no such controls
        met = None if forced.worst is None else forced.worst <= 1.05
        cells = [b.Cell(number(forced.worst, 4), grade=_grade(met)), b.Cell(""), b.Cell(str(forced.cases))]
        last = b.Row("held-out rmse of controls, a term forced in, largest", [*cells, b.Cell("at most 1.05")])
        table = b.Table(table.corner, columns, [*table.rows, last], caption)
    shares = [
        (one.label, one, {True: GOOD, False: BAD, None: "#7a8594"}[one.met], f"{one.hits} of {one.cases}")
        for one in figures
        if one.share
    ]
    blocks: list[b.Block] = [table, intervals("figures", shares, "Shares with their exact 95 % intervals.")]
    if len(by_source) > 1:
        heads = [figure.label for figure in next(iter(by_source.values()))]
        rows = [
            b.Row(name, [b.Cell(_amount(one.value, one.share), (f"of {one.cases}",)) for one in found])
            for name, found in by_source.items()
        ]
        blocks.append(b.Table("recordings made by", [b.Column(head, str) for head in heads], rows, title="By source"))
    return b.Section("Figures", blocks)


def _grade(met: bool | None) -> int | None:
    return {True: 0, False: 4, None: None}[met]


def _amount(value: float | None, share: bool) -> str:
    return number(value, 3) if value is None or not share else f"{100.0 * value:.1f} %"


def _interval(figure: ProofFigure) -> str:
    if figure.low is None and figure.high is None:
        return number(None)
    low, high = _amount(figure.low, figure.share), _amount(figure.high, figure.share)
    return f"{low.removesuffix(' %')} to {high}"


def _by_name(rates: Mapping[str, RateResult], not_tested: Sequence[str]) -> b.Section:
    """rates : share named by name. not_tested : names that did not occur."""
    rows = []
    for name, rate in rates.items():
        color = GOOD if rate.hits == rate.cases else BAD if (rate.value or 0.0) < 0.5 else "#d99a2b"
        rows.append((name, rate, color, f"{rate.hits} of {rate.cases}"))
    caption = "Single effects that were named, with exact 95 % intervals. Green: every one of them."
    blocks: list[b.Block] = [intervals("by-name", rows, caption)] if rows else []
    missing = Markup("<strong>Not tested</strong>, since these names did not occur alone: {}.")
    said = missing.format(", ".join(not_tested)) if not_tested else "Every name of the catalogue occurred alone."
    return b.Section("Name by name", [*blocks, b.Text(said)])


def _missed(cases: Sequence[ProofCase]) -> b.Section:
    """Every recording that was not answered right, group by group."""
    columns = [
        b.Column("said", lambda case: case.said),
        b.Column("not ruled out", lambda case: ", ".join(case.near) or number(None)),
        b.Column("recorded", _recorded),
        b.Column("samples", lambda case: str(case.points)),
        b.Column(
            "loss of the base fit",
            lambda case: number(case.loss, 3),
            "",
            "chi-square that viscous and Coulomb friction lose to the truth",
        ),
        b.Column("R² of it", lambda case: number(None) if case.r2 is None else f"{case.r2:.4f}"),
    ]
    tables = []
    for group, title in GROUPS.items():
        here = [case for case in cases if case.group == group]
        wrong = [case for case in here if not case.right]
        if not here:
            continue
        more = f" The first {MOST_ROWS} are shown." if len(wrong) > MOST_ROWS else ""
        caption = f"{len(here) - len(wrong)} of {len(here)} answered right.{more}"
        shown = wrong[:MOST_ROWS]
        tables.append(
            b.tabulated("hidden", columns, shown, _hidden, lambda case: case.name, caption=caption, title=title)
        )
    return b.Section("What was not answered right", tables)


def _recorded(case: ProofCase) -> str:
    return ", ".join([case.setting, case.channels, *([] if case.source == "plant" else [case.source])])


def _hidden(case: ProofCase) -> str:
    return " + ".join(case.hidden) or "nothing"


def _baselines(margins: Sequence[BaselineMargin]) -> b.Table:
    """Ours beside what a practitioner would do."""

    def margin(one: BaselineMargin) -> b.Cell:
        if one.value is None:
            return b.Cell(number(None))
        between = f"{_amount(one.low, one.share)} to {_amount(one.high, one.share)}"
        return b.Cell(_amount(one.value, one.share), (between,), 0 if one.beaten else 4)

    columns = [
        b.Column("compared by", lambda one: one.what or one.why),
        b.Column("ours", lambda one: _amount(one.ours, one.share)),
        b.Column("theirs", lambda one: _amount(one.theirs, one.share)),
        b.Column("margin", margin, "", "by how much ours is better, with its 95 % interval, resampled in pairs"),
        b.Column("cases", lambda one: str(one.cases), "", "recordings on which the other has something to work on"),
    ]
    caption = "On the very same recordings. Green: the interval of the margin lies above none."
    return b.tabulated(
        "baseline", columns, margins, lambda one: one.name, lambda one: one.about, caption=caption, title="Baselines"
    )


def _must_fail(rows: Sequence[MustFail]) -> b.Table:
    """What diagnosers that look at nothing would have scored."""

    def rated(of: Callable[[MustFail], RateResult], grade: int | None = None) -> Callable[[MustFail], b.Cell]:
        def cell(one: MustFail) -> b.Cell:
            rate = of(one)
            if rate.value is None or rate.low is None or rate.high is None:
                return b.Cell(number(None))
            note = f"{100.0 * rate.low:.1f} to {100.0 * rate.high:.1f} %"
            return b.Cell(f"{100.0 * rate.value:.1f} %", (note,), grade)

        return cell

    columns = [
        b.Column("single effects named", rated(lambda one: one.named, 4)),
        b.Column("false alarms", rated(lambda one: one.false_alarms)),
        b.Column("wrong or nothing outside the catalogue", rated(lambda one: one.misled)),
    ]
    caption = "Scores worth having condemn these, on the very same recordings."
    return b.tabulated(
        "a diagnoser that",
        columns,
        rows,
        lambda one: one.name,
        lambda one: one.about,
        caption=caption,
        title="Diagnosers that must fail",
    )

"""Search of an engine's settings for fidelity at a cost."""

import math

from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.core.checks import positive
from harness.core.errors import InputError, SimulationError
from harness.engines import registry
from harness.engines.base import ROUTES, TUNED_DT, Route, choice
from harness.fidelity.paste import paste
from harness.fidelity.row import Row
from harness.fidelity.scores import COLUMNS, distance
from harness.fidelity.spaces import space, tunable
from harness.fidelity.tune import HELD_OUT, SEARCH, Subject, Trial, score_of, search
from harness.results.tune import TunedFigure, TuneResult

EXPECTED = 150
"""Sets of settings a search usually scores: only progress depends on it."""


def tune(
    name: str,
    route: Route = "joint",
    dt: float | None = None,
    most: float | None = None,
    progress: Progress = SILENT,
    subject: Subject | None = None,
) -> TuneResult:
    """Search on some random sliders, score on others.

    subject : what to search on in their place. dt : s, None for 1 ms. most : allowed cost, as wall time over that of
    what ships at the same step; None for any. Raises InputError for an engine, route or number that is not accepted.
    """
    registry.check(name)
    choice("--route", route, ROUTES)
    dt = TUNED_DT if dt is None else positive("--dt", dt, "s")
    if most is not None:
        positive("--max-cost", most)
    found = space(name.partition("@")[0], route)
    if found is None:
        raise InputError(
            f"engine {name}", f"no table of settings for the {route} route", f"{'; '.join(tunable())} are accepted"
        )
    try:
        engine = registry.load(name)
    except SimulationError as error:
        raise InputError(f"engine {name}", str(error), "an installed engine is accepted") from None
    trial = Trial(engine, route, dt, subject or Subject())
    shipped = trial.rows({}, HELD_OUT)
    if math.isinf(score_of(shipped)):
        why = next(row.error for row in shipped if row.error is not None)
        raise InputError(f"--dt {dt:g}", f"what ships cannot run at this step ({why})", "a smaller step is accepted")
    chosen = search(trial, found, most, tell=lambda done: progress("settings scored", done, max(done, EXPECTED)))
    changed = trial.changed(found, chosen)
    tuned = trial.rows(changed, HELD_OUT)
    settings = engine.presets(route, "as-shipped", dt) | dict(trial.subject.own) | changed
    return TuneResult(
        engine=name,
        version=engine.version(),
        route=route,
        dt_s=dt,
        max_cost=most,
        changed=changed,
        settings=settings,
        paste=paste(engine.name, route, settings, changed),
        score_before=score_of(shipped),
        score_after=score_of(tuned),
        score_preset=trial.score({}, HELD_OUT, "tuned"),
        cost=trial.cost(changed),
        figures=_figures(shipped, tuned),
        searched=trial.count,
        sliders={"searched_on": list(SEARCH), "scored_on": list(HELD_OUT)},
        machine=this_machine({"search": 0}),
    )


def _figures(before: list[Row], after: list[Row]) -> list[TunedFigure]:
    found = []
    for scenario, figure in COLUMNS:
        means = []
        for rows in (before, after):
            values = [distance(row.as_dict(), figure) for row in rows if row.scenario == scenario]
            known = [value for value in values if value is not None]
            means.append(sum(known) / len(known) if known else None)
        if means != [None, None]:
            found.append(TunedFigure(name=figure.label, before=means[0], after=means[1]))
    return found

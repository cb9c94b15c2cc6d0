"""Models of the user's choice fitted to one recording and held against each other."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import errors_of, prepared
from harness.app.shared.reading import recording_info, thinned
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.rmse import rmse
from harness.diagnosis.fit.standard_errors import base_parameters
from harness.diagnosis.pipeline import fit_base
from harness.diagnosis.problem import Problem
from harness.diagnosis.search.against import against
from harness.diagnosis.search.extend import extend
from harness.diagnosis.search.search import noise_of, under
from harness.diagnosis.stages import Based
from harness.model.registry import NAMED, term
from harness.results.common import P
from harness.results.compare import ComparedModel, ModelsResult
from harness.show.report.compare import models_page

DECISIVE = 10.0
_NOT_SEEN = "{} brings nothing to the fit"


def compare_models(recording: Recording, models: Mapping[str, Sequence[str]], options: DiagnoseOptions) -> ModelsResult:
    """Fit each and rank them by BIC, under the noise that the best of them leaves.

    models : names of the catalogue by the name of the model; none for viscous and Coulomb friction alone. Raises
    InputError for a name that there is not and for what cannot be fitted, SimulationError.
    """
    if not models:
        raise InputError("models", "none", 'names of terms by name, such as {"base": [], "drag": ["quadratic-drag"]}')
    recording = thinned(recording)
    with np.errstate(over="ignore", invalid="ignore"), errors_of(recording):
        ready = prepared(recording, options)
        based = fit_base(ready.problem)
        found = {name: _fitted(based, terms) for name, terms in models.items()}
    scales, problem = based.scales, based.problem
    best = min((fit for fit, _ in found.values()), key=lambda fit: against(fit, problem))
    problem = replace(problem, noise=noise_of(best, problem, scales.omega))
    fits = {name: (under(fit, problem), note) for name, (fit, note) in found.items()}
    least = min(against(fit, problem) for fit, _ in fits.values())
    worse = {name: against(fit, problem) - least for name, (fit, _) in fits.items()}
    total = sum(math.exp(-0.5 * one) for one in worse.values())
    ranked = sorted(fits, key=worse.__getitem__)
    rows = [
        ComparedModel(
            name=name,
            terms=[entry.term.key for entry in fits[name][0].model.terms],
            fitted=len(fits[name][0].free),
            chi2_per_point=fits[name][0].chi2 / fits[name][0].points,
            delta_bic=worse[name],
            weight=math.exp(-0.5 * worse[name]) / total,
            rmse=rmse(fits[name][0].shown.y, problem),
            parameters=_parameters(fits[name][0], problem, scales.omega),
            note=fits[name][1],
        )
        for name in ranked
    ]
    result = ModelsResult(recording=recording_info(recording, problem.noise), statement=_statement(rows), models=rows)
    residuals = {
        name: {"t": problem.t, **{c: y - fits[name][0].shown.y[c] for c, y in problem.channels.items()}}
        for name in ranked
    }
    return result.drawn(partial(models_page, angular=recording.angular), residuals)


def _fitted(based: Based[Any], terms: Sequence[str]) -> tuple[Fit, str]:
    """The base with these terms one after the other, and what there is to say of those that bring nothing."""
    found, notes = based.fit, list[str]()
    for name in terms:
        forms = [one for one in NAMED if one.name == name] or [term(name)]
        step = extend(found, based.problem, based.scales, forms)
        if step.fits:
            found = step.fits[0]
        else:
            notes.append(_NOT_SEEN.format(name))
    return found, "; ".join(notes)


def _parameters(fit: Fit, problem: Problem, omega: float) -> dict[str, P]:
    explained = fit.chi2 <= 2.0 * fit.points
    return {name: P.of(one) for name, one in base_parameters(fit, problem, omega, explained).items()}


def _statement(rows: Sequence[ComparedModel]) -> str:
    """Which is best, and how sure that is."""
    first = rows[0]
    if len(rows) == 1:
        return f"{first.name}: chi-square per point {first.chi2_per_point:.3g}."
    near = [one.name for one in rows[1:] if one.delta_bic < DECISIVE]
    sure = (
        f"not ruled out: {', '.join(near)}"
        if near
        else f"the next, {rows[1].name}, is worse by {rows[1].delta_bic:.0f}"
    )
    return f"{first.name} fits best (chi-square per point {first.chi2_per_point:.3g}); {sure} in BIC."

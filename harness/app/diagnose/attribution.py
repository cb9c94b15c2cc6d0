"""Whose mismatch it is: the simulation as the user has it, engine or trace, against the recording."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from harness.app.diagnose.changes import changes_of, hidden, parameters_of
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.shared.reading import read_sim
from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.core.trajectory import Source, Trajectory
from harness.diagnosis.alignment.match import as_kind_of, showing
from harness.diagnosis.attribution.attribute import (
    Attribution,
    Nearby,
    NoSharesError,
    attribute_engine,
    attribute_model,
    attribute_trace,
    nearby_of,
)
from harness.diagnosis.attribution.reading import Reading, aligned, in_masses_of, trace_channels
from harness.diagnosis.explain.engines import shown_by
from harness.diagnosis.explain.sentences import left_beside, unadvised
from harness.diagnosis.fit.standard_errors import covariances
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import observe
from harness.engines.simulator import EngineSimulator
from harness.model.document import load as load_model
from harness.model.model import Model
from harness.results.diagnosis import AttributionResult, Bar, ChangeResult
from harness.robot.own_model import OwnModel, is_own, own_model
from harness.robot.paste import stiff_friction

LOGGER = logging.getLogger(__name__)
JOINED = "a trace alone does not tell what its engine does from what its parameters do; --model FILE parts them"
_UNDIVIDED = "whose mismatch it is, was not divided"
_UNSURE = 0.05
"""Standard error of a share from which it is said: five points."""
_PARTS = ("engine", "parameters", "missing_physics", "unexplained", "noise")
_SEEN = 0.005
"""Share below nothing from which it is said: half a point."""
_TOLD = 0.02
"""Share of an engine below which its settings are let be."""


@dataclass(frozen=True, slots=True)
class Configured:
    """The simulation as the user has it: model of --model and trace of --sim, None where none was given.

    own : the model where it is an engine's own, an MJCF or a URDF.
    """

    model: Model | None = None
    trace: Recording | None = None
    own: OwnModel | None = None

    @classmethod
    def of(cls, options: DiagnoseOptions, recording: Recording) -> "Configured":
        """Read the files; raises InputError for one that cannot be used, or is of another kind than the recording."""
        given = options.model
        own = own_model(given) if isinstance(given, Path) and is_own(given) else None
        model = own.slider if own is not None else load_model(given) if isinstance(given, Path) else given
        trace = read_sim(options.sim, options.sim_reading) if isinstance(options.sim, Path) else options.sim
        return cls(model, trace and showing(as_kind_of(trace, recording, "--sim"), recording), own)

    def released(self, base: Model) -> Model:
        """The user's model, released as the recording was where the file does not say; ``base`` when there is none."""
        if self.model is None:
            return base
        if self.model.x0 == 0.0 and self.model.v0 == 0.0:
            return replace(self.model, x0=base.x0, v0=base.v0, t0=base.t0)
        return self.model

    def motion(self, outcome: Outcome, whole: Problem) -> Trajectory | None:
        """The user's simulation at the recording's times, as far as it reaches; None where there is none to show.

        extra "shown x" and the like: its channels. whole : the question at every sample of the recording.
        """
        if self.trace is not None:
            on = aligned(self.trace, outcome.problem, outcome.scales, whole)
            there = on.clock.back(whole.t)
            covers = replace(on, covered=(there >= self.trace.t[0]) & (there <= self.trace.t[-1]))
            shown = trace_channels(self.trace, whole, covers)
            at = np.flatnonzero(covers.covered)
            return _motion(whole.t[at], {c: y[at] for c, y in shown.items()})
        if self.model is None:
            return None
        try:
            model = self.released(outcome.base.model)
            if self.own is not None:
                shown, _ = shown_by(self.own.simulator, in_masses_of(model, outcome.base.model), whole, self.own.dt)
                return _motion(whole.t, shown)
            seen = observe(model, whole, scales=outcome.scales)
        except SimulationError as error:
            LOGGER.warning("the model given: %s", error)
            return None
        return _motion(whole.t, seen.y)


def _motion(t: FloatArray, shown: dict[str, FloatArray]) -> Trajectory | None:
    if t.size < 2:
        return None
    none = np.zeros(t.size)
    extra = {f"shown {c}": y for c, y in shown.items()}
    x, v, a = (shown.get(c, none) for c in ("x", "v", "a"))
    return Trajectory(t, x, v, a, Source("yours", "as given"), extra=extra)


@dataclass(frozen=True, slots=True)
class Shared:
    """Shares of the mismatch, None where there are none; warnings say why. has : names of the terms that the user's
    simulation has.
    """

    result: AttributionResult | None = None
    warnings: tuple[str, ...] = field(default=())
    has: tuple[str, ...] = ()


def simulator_of(name: str, options: DiagnoseOptions) -> tuple[EngineSimulator, float | None]:
    """An engine on the preset that was asked for, and its step in s; None: one that suits the recording."""
    simulator = EngineSimulator.named(name, options.preset)
    if options.preset == "as-shipped":
        return simulator, float(simulator.engine.presets("joint", options.preset)["dt"])
    return simulator, options.dt


def attribution_of(outcome: Outcome, whole: Problem, options: DiagnoseOptions, user: Configured) -> Shared:
    """Shares of the mismatch of the user's trace, else of the first engine that runs.

    whole : the question at every sample of the recording. Raises InputError for a trace that does not belong to it.
    """
    refined, problem, scales = outcome.refined.model, outcome.problem, outcome.scales
    model = user.released(outcome.base.model)
    has = () if user.model is None else _has(model)
    parameters = "the baseline fit's parameters"
    if options.model is not None:
        parameters = f"the parameters in {_name(options.model)}"
    try:
        if user.trace is not None:
            given = None if user.model is None else model
            found = attribute_trace(user.trace, given, refined, problem, scales, _nearby(outcome), whole)
            moved = "" if not found.shift else f", moved by {found.shift:.4g} s"
            against = "" if given is None else f", made with {_name(options.model)}"
            shares = _shares(found, outcome, f"the trace {_name(options.sim)}{against}{moved}")
            return Shared(shares, has=_has(found.configured) if given is None else has)
        if user.model is not None and user.own is None and not options.engines:
            exact = attribute_model(model, refined, problem, scales, _nearby(outcome))
            return Shared(_shares(exact, outcome, f"the exact motion at {parameters}"), has=has)
    except (NoSharesError, SimulationError) as error:
        return Shared(None, (f"{_UNDIVIDED}: {error}",), has)
    why: list[str] = []
    for name in options.engines if user.own is None else (user.own.engine,):
        try:
            simulator, dt = simulator_of(name, options) if user.own is None else (user.own.simulator, user.own.dt)
            step = dt if dt is not None else float(simulator.engine.presets("joint", options.preset)["dt"])
            found = attribute_engine(simulator, model, refined, problem, scales, step)
        except NoSharesError as error:
            why.append(f"{_UNDIVIDED} ({name}): {error}")
            continue
        except SimulationError as error:
            LOGGER.warning("attribution, %s: %s", name, error)
            continue
        how = options.preset if user.own is None else "with the file's own options"
        configuration = f"{name}, {how}, step {step * 1e3:.4g} ms, at {parameters}"
        return Shared(_shares(found, outcome, configuration, simulator, step, user.model is not None), has=has)
    return Shared(None, tuple(why), has)


def _has(model: Model) -> tuple[str, ...]:
    return tuple(entry.term.name for entry in model.terms)


def _nearby(outcome: Outcome) -> Nearby:
    """The refined models that the recording leaves open."""
    explained = outcome.verdict in ("adequate", "missing_physics")
    refined = outcome.refined
    return nearby_of(refined, covariances(refined, outcome.problem, outcome.scales.omega, explained))


def _name(given: Path | Recording | Model | None) -> str:
    """What was given, in a sentence."""
    return given.file if isinstance(given, Recording) else str(given) if isinstance(given, Path) else "the given model"


def _settings(simulator: EngineSimulator, found: Attribution, step: float) -> list[tuple[str, str, str]]:
    """Settings of the engine that differ from its tuned ones, name, from, to; none where its share is small."""
    if found.engine < _TOLD:
        return []
    own = {**simulator.engine.presets("joint", simulator.preset), **simulator.settings, "dt": step}
    tuned = simulator.engine.presets("joint", "tuned")
    apart = [(k, f"{own.get(k, 'not set')}", f"{v}") for k, v in tuned.items() if own.get(k) != v and k != "dt"]
    smaller = min(float(tuned.get("dt", step)), 0.5 * step)
    return [*apart, ("dt", f"{step:g} s", f"{smaller:g} s or less")]


def _shares(
    found: Attribution,
    outcome: Outcome,
    configuration: str,
    simulator: EngineSimulator | None = None,
    step: float | None = None,
    of_user: bool = True,
) -> AttributionResult:
    """The result's form. simulator, step (s) : what was simulated, None where a trace was read. of_user : whether the
    simulation is the user's own, and not that of the baseline fit.
    """
    if outcome.stepping is not None:
        found = found.with_steps(outcome.stepping.left, found.whole * (found.unexplained + found.noise))
    paste = _paste(found, simulator, step) if of_user else None
    settings = [] if simulator is None or paste is not None else _settings(simulator, found, step or 0.0)
    changes = changes_of(found, outcome, settings)
    why = unadvised(outcome) if changes else None
    beside = why or (left_beside(outcome) if changes else None)
    changes = [c for c in changes if why is None or c.kind == "setting"]
    return AttributionResult.taken_from(
        found,
        engine=None if found.joined else found.engine,
        stderr=found.errors,
        why=JOINED if found.joined else None,
        configuration=configuration,
        mean_square=found.whole,
        shift_s=found.shift,
        reads=None if found.reading is None else _reads(found.reading),
        recording=parameters_of(outcome.refined, outcome.problem),
        changes=changes,
        sentences=[
            *(_engine_words(found, changes, paste) if of_user else []),
            *_sentences(found, outcome),
            *([] if beside is None else [beside]),
        ],
        paste=paste,
        bars=_bars(found),
    )


def _reads(reading: Reading) -> dict[str, Quantity]:
    """What the trace was given, where it tells; else what it reads."""
    read = parameters_of(reading.found, reading.problem)
    if reading.adds is None:
        return read
    why = "read with what the engine adds"
    given = {name: float(getattr(reading.adds.given, name)) for name in read}
    return {name: Quantity(given[name], None, one.unit, why) for name, one in read.items()}


def _paste(found: Attribution, simulator: EngineSimulator | None, step: float | None) -> str | None:
    """Attributes for MuJoCo's soft friction, where it is the engine's error that shows."""
    if abs(found.engine) < _TOLD:
        return None
    if found.reading is not None and (adds := found.reading.adds) is not None:
        if adds.soft is None or adds.soft.value("lead") <= 0.0:
            return None
        step = adds.step or float(np.median(np.diff(found.reading.problem.t)))
    elif simulator is None or simulator.name != "mujoco" or simulator.preset == "tuned" or found.configured.f_k <= 0.0:
        return None
    assert step is not None
    words = " ".join(f'{name}="{value}"' for name, value in stiff_friction(step).items())
    return f"<joint {words}/>"


def _engine_words(found: Attribution, changes: Sequence[ChangeResult], paste: str | None) -> list[str]:
    """What the engine adds to the parameters of a simulation, and whether these are right."""
    said = [] if found.reading is None else _added_words(found.reading)
    wrong = [change for change in changes if change.kind != "setting"]
    if not wrong and not found.joined:
        then = "" if paste is None else f"; paste into the joint of your MJCF: {paste}"
        said.append(f"Your parameters are right{then}.")
    elif paste is not None:
        said.append(f"Besides, for the engine's friction, paste into the joint of your MJCF: {paste}.")
    return said


def _added_words(reading: Reading) -> list[str]:
    """How the engine of a trace steps and what it makes of dry friction."""
    adds, said = reading.adds, list[str]()
    if adds is None:
        return []
    unit = "rad/s" if reading.problem.angular else "m/s"
    step = "" if adds.step is None else f" with a step of {1e3 * adds.step:.4g} ms ({adds.scheme})"
    soft = "reverses within a step"
    if adds.soft is not None:
        width, lead = adds.soft.value("v_r"), adds.soft.value("lead")
        soft = f"is regularised by its engine: it ramps over {width:.3g} {unit} and leads the velocity by"
        soft = f"{soft} {1e3 * lead:.3g} ms"
    said.append(f"Your trace is that of a simulation{step} whose dry friction {soft}.")
    for other in adds.others[:1]:
        figures = ", ".join(f"{name} = {getattr(other.given, name):.4g}" for name in ("c", "k", "f_k"))
        said.append(
            f"Its position alone does not tell its integrator: were it {other.scheme}, it would have {figures}; with"
            " its acceleration in the file (qacc) it would be known."
        )
    return said


def _bars(found: Attribution) -> list[Bar]:
    """The shares, those that are negative drawn as one with the largest, whose error they hide."""
    names = ("parameters", "missing_physics") if found.joined else ("engine", "parameters", "missing_physics")
    shares = {name: float(getattr(found, name)) for name in names}
    largest = max(shares, key=lambda name: shares[name])
    hidden = [name for name in names if shares[name] < 0.0 and name != largest]
    rest = {"unexplained": max(found.unexplained, 0.0), "noise": found.noise}
    seen = [name for name in hidden if shares[name] < -_SEEN]
    whole = max(shares[largest] + sum(shares[name] for name in hidden), 0.0)
    bars = {
        (largest, *seen) if name == largest else (name,): whole if name == largest else shares[name]
        for name in names
        if name not in hidden
    } | {(name,): share for name, share in rest.items()}
    total = sum(bars.values()) or 1.0
    named = []
    for of, share in bars.items():
        # a trace alone has parameters and engine as one part
        shown = {*of, "engine"} if found.joined and "parameters" in of else of
        *first, last = (name.replace("_", " ") for name in _PARTS if name in shown)
        name = f"{', '.join(first)} and {last}" if first else last
        named.append(Bar(of=list(of), name=name, share=share / total))
    return named


def _sentences(found: Attribution, outcome: Outcome) -> list[str]:
    said = []
    if found.joined and found.reading is not None:
        reads = parameters_of(found.reading.found, outcome.problem)
        figures = ", ".join(f"{n} = {q.value:.4g} {q.unit}" for n, q in reads.items() if q.value is not None)
        if own := [entry.term.name for entry in found.reading.model.terms]:
            figures += f", with {' and '.join(own)} of its own"
        said.append(
            f"Effective parameters of your trace: {figures}. If your model file has other values, the difference comes "
            "from the engine; --model FILE separates the two."
        )
        if found.reading.left > 1.0:
            said.append(f"Engine error beyond parameters: {found.reading.left:.3g} times the noise variance.")
    if sentence := hidden(found, outcome):
        said.append(sentence)
    error = 0.0 if found.errors is None else max(found.errors.values())
    if error > _UNSURE:
        said.append(
            f"The shares are known to \u00b1 {100.0 * error:.2g} points: so much do they move with what the recording "
            "leaves open of its own parameters."
        )
    return said

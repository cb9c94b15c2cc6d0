"""A joint of a robot with a log of it: what every answer says of the two, and the answer where nothing is fitted."""

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from harness.app.diagnose.options import DiagnoseOptions, RobotOptions
from harness.app.shared.leaving import FILES, leave, leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import Progress
from harness.core.errors import SimulationError
from harness.core.quantity import Quantity
from harness.core.robot import JointLog
from harness.model.document import to_document
from harness.model.model import Model, Restoring
from harness.results.common import RecordingInfo
from harness.results.diagnosis import DiagnosisResult, FitResult, HoldoutResult, MechanismResult
from harness.results.robot import MatchResult, PasteResult, RobotResult, SimulatedResult
from harness.robot.arm import Arm
from harness.robot.match.compared import Compared
from harness.robot.match.sampled import RULES
from harness.robot.paste import JointPaste, copies, elsewhere
from harness.robot.pictured import pictured
from harness.robot.recording import Coupling
from harness.robot.replay.replay import MUJOCO, PYBULLET, replayed
from harness.show.report.robot import match_page
from harness.show.stored import Left, Motion, Shown

LOGGER = logging.getLogger(__name__)
ALL = "all"
"""In place of a joint's name: every joint that a log says something of."""
_WHY = "the log does not go together with the model"
_SHORT = "the joint slides too shortly"


@dataclass(frozen=True, slots=True)
class JointCase:
    """A joint of both. compared : the log against the model. out : folder, None for one named after the time. command :
    the line that makes it again.
    """

    arm: Arm
    log: JointLog
    joint: str
    compared: Compared
    asked: RobotOptions
    options: DiagnoseOptions
    out: Path | None
    progress: Progress
    command: str

    @property
    def name(self) -> str:
        return f"{Path(self.log.file).name.split('.')[0]}-{self.joint}"

    @property
    def settings(self) -> dict[str, Any]:
        return {**self.options.settings(), "robot": self.asked.settings()}

    def robot(self, *pastes: JointPaste, **more: Any) -> RobotResult:
        """What a result says of the robot; pastes : what the model lacks, by joint."""
        return RobotResult(
            file=str(self.asked.file.absolute()),
            joint=self.joint,
            paste=PasteResult(
                mjcf=_lines(one.mjcf for one in pastes),
                urdf=_lines(f"<!-- {one.joint} -->\n{one.urdf}" if pastes[1:] else one.urdf for one in pastes),
                **elsewhere(pastes, self.arm.slides),
            ),
            match=[MatchResult.taken_from(one, slope_stderr=one.error) for one in self.compared.matches],
            **more,
        )

    def result(self, model: Model, **more: Any) -> DiagnosisResult:
        """A result without a motion; model : of both fits. more : what it says besides."""
        log, joint = self.log, self.joint if self.joint in self.log.position else next(iter(self.log.effort))
        return without_motion(log, joint, model, settings=self.settings, command=self.command, **more)

    def copied(self, pastes: Sequence[JointPaste], folder: Path, kept_as: Callable[[str], str] = str) -> dict[str, str]:
        """Write the robot's model with what is to be pasted into ``folder``/model; the files' names in it, by kind."""
        (folder / "model").mkdir(exist_ok=True)
        files = {}
        for name, text in copies(self.asked.file, *pastes).items():
            kept = kept_as(name)
            (folder / "model" / kept).write_text(text, encoding="utf-8")
            files[f"robot_{'urdf' if name.endswith('.urdf') else 'mjcf'}"] = f"model/{kept}"
        return files

    def tried(
        self, pastes: Sequence[JointPaste], left: Left, offsets: Sequence[float]
    ) -> tuple[Shown, list[SimulatedResult]]:
        """Joints simulated with the friction of their file and with what is to be pasted: what is shown, and figures.

        Of several in MuJoCo alone. left : torque that the fits leave. offsets : of the logged torques, N m or N.
        """
        arm, log, asked = self.arm, self.log, self.asked
        held = {name: float(np.mean(log.position[name])) for name in arm.joints if name in log.position}
        results, motions = [], []
        engines = [name for name in (MUJOCO, PYBULLET) if name in self.options.engines]
        several = len(pastes) > 1
        for paste, offset, engine in [
            (*both, name) for both in zip(pastes, offsets, strict=True) for name in engines[: 1 if several else 2]
        ]:
            whose = {"joint": paste.joint} if several else {}
            try:
                one = replayed(asked.file, arm, log, paste, held, asked.gravity, offset, asked.payload or 0.0, engine)
            except SimulationError as error:
                LOGGER.warning("%s", error)
                nothing = SimulatedResult(engine=engine, dt_s=None, window_s=None, windows=0, before={}, after={})
                results.append(nothing.model_copy(update={"error": str(error), **whose}))
                continue
            if one is None:
                continue
            label = f"{paste.joint} in {engine}" if several else engine
            motions.append(Motion(label, one.t, one.logged, one.q_before, one.q_after))
            results.append(SimulatedResult.taken_from(one, engine=engine, dt_s=one.dt, window_s=one.window, **whose))
        bodies = pictured(asked.file, arm, log.t, log.position, pastes[0].joint)
        return Shown(left, tuple(motions), bodies), results


def _lines(texts: Iterable[str]) -> str:
    return "\n".join(texts)


def without_motion(log: JointLog, joint: str, model: Model, **more: Any) -> DiagnosisResult:
    """A result without a motion that is drawn; model : of both fits. more : what it says besides."""
    span = float(log.t[-1] - log.t[0])
    channels = [c for c, held in (("x", log.position), ("v", log.velocity), ("u", log.effort)) if joint in held]
    info = RecordingInfo.taken_from(
        log,
        samples=log.t.size,
        channels=channels,
        rate_hz=(log.t.size - 1) / span,
        duration_s=span,
        noise=dict.fromkeys(channels),
    )
    document = to_document(model)
    nothing: dict[str, Any] = {
        "where": [],
        "engines": {},
        "attribution": None,
        "evidence": [],
        "consistent_channels": {},
    }
    about = {"recording": info, "baseline_model": document, "refined_model": document}
    about |= {"machine": this_machine(), "next_experiment": "", "residual_map": None}
    return DiagnosisResult.model_validate(nothing | about | more)


def unfitted(case: JointCase, found: Coupling, broken: MechanismResult | None = None) -> DiagnosisResult:
    """The answer to a log that does not go together with its model, or (broken) shows how a joint breaks away alone.

    Raises StoreError.
    """
    own, compared = found.reduced, case.compared
    force, place = ("N", "m") if own.slides else ("N m", "rad")
    units = {"c": f"{force} s/{place}", "f_k": force, "offset": force}
    refused = {name: Quantity.refused(unit, _SHORT if broken else _WHY) for name, unit in units.items()}
    nothing = FitResult.model_validate({"parameters": refused, "rmse": {}, "chi2_per_point": None})
    mend = f" Try: {compared.option}" if compared.option else " No option mends that: look for another model or log."
    said = f"Log and model do not go together: {compared.statement}.{mend}"
    if compared.unlogged:
        more = "A log of every cycle of the controller, or of the mean since the sample before, tells it."
        said = f"Log and model cannot be compared: {compared.statement}. {more}"
    if broken is not None:
        said = f"{case.joint}{', the other joints locked' if own.held else ''}. {broken.statement}"
    with leaving(f"diagnose-{case.name}", case.out) as output:
        result = case.result(
            Model(own.moved, 0.0, 0.0, 0.0, restoring=Restoring.NONE),
            verdict="unexplained" if broken is None else "main_effect",
            statement=said,
            baseline=nothing,
            mechanisms=[] if broken is None else [broken],
            refined=nothing,
            rules=RULES,
            holdout=HoldoutResult(spans_s=[], baseline_rmse={}, refined_rmse={}),
            robot=case.robot(mode=found.mode, reduction=None, confounded=[]),
            model_left_out=[],
            warnings=case.arm.notes,
            files={kind: output.at(FILES[kind]) for kind in ("result", "report", "log")},
        )
        leave(output, result, match_page(result))
    return result

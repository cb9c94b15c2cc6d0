"""A log that is not fitted: it does not go together with its robot's model, or shows how a joint breaks away alone."""

from collections.abc import Sequence
from pathlib import Path

from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.robot_options import RobotOptions
from harness.app.diagnose.show import write_match_page
from harness.app.shared.deliver import to_json
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import NAME as LOG
from harness.app.shared.progress import journal
from harness.core.quantity import Quantity
from harness.core.robot.joint_log import JointLog
from harness.io.store import output_folder
from harness.model.document import to_document
from harness.model.model import Model, Restoring
from harness.results.common import ModelDocument, P, RecordingInfo
from harness.results.diagnosis import DiagnosisResult, FitResult, HoldoutResult, MechanismResult, RuleResult
from harness.results.robot import MatchResult, PasteResult, RobotResult
from harness.robot.arm import Arm
from harness.robot.coupling import Coupling
from harness.robot.match.compared import Compared, Match
from harness.robot.match.rules import RULES

FILES = {"result": "result.json", "report": "report.html", "log": LOG}
_WHY = "the log does not go together with the model"
_SHORT = "the joint slides too shortly"


def match_results(matches: Sequence[Match]) -> list[MatchResult]:
    """As results hold them."""
    return [
        MatchResult(
            joint=one.joint,
            by=one.by,
            correlation=one.correlation,
            slope=one.slope,
            slope_stderr=one.error,
            offset=one.offset,
            suspicion=one.suspicion,
            option=one.option,
        )
        for one in matches
    ]


def recording_info(log: JointLog, joint: str) -> RecordingInfo:
    """A joint of a log."""
    span = float(log.t[-1] - log.t[0])
    channels = [c for c, held in (("x", log.position), ("v", log.velocity), ("u", log.effort)) if joint in held]
    return RecordingInfo(
        file=log.file,
        sha256=log.sha256,
        samples=log.t.size,
        channels=channels,
        rate_hz=(log.t.size - 1) / span,
        duration_s=span,
        noise=dict.fromkeys(channels),
        notes=list(log.notes),
    )


def unfitted(
    arm: Arm,
    log: JointLog,
    asked: RobotOptions,
    options: DiagnoseOptions,
    found: Coupling,
    compared: Compared,
    out: Path | None,
    command: str,
    broken: MechanismResult | None = None,
) -> DiagnosisResult:
    """The answer to such a log, with its page; broken : how the joint breaks away, None where the model is another.

    Raises StoreError.
    """
    joint = found.reduced.joint
    with output_folder(f"diagnose-{Path(log.file).name.split('.')[0]}-{joint}", out) as output, journal(output / LOG):
        files = {kind: output.at(file) for kind, file in FILES.items()}
        result = _result(arm, log, asked, options, found, compared, command, files, broken)
        (output / FILES["result"]).write_text(to_json(result), encoding="utf-8")
        write_match_page(output / FILES["report"], result)
        output.commit()
    return result


def _result(
    arm: Arm,
    log: JointLog,
    asked: RobotOptions,
    options: DiagnoseOptions,
    found: Coupling,
    compared: Compared,
    command: str,
    files: dict[str, str],
    broken: MechanismResult | None,
) -> DiagnosisResult:
    own, why = found.reduced, _WHY if broken is None else _SHORT
    force, place = ("N", "m") if own.slides else ("N m", "rad")
    nothing = FitResult(
        parameters={
            "c": P.of(Quantity.refused(f"{force} s/{place}", why)),
            "f_k": P.of(Quantity.refused(force, why)),
            "offset": P.of(Quantity.refused(force, why)),
        },
        rmse={},
        chi2_per_point=None,
    )
    document = ModelDocument.model_validate(to_document(Model(own.moved, 0.0, 0.0, 0.0, restoring=Restoring.NONE)))
    mend = f" Try: {compared.option}" if compared.option else " No option mends that: look for another model or log."
    said = f"Log and model do not go together: {compared.statement}.{mend}"
    if broken is not None:
        said = f"{own.joint}, the others still: {broken.statement}"
    return DiagnosisResult(
        recording=recording_info(log, own.joint),
        verdict="unexplained" if broken is None else "main_effect",
        statement=said,
        baseline=nothing,
        where=[],
        mechanisms=[] if broken is None else [broken],
        refined=nothing,
        rules=[RuleResult(name=r.name, value=r.value, unit=r.unit, origin=r.origin) for r in RULES],
        holdout=HoldoutResult(spans_s=[], baseline_rmse={}, refined_rmse={}),
        engines={},
        attribution=None,
        robot=RobotResult(
            file=str(asked.file.absolute()),
            joint=own.joint,
            mode=found.mode,
            reduction=None,
            confounded=[],
            paste=PasteResult(mjcf="", urdf=""),
            match=match_results(compared.matches),
        ),
        evidence=[],
        consistent_channels={},
        next_experiment="",
        residual_map=None,
        baseline_model=document,
        refined_model=document,
        model_left_out=[],
        warnings=list(arm.notes),
        settings={**options.settings(), "robot": asked.settings()},
        command=command,
        machine=this_machine(),
        files=files,
    )

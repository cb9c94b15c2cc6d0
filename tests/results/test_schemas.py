"""The shipped schemas are those of the code, and an example of each result is valid by its schema."""

import json
import math
from typing import Any

import jsonschema
import pytest
from pydantic import ValidationError

from harness.core.quantity import Quantity
from harness.results import generate
from harness.results.common import Check, DoctorResult, Machine, P, RecordingInfo, Result
from harness.results.compare import Aligned, CompareResult, Difference, Event, Largest, OtherShift, Reading
from harness.results.identify import IdentifyResult
from harness.results.run import Estimates, Metrics, RunResult, TraceResult

MACHINE = Machine(python="3.11.2", packages={"mujoco": "4.0.0"}, system="Linux", cores=2)
NUMBER = P(value=0.03, stderr=1e-6, unit="m")
REFUSED = P.of(Quantity.refused("m", "two reversals; three are needed"))
RECORDING = RecordingInfo(
    file="/data/swing.csv",
    sha256="0" * 64,
    samples=4600,
    channels=["x"],
    rate_hz=1000.0,
    duration_s=4.6,
    noise={"x": 1e-4, "a": "none found"},
)
ESTIMATES = Estimates(omega_n=P(value=10.0, stderr=1e-3, unit="rad/s"), zeta=REFUSED, x_k=NUMBER, reversals=7)
METRICS = Metrics(
    max_error_m=0.0128,
    rest_error_m=None,
    stick_time_s=2.5164,
    creep_m_s=-1.15e-3,
    half_cycles=8,
    reversal_lead_s=0.01,
    energy_error=math.nan,
)

EXAMPLES: list[Result] = [
    RunResult(
        scenario={"name": "free-decay", "slider": {"m": 1.0, "c": 1.0, "k": 100.0, "f_k": 3.0, "f_s": 3.0}},
        traces=[
            TraceResult(
                source="mujoco",
                preset="as-shipped",
                version="4.0.0",
                settings={"integrator": "Euler", "solreffriction": [0.02, 1.0]},
                ignored=["break-away force"],
                dt_s=0.002,
                wall_s=None,
                samples=1501,
                metrics=METRICS,
                estimates={"acceleration": ESTIMATES},
            )
        ],
        conclusions=["One sentence."],
        machine=MACHINE,
        files={"report": "/tmp/report.html"},
    ),
    IdentifyResult(
        recording=RECORDING,
        estimates={"displacement": ESTIMATES},
        sensor_phase_rad=P(value=None, stderr=None, unit="rad", why="no acceleration channel"),
        warnings=[],
        machine=MACHINE,
    ),
    CompareResult(
        files=["a.csv", "b.csv"],
        aligned=Aligned(
            shift_s=P(value=0.0, stderr=1e-5, unit="s"),
            scale=P(value=1.0, stderr=1e-6, unit="1"),
            alternatives=[OtherShift(shift_s=0.52, worse_by=3.2)],
        ),
        traces={
            name: Reading(
                method="displacement",
                omega_n=NUMBER,
                zeta=NUMBER,
                x_k=NUMBER,
                amplitude=NUMBER,
                rest=REFUSED,
                events=[Event(time_s=0.5, kind="release", value=0.04)],
            )
            for name in ("a", "b")
        },
        differences=[Difference(what="zeta", first=NUMBER, second=NUMBER, significance=0.0)],
        largest=Largest(channel="x", value=1e-3, unit="m", time_s=0.7),
        fit_percent={"x": 98.0},
        noise={"x": 1e-5},
        rmse={"x": 1e-3},
        where=[],
        consistent_channels={},
        verdict="different",
    ),
    DoctorResult(checks=[Check(name="python", ok=True, found="3.11.2", needed_for="everything")], machine=MACHINE),
]


def test_shipped_schemas_are_those_of_the_code() -> None:
    shipped = {file.name: file.read_text(encoding="utf-8") for file in generate.FOLDER.glob("*.json")}
    made = {generate.file_name(name): generate.schema_text(name, model) for name, model in generate.models().items()}
    assert shipped == made, "run python -m harness.results.generate"


@pytest.mark.parametrize("name", generate.models())
def test_every_schema_has_an_example_that_is_valid(name: str) -> None:
    examples = [e for e in EXAMPLES if name == json.loads(e.model_dump_json(by_alias=True))["schema"]]
    if not examples:
        # results of other rooms bring their example with their own tests
        pytest.skip(f"the example of {name} is tested beside its use case")
    schema = json.loads((generate.FOLDER / generate.file_name(name)).read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    for example in examples:
        jsonschema.validate(json.loads(example.model_dump_json(by_alias=True)), schema)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda e: type(e).__name__)
def test_results_survive_json(example: Result) -> None:
    text = example.model_dump_json(by_alias=True)
    again = type(example).model_validate_json(text)
    assert again.model_dump_json(by_alias=True) == text


def test_an_unknown_field_is_an_error() -> None:
    with pytest.raises(ValidationError, match="typo"):
        P.model_validate({"value": 1.0, "stderr": 1.0, "unit": "m", "typo": 1})


@pytest.mark.parametrize("missing", [{"value": None, "stderr": None}, {"value": 1.0, "stderr": None}])
def test_what_is_null_says_why(missing: dict[str, Any]) -> None:
    with pytest.raises(ValidationError, match="needs a why"):
        P.model_validate({**missing, "unit": "m"})


def test_a_number_has_no_why_and_a_refusal_has_one() -> None:
    assert json.loads(NUMBER.model_dump_json()) == {"value": 0.03, "stderr": 1e-6, "unit": "m"}
    assert json.loads(REFUSED.model_dump_json())["why"].startswith("two reversals")

"""MCAP files that ROS has not written: joints from the fields of messages in JSON, protobuf and CDR."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import joint_logs
import numpy as np
import pytest
from joint_logs import ONE

from harness.core.errors import InputError
from harness.io.logs.raw import LogOptions
from harness.io.logs.read import describe_log, read_joint_log

pytest.importorskip("mcap")
Written = Iterator[tuple[float, bytes]]


def written(path: Path, topics: dict[str, Written], encoding: str = "json", schema: Any = ("robot", "", b"")) -> Path:
    from mcap.writer import Writer

    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        for topic, messages in topics.items():
            number = writer.register_schema(*schema)
            channel = writer.register_channel(topic, encoding, number)
            for t, data in messages:
                writer.add_message(channel, 10**18 + round(1e9 * t), data, 10**18 + round(1e9 * t))
        writer.finish()
    return path


def of_json(make: Any) -> Written:
    """A message a sample: make(i) is its fields."""
    return ((float(t), json.dumps(make(i)).encode()) for i, t in enumerate(ONE.t))


def state(i: int, kind: str) -> dict[str, float]:
    return {joint: float(values[i]) for joint, values in getattr(ONE, kind).items()}


SHAPES: dict[str, Any] = {
    "objects": lambda i: {j: {"position": q, "effort": state(i, "effort")[j]} for j, q in state(i, "position").items()},
    "lists": lambda i: {
        "name": list(ONE.joints),
        "position": list(state(i, "position").values()),
        "effort": list(state(i, "effort").values()),
        "header": {
            "stamp": {"sec": int(ONE.t[i]), "nanosec": round(1e9 * (float(ONE.t[i]) % 1.0))},
            "frame_id": "base",
        },
    },
    "named": lambda i: {
        "joints": [{"name": j, "position": q, "effort": state(i, "effort")[j]} for j, q in state(i, "position").items()]
    },
}


@pytest.mark.parametrize("shape", SHAPES)
def test_joints_are_read_from_messages_in_json(tmp_path: Path, shape: str) -> None:
    other = of_json(lambda i: {"battery": 12.0 - 0.01 * i, "state": "driving"})
    path = written(tmp_path / "log.mcap", {"/joints": of_json(SHAPES[shape]), "/power": other})
    found = read_joint_log(path)
    assert set(found.joints) == set(ONE.joints)
    assert found.t == pytest.approx(ONE.t, abs=1e-6)
    for joint in ONE.joints:
        assert found.position[joint] == pytest.approx(ONE.position[joint])
        assert found.effort[joint] == pytest.approx(ONE.effort[joint])
    told = {one.name: one for one in describe_log(path, LogOptions())}
    assert set(told["/joints"].joints) == set(ONE.joints)
    assert not told["/power"].joints


def test_numbered_positions_are_in_the_models_order(tmp_path: Path) -> None:
    path = written(tmp_path / "log.mcap", {"/q": of_json(lambda i: {"q": list(state(i, "position").values())})})
    found = read_joint_log(path, joints=("upper", "lower"))
    assert found.position["lower"] == pytest.approx(ONE.position["elbow"])


def test_a_path_of_fields_is_a_column(tmp_path: Path) -> None:
    path = written(
        tmp_path / "log.mcap", {"/d": of_json(lambda i: {"drive": {"turns": state(i, "position")["elbow"]}})}
    )
    with pytest.raises(InputError, match="no topic that names positions"):
        read_joint_log(path)
    found = read_joint_log(path, topic="/d", columns="elbow.position=drive.turns[rev]")
    assert found.position["elbow"] == pytest.approx(2.0 * np.pi * ONE.position["elbow"])


def test_joints_are_read_from_protobuf_by_the_files_own_schema(tmp_path: Path) -> None:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
    from mcap_protobuf.writer import Writer

    file = descriptor_pb2.FileDescriptorProto(name="arm.proto", package="arm", syntax="proto3")
    message = file.message_type.add(name="State")
    for number, name in enumerate(("elbow_position", "elbow_effort"), 1):
        message.field.add(name=name, number=number, type="TYPE_DOUBLE", label="LABEL_OPTIONAL")
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    made = message_factory.GetMessageClass(pool.FindMessageTypeByName("arm.State"))
    path = tmp_path / "log.mcap"
    with path.open("wb") as stream, Writer(stream) as writer:
        for i, t in enumerate(ONE.t):
            one = made(elbow_position=state(i, "position")["elbow"], elbow_effort=state(i, "effort")["elbow"])
            writer.write_message("/arm", one, 10**18 + round(1e9 * t), 10**18 + round(1e9 * t))
    found = read_joint_log(path)
    assert found.position["elbow"] == pytest.approx(ONE.position["elbow"])
    assert found.effort["elbow"] == pytest.approx(ONE.effort["elbow"])


def test_states_of_ros_in_a_file_without_its_profile(tmp_path: Path) -> None:
    messages = joint_logs.messages(ONE)
    packed = ((float(t), joint_logs.packed(one, "", False)[1]) for t, one in zip(ONE.t, messages, strict=True))
    schema = ("sensor_msgs/msg/JointState", "ros2msg", b"")
    found = read_joint_log(written(tmp_path / "log.mcap", {"/joint_states": packed}, "cdr", schema))
    assert found.effort["shoulder"] == pytest.approx(ONE.effort["shoulder"])


def test_what_cannot_be_read_is_said(tmp_path: Path) -> None:
    unknown = written(tmp_path / "flat.mcap", {"/x": iter([(0.0, b"\x00")])}, "flatbuffer")
    with pytest.raises(InputError, match="JSON, protobuf"):
        read_joint_log(unknown)
    whole = written(tmp_path / "log.mcap", {"/q": of_json(lambda i: {"q": [0.1 * i]})}).read_bytes()
    cut = tmp_path / "cut.mcap"
    for size in (20, 200, len(whole) // 2):
        cut.write_bytes(whole[:size])
        with pytest.raises(InputError, match=r"cut\.mcap"):
            read_joint_log(cut)
    with pytest.raises(InputError, match="/q"):
        read_joint_log(written(tmp_path / "log.mcap", {"/q": of_json(lambda i: {"q": [0.1 * i]})}), topic="/p")

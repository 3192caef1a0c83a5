"""Our CDR encoder compared with that of rosbags, which shares no code with it."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from mgs.motion_file.cdr import (
    DEFINITIONS,
    Counted,
    Slot,
    element_layout,
    full_name,
    message_layout,
    schema_text,
)

STORE = get_typestore(Stores.ROS2_HUMBLE)
USED_IN_OTHERS = {line.split()[0].removesuffix("[]") for d in DEFINITIONS.values() for line in d}
MESSAGES = [kind for kind in DEFINITIONS if kind not in USED_IN_OTHERS]
NUMBERS = {
    "bool": st.booleans(),
    "uint8": st.integers(0, 255),
    "int32": st.integers(-(2**31), 2**31 - 1),
    "uint32": st.integers(0, 2**32 - 1),
    "float32": st.floats(width=32, allow_nan=False),
    "float64": st.floats(allow_nan=False),
    "string": st.text(st.characters(exclude_characters="\0", codec="utf-8"), max_size=9),
}
ARRAYS = {"uint8": np.uint8, "float64": np.float64}


@st.composite
def values(draw: st.DrawFn, kind: str) -> Any:
    """Values of a type; every string and sequence length moves what comes after it."""
    if kind.endswith("[]"):
        return draw(st.lists(values(kind.removesuffix("[]")), max_size=2))
    if kind in NUMBERS:
        return draw(NUMBERS[kind])
    fields = [line.split() for line in DEFINITIONS[kind]]
    return {name: draw(values(field_kind)) for field_kind, name in fields}


def to_rosbags(kind: str, value: Any) -> Any:
    if kind.endswith("[]"):
        item = kind.removesuffix("[]")
        if item in ARRAYS:
            return np.array(value, dtype=ARRAYS[item])
        return [to_rosbags(item, v) for v in value]
    if kind in NUMBERS:
        return value
    fields = {n: to_rosbags(k, value[n]) for k, n in (line.split() for line in DEFINITIONS[kind])}
    return STORE.types[full_name(kind)](**fields)


def reference_bytes(kind: str, value: Any) -> bytes:
    return bytes(STORE.serialize_cdr(to_rosbags(kind, value), full_name(kind)))


@pytest.mark.parametrize("kind", DEFINITIONS)
def test_schema_text_is_that_of_rosbags_without_constants(kind: str) -> None:
    expected, _ = STORE.generate_msgdef(full_name(kind), ros_version=2)
    assert schema_text(kind) == re.sub(r"^\S+ \w+=.*\n", "", expected, flags=re.MULTILINE)


@pytest.mark.parametrize("kind", MESSAGES)
@settings(max_examples=30)
@given(data=st.data())
def test_every_message_is_byte_for_byte_that_of_rosbags(kind: str, data: st.DataObject) -> None:
    value = data.draw(values(kind))
    assert message_layout(kind, value).template.tobytes() == reference_bytes(kind, value)


@given(
    names=st.lists(NUMBERS["string"], min_size=1, max_size=4),
    frame=NUMBERS["string"],
    stamp=st.tuples(st.integers(0, 2**31 - 1), st.integers(0, 10**9 - 1)),
    seed=st.integers(0, 2**32 - 1),
)
def test_slots_equal_the_bytes_of_a_message_encoded_alone(
    names: list[str], frame: str, stamp: tuple[int, int], seed: int
) -> None:
    kind, n = "sensor_msgs/JointState", len(names)
    position, effort = np.random.default_rng(seed).normal(size=(2, 3, n))
    layout = message_layout(
        kind,
        {
            "header": {"stamp": Slot("stamp", 2, "<i4"), "frame_id": frame},
            "name": names,
            "position": Slot("position", n),
            "effort": Slot("effort", n),
        },
    )
    stamps = np.tile(np.array(stamp, dtype=np.int32), (3, 1))
    rows = layout.encode(3, {"stamp": stamps, "position": position, "effort": effort})
    for k, row in enumerate(rows):
        value = {
            "header": {"stamp": {"sec": stamp[0], "nanosec": stamp[1]}, "frame_id": frame},
            "name": names,
            "position": position[k].tolist(),
            "velocity": [],
            "effort": effort[k].tolist(),
        }
        assert row.tobytes() == reference_bytes(kind, value)


@given(n_joints=st.integers(1, 5), n_points=st.integers(1, 4), name=NUMBERS["string"])
def test_a_sequence_made_piece_by_piece_equals_the_message_made_at_once(
    n_joints: int, n_points: int, name: str
) -> None:
    kind = "trajectory_msgs/JointTrajectory"
    positions = np.random.default_rng(n_points).normal(size=(n_points, n_joints))
    point = {"positions": Slot("positions", n_joints), "time_from_start": Slot("time", 2, "<i4")}
    value = {"joint_names": [name] * n_joints, "points": Counted(n_points, [point])}
    head = message_layout(kind, value)
    rest = element_layout("trajectory_msgs/JointTrajectoryPoint", point, head.size - 4)
    times = np.arange(2 * n_points, dtype=np.int32).reshape(-1, 2)
    pieces = [
        layout.encode(len(times[part]), {"positions": positions[part], "time": times[part]})
        for layout, part in ((head, np.s_[:1]), (rest, np.s_[1:]))
    ]
    points = [
        {
            "positions": p.tolist(),
            "velocities": [],
            "accelerations": [],
            "effort": [],
            "time_from_start": {"sec": t[0], "nanosec": t[1]},
        }
        for p, t in zip(positions, times.tolist(), strict=True)
    ]
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
    expected = {"header": header, "joint_names": [name] * n_joints, "points": points}
    assert b"".join(p.tobytes() for p in pieces) == reference_bytes(kind, expected)


def test_decoding_returns_the_columns_bit_for_bit() -> None:
    layout = message_layout("geometry_msgs/PointStamped", {"point": Slot("point", 3)})
    points = np.array([[0.0, -0.0, 5e-324], [1.7e308, math.pi, -1.0]])
    decoded = layout.decode(layout.encode(2, {"point": points}))["point"]
    assert decoded.tobytes() == points.tobytes()


def test_decoding_refuses_a_byte_that_differs_outside_the_slots() -> None:
    layout = message_layout("geometry_msgs/PointStamped", {"point": {"x": Slot("x", 1)}})
    for at in range(layout.size):
        rows = layout.encode(1, {"x": np.ones((1, 1))})
        rows[0, at] ^= 1
        if rows[0, layout.slots[0][1] :][:8].view("<f8") == 1.0:
            with pytest.raises(ValueError, match="laid out"):
                layout.decode(rows)


def test_decoding_refuses_different_values_in_slots_of_one_name() -> None:
    stamped = {"header": {"stamp": Slot("stamp", 2, "<i4")}}
    layout = message_layout("tf2_msgs/TFMessage", {"transforms": [stamped, stamped]})
    rows = layout.encode(1, {"stamp": np.ones((1, 2), dtype=np.int32)})
    rows[0, layout.slots[1][1]] = 7
    with pytest.raises(ValueError, match="stamp"):
        layout.decode(rows)


def test_a_field_that_a_type_does_not_have_is_refused() -> None:
    with pytest.raises(KeyError, match="positon"):
        message_layout("sensor_msgs/JointState", {"positon": []})

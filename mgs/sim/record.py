"""A replay as topics beside its plan in a motion file, and as a motion for pictures.

Topics of the recorded file, on the clock of the motion; they go on to the end of the replay:

    /sim/joint_states           joint angles [rad] and torques of the servos [N m]
    /sim/base                   pose of the base
    /sim/tf                     links as frames with the prefix `sim/`
    /sim/contact/left, /sim/contact/right
                                force on each sole [N]; its torque is left zero
    /sim/zmp                    centre of pressure of both soles; messages only while one bears
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, GRAVITY
from mgs.core.contact import Side
from mgs.motion import Motion
from mgs.motion_file.cdr import Slot, message_layout
from mgs.motion_file.topics import STAMP, WORLD, stamps_ns
from mgs.motion_file.transforms import link_tree
from mgs.motion_file.write import AddedTopic, write_motion
from mgs.sim.figures import Trace

PREFIX = "sim/"
BEARS = 0.02  # of the weight, that the soles bear together at least to have a centre of pressure


def write_recorded(motion: Motion, trace: Trace, path: Path, *, force: bool = False) -> Path:
    """Write the motion file of the plan with what happened in a replay as topics /sim/*.

    Raises:
        OutputExistsError: the file exists and `force` is False.
        MgsError: the file cannot be written.
    """
    return write_motion(motion, path, force=force, added=recorded_topics(motion, trace))


def recorded_topics(motion: Motion, trace: Trace) -> list[AddedTopic]:
    """Topics of a replay."""
    times, world = stamps_ns(len(trace.t), motion.dt), _header(WORLD)
    joints = {
        "header": _header(""),
        "name": motion.robot.joint_names,
        "position": Slot("position", motion.robot.n),
        "effort": Slot("effort", motion.robot.n),
    }
    angles = {"position": trace.q[:, FLOATING_BASE_NQ:], "effort": trace.torque}
    pressure, bears = centre_of_pressure(motion, trace)
    point = {axis: Slot(axis, 1) for axis in "xyz"}
    pose = {"header": world, "pose": Slot("pose", FLOATING_BASE_NQ)}
    return [
        _topic("joint_states", "sensor_msgs/JointState", joints, times, angles),
        _topic("base", "geometry_msgs/PoseStamped", pose, times, {"pose": trace.q[:, :7]}),
        _tf(motion, trace, times),
        *(
            _topic(
                f"contact/{side.label}",
                "geometry_msgs/WrenchStamped",
                {"header": world, "wrench": {"force": Slot("force", 3)}},
                times,
                {"force": trace.contacts[:, side, :3]},
            )
            for side in Side
        ),
        _topic(
            "zmp",
            "geometry_msgs/PointStamped",
            {"header": world, "point": point},
            times[bears],
            {axis: pressure[bears, i : i + 1] for i, axis in enumerate("xyz")},
        ),
    ]


def centre_of_pressure(motion: Motion, trace: Trace) -> tuple[Array, NDArray[np.bool_]]:
    """Centre of pressure (M, 3) of both soles together, and where (M,) there is one."""
    total = trace.contacts.sum(axis=1)  # (M, 5)
    bears = total[:, 2] > BEARS * GRAVITY * motion.robot.mass
    centre = np.zeros((len(total), 3))
    np.divide(total[:, 3:], total[:, 2:3], out=centre[:, :2], where=bears[:, None])
    return centre, bears


def as_motion(motion: Motion, trace: Trace, name: str) -> Motion:
    """The replay as a motion (M samples) that pictures can show; references are the plan's.

    Where the soles bear nothing, the ZMP is where it was last.
    """
    plan = trace.plan
    per_sample = {
        field.name: getattr(motion, field.name)[plan]
        for field in dataclasses.fields(motion)
        if isinstance(getattr(motion, field.name), np.ndarray)
    }
    model, data = motion.robot.model, motion.robot.model.createData()
    com = np.array([pin.centerOfMass(model, data, q).copy() for q in trace.q])
    centre, bears = centre_of_pressure(motion, trace)
    last = np.maximum.accumulate(np.where(bears, np.arange(len(bears)), 0))
    changed = {
        "q": trace.q,
        "torque": trace.torque,
        "soles": trace.soles,
        "com": com,
        "zmp": centre[last, :2],
        "gait_name": name,
    }
    return dataclasses.replace(motion, **per_sample | changed)


def _tf(motion: Motion, trace: Trace, times: NDArray[np.uint64]) -> AddedTopic:
    tree = link_tree(motion.robot)
    links = [(WORLD, tree.root, "base")]
    links += [(parent, child, f"link {i}") for i, (parent, child) in enumerate(tree.moving)]
    transforms = [
        {
            "header": _header(parent if parent == WORLD else PREFIX + parent),
            "child_frame_id": PREFIX + child,
            "transform": Slot(slot, 7),
        }
        for parent, child, slot in links
    ]
    poses = tree.poses(trace.q)
    columns = {f"link {i}": poses[:, i] for i in range(poses.shape[1])}
    value = {"transforms": transforms}
    return _topic("tf", "tf2_msgs/TFMessage", value, times, columns | {"base": trace.q[:, :7]})


def _header(frame: str) -> dict[str, Any]:
    return {"stamp": STAMP, "frame_id": frame}


def _topic(
    name: str,
    kind: str,
    value: Mapping[str, Any],
    times: NDArray[np.uint64],
    columns: Mapping[str, NDArray[Any]],
) -> AddedTopic:
    return AddedTopic(f"/sim/{name}", kind, message_layout(kind, value), times, columns)

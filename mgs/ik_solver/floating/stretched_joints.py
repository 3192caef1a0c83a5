"""Joints that stretch a limb, whose Jacobian is singular at the angle where the limb is longest.

The knee of a leg is the joint that changes the distance between its first and its last joint most;
the leg is stretched where that distance is largest. For an arm the hand takes the place of the last
joint.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.constants import FLOATING_BASE_NV
from mgs.robot import Robot
from mgs.robot.limbs import joint_chain

N_ANGLES = 721  # samples of the length of a limb over one turn of a joint, every half degree
LEAST_CHANGE = 0.2  # smallest change of length that counts as bending, relative to the longest


def stretched_joints(robot: Robot) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Indices (k,) of the joints that stretch a leg or an arm, and the angles (k,) where [rad]."""
    found: dict[int, float] = {}
    for frame_id in (*robot.sole_frames, *robot.hand_frames):
        frame = robot.model.frames[frame_id]
        chain = joint_chain(robot, frame_id, robot.torso_frame)
        is_leg = frame_id in robot.sole_frames
        tip = pin.SE3.Identity() if is_leg else frame.placement
        candidates = chain[1:-1] if is_leg else chain[1:]
        if not candidates:
            continue
        changes = [_length_change(robot.model, chain, joint, tip) for joint in candidates]
        best = int(np.argmax([change for change, _ in changes]))
        change, angle = changes[best]
        if change > LEAST_CHANGE:
            joint = candidates[best]
            found[int(robot.model.idx_vs[joint]) - FLOATING_BASE_NV] = angle
    return np.array(list(found), np.intp), np.array(list(found.values()))


def _length_change(
    model: pin.Model, chain: list[int], joint: int, tip: pin.SE3
) -> tuple[float, float]:
    """Largest relative shortening of a limb by a joint, and the angle [rad] where it is longest."""
    i = int(model.idx_qs[joint])
    before, after = pin.SE3.Identity(), pin.SE3.Identity()
    for here in chain[1 : chain.index(joint) + 1]:
        before = before * model.jointPlacements[here]
    for here in chain[chain.index(joint) + 1 :]:
        after = after * model.jointPlacements[here]
    after = after * tip
    angles = np.linspace(-np.pi, np.pi, N_ANGLES)
    data = model.joints[joint].createData()
    lengths = np.empty(N_ANGLES)
    for k, angle in enumerate(angles):
        q = np.zeros(model.nq)
        q[i] = angle
        model.joints[joint].calc(data, q)
        lengths[k] = np.linalg.norm((before * pin.SE3(data.M) * after).translation)
    within = (angles >= model.lowerPositionLimit[i] - 0.5) & (
        angles <= model.upperPositionLimit[i] + 0.5
    )
    lengths, angles = lengths[within], angles[within]
    longest = int(np.argmax(lengths))
    return float(1.0 - lengths.min() / lengths[longest]), float(angles[longest])

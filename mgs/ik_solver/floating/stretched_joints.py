"""Which joints stretch a limb: at the angle where it is longest its Jacobian is singular.

The joint of a leg that changes most the distance of its last joint from its first one is its knee;
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

N_ANGLES = 721  # at which a joint's effect on the length is sampled: every half degree
LEAST_CHANGE = 0.2  # of the longest length; below, a joint bends no limb


def stretched_joints(robot: Robot) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Indices (k,) of the joints that stretch a leg or an arm, and their angles (k,) [rad] then."""
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
    """By what part of its largest value a joint can shorten a limb, and where it is longest."""
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

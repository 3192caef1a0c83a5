"""The seam between two parts of a sequence: what has to agree there, and the transition.

The soles have to agree, since a transition does not move them, and the joints have to be at rest.
Posture and CoM may differ, because tasks do not determine all joint angles. Where they differ, a
transition moves the robot from one posture to the other on both feet.
"""

from __future__ import annotations

import dataclasses

import numpy as np

import mgs
from mgs.com_generator.from_positions import follow_com
from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side, Support
from mgs.core.errors import InfeasibleGaitError, SeamError
from mgs.core.geometry import quintic, rotation_angles
from mgs.core.plugins import Origin
from mgs.core.scene import EMPTY
from mgs.ik_solver.tree.transition import bridge_postures
from mgs.motion import Motion
from mgs.motion.provenance import Provenance
from mgs.pipeline.assemble import assemble
from mgs.pipeline.stages import Stages
from mgs.trajectory_planner import TaskTrajectory

SOLE_TOLERANCE, COM_TOLERANCE = 2e-4, 4e-4  # [m]
TURN_TOLERANCE = 5e-4  # of a sole [rad]
JOINT_TOLERANCE = 5e-4  # [rad]
SPEED_TOLERANCE = 0.05  # of a joint that counts as at rest [rad/s]
BOTH_FEET = "let both parts begin and end on both feet"
SAME_WIDTH = "use the same step_width in both parts"
TAKE_TIME = "use a longer sequence.transition than 0, or the same CoM and hands in both parts"
SAME_POSTURE = "use the same CoM and hands in both parts where they meet"
REST = "use a longer rest at the end of the one part and at the start of the other"
LEAST_SAMPLES = 5  # least number of samples of a transition

Difference = tuple[Array, list[str], float, str, str]  # sizes, of what, tolerance, unit, remedy


def refuse_shifted_soles(before: Motion, after: Motion, part: str) -> None:
    """Raise SeamError unless both stand on the same soles, both of them on the ground."""
    for motion, sample, verb in ((before, -1, "ends"), (after, 0, "begins")):
        if motion.support[sample] != Support.DOUBLE:
            raise SeamError(part, f"one of the two {verb} on one foot", BOTH_FEET)
    sole, next_sole = before.soles_ref[-1], after.soles_ref[0]
    names = [f"the {side.label} sole" for side in Side]
    apart = np.linalg.norm(next_sole[:, :3] - sole[:, :3], axis=1)
    turned = rotation_angles(next_sole[:, 3:], sole[:, 3:])
    _refuse(
        part,
        (apart, names, SOLE_TOLERANCE, "m", SAME_WIDTH),
        (turned, names, TURN_TOLERANCE, "rad", SAME_WIDTH),
    )


def refuse_moving_joints(before: Motion, after: Motion, part: str) -> None:
    """Raise SeamError unless both are at rest at the seam."""
    names = [f"the speed of {name}" for name in before.robot.joint_names]
    steps = [np.diff(q[:, FLOATING_BASE_NQ:], axis=0) for q in (before.q[-2:], after.q[:2])]
    # not `v`, which is 0 at the ends; a part of one sample does not move
    speeds = np.abs(np.concatenate(steps)).max(axis=0, initial=0.0) / before.dt
    _refuse(part, (speeds, names, SPEED_TOLERANCE, "rad/s", REST))


def refuse_other_posture(before: Motion, after: Motion, part: str) -> None:
    """Raise SeamError unless joints and CoM agree at the seam."""
    joints = np.abs(after.q[0] - before.q[-1])[FLOATING_BASE_NQ:]
    com = np.linalg.norm(after.com_ref[:1] - before.com_ref[-1], axis=1)
    names = [f"joint {name}" for name in before.robot.joint_names]
    _refuse(
        part,
        (com, ["the CoM"], COM_TOLERANCE, "m", TAKE_TIME),
        (joints, names, JOINT_TOLERANCE, "rad", TAKE_TIME),
    )


def _refuse(part: str, *differences: Difference) -> None:
    for sizes, names, tolerance, unit, remedy in differences:
        worst = int(np.argmax(sizes))
        if not sizes[worst] <= tolerance:  # NaN is refused too
            off = f"{names[worst]} is {sizes[worst]:.3g} {unit} off, {tolerance:.3g} {unit} allowed"
            raise SeamError(part, off, remedy)


def transition(before: Motion, stages: Stages, part: str, duration: float) -> Motion:
    """The motion from the last posture of `before` to the first posture of `stages`.

    Both are seen from the same frame, and both stand on the same soles.

    Raises:
        InfeasibleGaitError: there is no way from one posture to the other on both feet.
    """
    after = stages.motion
    n = max(LEAST_SAMPLES, round(duration / after.dt)) + 1
    blend = quintic(np.arange(n) / (n - 1))[:, None]
    com = before.com[-1] + blend * (after.com[0] - before.com[-1])
    tasks = TaskTrajectory(
        dt=after.dt,
        support=np.full(n, Support.DOUBLE, np.int8),
        root=np.full(n, Side.LEFT, np.int8),
        zmp_ref=com[:, :2].copy(),
        load_left=np.full(n, 0.5),
        soles=np.tile(after.soles_ref[0], (n, 1, 1)),
        hands=np.full((n, 2, 3), np.nan),
        com_height=com[:, 2].copy(),
        torso=np.tile(after.torso_ref[0], (n, 1)),
    )
    given = follow_com(com, after.dt)
    ends = (motion.q[sample, FLOATING_BASE_NQ:] for motion, sample in ((before, -1), (after, 0)))
    try:
        joints = bridge_postures(after.robot, tasks, given, *ends)
    except InfeasibleGaitError as error:
        refusal = InfeasibleGaitError(f"{part}: on the way to its first posture: {error}")
        refusal.remedy = SAME_POSTURE
        raise refusal from error
    motion = assemble(after.robot, stages.gait, part, stages.plan, tasks, given, joints)
    return dataclasses.replace(
        motion,
        footsteps=after.footsteps[:2],
        scene=EMPTY,
        provenance=Provenance(
            Origin("bridge", "mgs", mgs.__version__), tuning={"transition": duration}
        ),
    )

"""Closed-loop IK: task errors, null-space motion, and refusal of gaits beyond its limits."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.com_generator import ComTrajectory
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError, IkError, InfeasibleGaitError, JointLimitError
from mgs.core.plugins import IK_SOLVERS
from mgs.gait import Gait, IkParameters, load_gait
from mgs.ik_solver import JointTrajectory, solve_ik
from mgs.ik_solver.clik import ClosedLoopIk, ClosedLoopReport
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.motion_planner import plan_motion
from mgs.pipeline import Stages, first_com, run_stages
from mgs.robot import Robot, build_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories
from tests.support.strategies import balance_gait, constant, figure_eight, sine, walk_gait

SHORT = {"n_steps": 2, "step_length": 0.05, "first_support": "left", "double_support": 0.5}


def inputs(robot: Robot, gait: Gait) -> tuple[TaskTrajectory, ComTrajectory]:
    tasks = plan_trajectories(plan_motion(robot, gait))
    return tasks, first_com(robot, gait, tasks)


def solve(robot: Robot, gait: Gait) -> JointTrajectory:
    return solve_ik(robot, *inputs(robot, gait), gait.ik)


def joint_hessian_cost(robot: Robot, angles: np.ndarray) -> np.ndarray:
    """H_joint of the paper at angles (..., n)."""
    middle, width = 0.5 * (robot.upper + robot.lower), robot.upper - robot.lower
    return 0.5 * np.sum(((angles - middle) / width) ** 2, axis=-1)


def gravity_cost(robot: Robot, side: Side, joints: np.ndarray) -> float:
    """1/2 tau^T tau by virtual work on the floating-base robot, with its sole held level."""
    model, data = robot.model, robot.model.createData()
    q = np.concatenate([pin.neutral(model)[:7], joints])
    pin.framesForwardKinematics(model, data, q)
    q[:7] = pin.SE3ToXYZQUAT(data.oMf[robot.sole_frames[side]].inverse())
    pin.computeJointJacobians(model, data, q)
    J = pin.getFrameJacobian(model, data, robot.sole_frames[side], pin.LOCAL)
    g = pin.computeGeneralizedGravity(model, data, q)
    tau = g[6:] - np.linalg.solve(J[:, :6], J[:, 6:]).T @ g[:6]
    return 0.5 * float(tau @ tau)


def gradient(function, x: np.ndarray, step: float = 1e-5) -> np.ndarray:
    out = np.empty(len(x))
    for j in range(len(x)):
        ahead, behind = x.copy(), x.copy()
        ahead[j] += step
        behind[j] -= step
        out[j] = (function(ahead) - function(behind)) / (2.0 * step)
    return out


# --- tasks ------------------------------------------------------------------------------------


def test_every_shipped_gait_meets_its_tasks_at_every_sample(shipped):
    """Forward kinematics of the floating-base robot against the references of stages 2 and 3.

    A gait may allow its CoM to stay behind; of a hand that is NaN nothing is asked.
    """
    robot, stages = shipped.robot, shipped.stages
    model, data, tasks = robot.model, robot.model.createData(), stages.tasks
    for k, q in enumerate(stages.motion.q):
        pin.framesForwardKinematics(model, data, q)
        com = stages.com.position[k]
        assert np.linalg.norm(pin.centerOfMass(model, data, q) - com) < shipped.gait.com_tolerance
        for side in Side:
            sole, asked = data.oMf[robot.sole_frames[side]], tasks.soles[k, side]
            assert np.linalg.norm(sole.translation - asked[:3]) < 1e-4
            turn = pin.log3(sole.rotation.T @ pin.Quaternion(asked[3:]).matrix())
            assert np.linalg.norm(turn) < np.radians(0.01)
            hand = data.oMf[robot.hand_frames[side]].translation
            if tasks.hands_asked[side]:
                assert np.linalg.norm(hand - com - tasks.hands[k, side]) < 1e-4
        if tasks.torso_asked:
            torso = data.oMf[robot.torso_frame].rotation
            turn = pin.log3(torso.T @ pin.Quaternion(tasks.torso[k]).matrix())
            assert np.linalg.norm(turn) < np.radians(0.01)


def test_no_shipped_walk_permits_a_com_error_above_a_fifth_of_a_millimetre(shipped_walk):
    assert shipped_walk.gait.com_tolerance == 2e-4
    held = shipped_walk.gait.walk.hands == "held"
    assert shipped_walk.stages.tasks.hands_asked == (held, held)


def test_every_shipped_gait_stays_within_its_joint_limits(shipped):
    angles = shipped.stages.joints.angles
    assert np.all((angles >= shipped.robot.lower) & (angles <= shipped.robot.upper))


def test_every_shipped_walk_starts_and_ends_at_rest(shipped_walk):
    angles, dt = shipped_walk.stages.joints.angles, shipped_walk.gait.dt
    stiffer = max(1.0, shipped_walk.gait.ik.gamma_joint / 0.35)  # null-space motion starts faster
    for speed in (angles[1] - angles[0], angles[-1] - angles[-2]):
        assert np.abs(speed / dt).max() < 5e-3 * stiffer  # [rad/s]; one encoder tick in a second


def test_joints_do_not_jump_where_the_support_changes(shipped_walk):
    """The tree changes its root there, which may not be visible in angles or speeds.

    Within a phase the largest change of speed from sample to sample is that of the motion itself.
    """
    angles, dt, support = (
        shipped_walk.stages.joints.angles,
        shipped_walk.gait.dt,
        shipped_walk.stages.tasks.support,
    )
    speed = np.diff(angles, axis=0) / dt
    change = np.abs(np.diff(speed, axis=0)).max(axis=1)
    assert np.abs(np.diff(angles, axis=0)).max() < 6.3 * dt  # [rad] at the servos' top speed
    # a root changes at the beginning of a double support phase
    switches = np.flatnonzero(np.diff(shipped_walk.stages.tasks.root)) + 1
    assert len(switches)
    away = np.ones(len(change), dtype=bool)
    for k in np.flatnonzero(np.diff(support)) + 1:
        away[max(k - 3, 0) : k + 2] = False
    for k in switches:
        assert change[k - 2 : k + 1].max() <= 1.5 * change[away].max()


def test_the_pose_of_the_first_sample_meets_its_tasks_before_any_motion(walk_5cm: Stages):
    motion = walk_5cm.motion
    assert np.linalg.norm(motion.com[0] - motion.com_ref[0]) < 1e-9
    assert np.linalg.norm(motion.soles[0] - motion.soles_ref[0]) < 1e-9


@pytest.mark.parametrize(
    "gains", [{}, {"gamma_joint": 0.0}, {"gamma_joint": 5.0}, {"gamma_grav": 1.6}]
)
def test_the_secondary_task_does_not_disturb_the_tasks(melson: Robot, gains: dict[str, float]):
    stages = run_stages(melson, walk_gait(**SHORT, ik=gains))
    assert np.abs(stages.motion.com - stages.motion.com_ref).max() < 2e-4
    assert np.abs(stages.motion.soles - stages.motion.soles_ref).max() < 1e-4


def test_without_newton_updates_the_feedback_alone_keeps_errors_small(melson: Robot):
    """The method of the paper is one linear step per sample; its curvature causes an error."""
    once = run_stages(melson, walk_gait(**SHORT, ik={"iterations": 0}))
    assert once.joints.report_of(ClosedLoopReport).newton_updates == 0
    error = np.linalg.norm(once.motion.com - once.motion.com_ref, axis=1)
    assert error.max() < 1e-4
    assert error[-1] < 1e-6  # at rest the feedback has removed the error
    more = run_stages(melson, walk_gait(**SHORT, ik={"iterations": 2}))
    updates = more.joints.report_of(ClosedLoopReport).newton_updates
    assert updates == 2 * len(more.joints.angles)
    assert np.abs(more.motion.com - more.motion.com_ref).max() < 1e-9


# --- balance motions --------------------------------------------------------------------------


def reached(robot: Robot, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """CoM (N, 3), hands (N, 2, 3) and soles (N, 2, 3) by forward kinematics of q (N, 7 + n)."""
    data, coms, hands, soles = robot.model.createData(), [], [], []
    for row in q:
        pin.framesForwardKinematics(robot.model, data, row)
        coms.append(pin.centerOfMass(robot.model, data, row).copy())
        hands.append([data.oMf[frame].translation.copy() for frame in robot.hand_frames])
        soles.append([data.oMf[frame].translation.copy() for frame in robot.sole_frames])
    return np.array(coms), np.array(hands), np.array(soles)


def test_a_sway_with_free_hands_moves_the_com_over_resting_soles(melson: Robot):
    stages = run_stages(melson, balance_gait(sine("com_y", 0.02)))
    com, hands, soles = reached(melson, stages.motion.q)
    times = stages.motion.times
    middle = (times >= 1.5) & (times <= 2.5)
    expected = com[0, 1] + 0.02 * np.sin(np.pi * times[middle])
    assert np.abs(com[middle, 1] - expected).max() < 2e-4
    assert np.abs(com[:, [0, 2]] - com[0, [0, 2]]).max() < 2e-4
    assert np.abs(soles - soles[0]).max() < 1e-4
    # the hands are free: their reference is their motion
    assert stages.tasks.hands_asked == (False, False)
    assert np.array_equal(stages.motion.hands_ref, stages.motion.hands[..., :3])
    assert_allclose(stages.motion.hands_ref, hands, atol=1e-9)
    assert np.array_equal(stages.motion.torso_ref, stages.motion.torso[:, 3:])


def test_with_free_hands_only_the_joints_that_the_tasks_need_move(melson: Robot):
    """A step with the same soles and CoM that also holds the hands is longer."""
    free = solve(melson, balance_gait(sine("com_y", 0.02), ik={"gamma_joint": 0.0})).angles
    still = [constant(f"{side}_hand_x", 1e-9) for side in ("left", "right")]
    held = solve(melson, balance_gait(sine("com_y", 0.02), *still, ik={"gamma_joint": 0.0})).angles
    lengths = [np.linalg.norm(np.diff(angles, axis=0), axis=1) for angles in (free, held)]
    moving = slice(60, 340)
    assert np.all(lengths[0][moving] < lengths[1][moving])


def test_one_hand_draws_a_figure_eight_while_the_other_is_free(melson: Robot):
    gait = balance_gait(figure_eight("right_hand", "yz", 0.03, 0.015), ik={"gamma_joint": 5.0})
    stages = run_stages(melson, gait)
    com, hands, _ = reached(melson, stages.motion.q)
    assert stages.tasks.hands_asked == (False, True)
    times = stages.motion.times
    middle = (times >= 1.5) & (times <= 2.5)
    moved = hands[middle, Side.RIGHT] - hands[0, Side.RIGHT]
    turn = np.pi * times[middle]
    expected = np.stack([0.0 * turn, 0.015 * np.sin(turn), 0.0075 * np.sin(2.0 * turn)], axis=1)
    assert np.linalg.norm(moved - expected, axis=1).max() < 1e-4
    assert np.linalg.norm(com - com[0], axis=1).max() < 2e-4
    # the free hand follows the joint gradient
    assert np.ptp(hands[:, Side.LEFT], axis=0).max() > 2e-3


@pytest.mark.parametrize("task", ["torso_roll", "torso_pitch", "torso_yaw"])
def test_a_gait_that_turns_the_torso_is_refused_and_able_solvers_are_named(
    melson: Robot, task: str
):
    with pytest.raises(ConfigError, match=r"ik\.solver: clik leaves the torso free") as caught:
        run_stages(melson, balance_gait(constant(task, 0.01)))
    assert caught.value.exit_code == 2
    assert "prioritized" in str(caught.value)


@pytest.mark.parametrize(
    ("channel", "task"), [(constant("com_z", 0.05), "CoM"), (constant("right_hand_x", 0.3), "hand")]
)
def test_a_balance_motion_out_of_reach_is_refused_with_the_remedy_for_balance_gaits(
    melson: Robot, channel: dict[str, object], task: str
):
    with pytest.raises(IkError) as caught:
        run_stages(melson, balance_gait(channel))
    assert task in caught.value.task
    assert 0.5 < caught.value.t < 1.5  # while the amplitude grows
    assert "smaller balance.channels" in str(caught.value)


# --- null space -------------------------------------------------------------------------------


@pytest.mark.parametrize("side", list(Side))
@pytest.mark.parametrize("gains", [(1.0, 0.0), (0.0, 1.0), (0.35, 1.6)])
def test_one_step_is_the_projected_gradient_plus_the_least_norm_correction(
    melson: Robot, side: Side, gains: tuple[float, float]
):
    """The step of the paper, with gradients by differences and J^+ by singular values.

    dq = J^+ e - dt P (gamma_joint grad H_joint + gamma_grav grad H_grav), P = I - J^+ J.

    The solver stands still on one sole for four samples; at the third the CoM moves a little.
    """
    gamma_joint, gamma_grav = gains
    tuning = IkParameters(
        gamma_joint=gamma_joint,
        gamma_grav=gamma_grav,
        gamma_grav_ramp=1e-4,
        iterations=0,
        torso="free",  # as in the paper
    )
    n, dt = 4, 0.01
    walk = inputs(melson, walk_gait(n_steps=1))[0]
    com = np.tile([0.002, 0.045 * side.sign, walk.com_height[0] - 0.005], (n, 1))
    com[2] += [1e-4, 2e-4, -1e-4]
    support = np.full(n, Support.single(side), np.int8)
    tasks = TaskTrajectory(
        dt=dt,
        support=support,
        root=np.full(n, side, np.int8),
        zmp_ref=com[:, :2],
        load_left=np.full(n, 1.0 - side),
        soles=np.tile(walk.soles[0], (n, 1, 1)),
        hands=np.tile(walk.hands[0], (n, 1, 1)),
        com_height=com[:, 2],
        torso=np.tile(walk.torso[0], (n, 1)),
    )
    flat = np.zeros_like(com)
    angles = solve_ik(melson, tasks, ComTrajectory(com, flat, flat, com[:, :2]), tuning).angles

    start = angles[1]
    tree = TreeTasks(melson, side)
    tree.place(pin.XYZQUATToSE3(tasks.soles[0, side]))
    tree.update(start[tree.order])
    J = np.empty((15, melson.n))
    J[:, tree.order] = tree.J
    error = np.empty(15)
    hands = com[2] + tasks.hands[2]
    target = np.concatenate([tasks.soles[2, side.other, :3], hands[1], hands[0], com[2]])
    error[:12] = target - tree.f
    error[12:] = pin.log3(tree.R.T)  # the soles shall be level and point ahead
    J_pinv = np.linalg.pinv(J)
    # W = s^2 I relates the gain to the robot's weight and height
    s = 0.70 / (melson.mass * com[0, 2])
    downhill = gamma_joint * gradient(lambda q: joint_hessian_cost(melson, q), start)
    downhill += gamma_grav * s**2 * gradient(lambda q: gravity_cost(melson, side, q), start)
    P = np.eye(melson.n) - J_pinv @ J
    expected = J_pinv @ error - dt * P @ downhill
    # the damping of 1e-6 (singular values down to 1e-2) and the differences leave 1e-8 of it
    assert_allclose(angles[2] - start, expected, atol=1e-6 * np.abs(expected).max() + 1e-11)
    assert np.abs(dt * P @ downhill).max() > 1e-6  # the projection has an effect


def test_the_null_space_motion_changes_tasks_only_to_second_order(melson: Robot):
    """Twice the gain multiplies the error by four, not by two."""
    errors = []
    for gamma in (2.0, 4.0):
        ik = {"gamma_joint": gamma, "iterations": 0, "torso": "free"}
        stages = run_stages(melson, walk_gait(**SHORT, lead_in=1.8, ik=ik))
        error = np.abs(stages.motion.com - stages.motion.com_ref)[30:150].max()  # at rest
        errors.append(error)
    assert errors[0] < 1e-7
    assert errors[1] < 5.0 * errors[0]


def test_the_joint_gradient_moves_joints_towards_the_middle_of_their_ranges(melson: Robot):
    costs = []
    for gamma in (0.0, 0.35, 3.0):
        angles = solve(melson, walk_gait(**SHORT, ik={"gamma_joint": gamma})).angles
        costs.append(joint_hessian_cost(melson, angles).mean())
    assert costs[0] > costs[1] > costs[2]


def test_the_gravity_gradient_lowers_the_torques_in_single_support(melson: Robot):
    costs = []
    for gamma in (0.0, 1.6):
        gait = load_gait("melson/walk_5cm", ("ik.gamma_joint=0", f"ik.gamma_grav={gamma}"))
        angles = solve(melson, gait).angles
        # the left sole carries from sample 300 to 540
        costs.append(np.mean([gravity_cost(melson, Side.LEFT, q) for q in angles[330:510:20]]))
    assert costs[1] < 0.98 * costs[0]


def test_gamma_grav_has_the_same_effect_on_a_robot_twice_as_heavy(melson: Robot):
    """W = s^2 I compensates the larger torques."""
    urdf = melson.urdf
    for value in ("mass value", "ixx", "iyy", "izz", "ixy", "ixz", "iyz"):
        parts = urdf.split(f'{value}="')
        scaled = [parts[0]]
        for part in parts[1:]:
            number, rest = part.split('"', 1)
            scaled.append(f'{2.0 * float(number)!r}"{rest}')
        urdf = f'{value}="'.join(scaled)
    heavy = build_robot(melson.yaml, urdf, "heavy")
    assert heavy.mass == pytest.approx(2.0 * melson.mass)
    gait = walk_gait(**SHORT, ik={"gamma_grav": 1.6})
    assert_allclose(solve(heavy, gait).angles, solve(melson, gait).angles, atol=1e-9)


# --- refusals ---------------------------------------------------------------------------------


@pytest.mark.parametrize("walk", [{"com_height": 0.30}, {"step_length": 0.3}, {"step_width": 0.25}])
def test_a_gait_out_of_reach_is_refused_with_the_time_and_the_task(
    melson: Robot, walk: dict[str, float]
):
    with pytest.raises(IkError) as caught:
        run_stages(melson, walk_gait(**SHORT | walk))
    error = caught.value
    assert isinstance(error, InfeasibleGaitError) and error.exit_code == 1
    assert error.task in ("swing sole", "left hand", "right hand", "CoM", "swing sole orientation")
    assert error.residual > error.tolerance
    assert 0.0 <= error.t <= 8.0
    assert f"t = {error.t:.3f} s" in str(error) and error.task in str(error)
    assert error.remedy.startswith("use ") and "walk." in error.remedy
    assert str(error).endswith(error.remedy)


def test_a_com_above_the_legs_is_refused_at_once(melson: Robot):
    with pytest.raises(IkError) as caught:
        solve(melson, walk_gait(**SHORT, com_height=0.30))
    assert caught.value.t == 0.0


LIMITED = SHORT | {"step_height": 0.2}  # too high for a knee that bends by 130 deg


def test_a_joint_beyond_its_limit_is_refused_and_named(melson: Robot):
    gait = walk_gait(**LIMITED, ik={"gamma_joint": 0.0, "on_limit": "refuse"})
    with pytest.raises(JointLimitError) as caught:
        run_stages(melson, gait)
    error = caught.value
    j = melson.joint_names.index(error.joint)
    assert not melson.lower[j] <= error.position <= melson.upper[j]
    for part in (f"t = {error.t:.3f} s", error.joint, "ik.on_limit"):
        assert part in str(error)


def test_on_request_a_joint_beyond_its_limit_is_recorded(melson: Robot):
    refused = walk_gait(**LIMITED, ik={"gamma_joint": 0.0, "on_limit": "refuse"})
    with pytest.raises(JointLimitError) as caught:
        solve(melson, refused)
    recorded = walk_gait(**LIMITED, ik={"gamma_joint": 0.0, "on_limit": "record"})
    angles = solve(melson, recorded).angles
    outside = (angles < melson.lower) | (angles > melson.upper)
    k, j = np.argwhere(outside)[0]
    assert k * recorded.dt == pytest.approx(caught.value.t)
    assert melson.joint_names[j] == caught.value.joint
    assert angles[k, j] == caught.value.position


def overshooting_gain(robot: Robot, gait: Gait) -> float:
    """Gain at which an explicit step of dt would reach the minimum of H_grav, in the first pose.

    Curvature by differences of differences, the null space by singular values.
    """
    tasks, com = inputs(robot, gait)
    q = solve_ik(robot, tasks, com, IkParameters()).angles[0]
    side = Side(tasks.root[0])

    def slope(x: np.ndarray) -> np.ndarray:
        return gradient(lambda y: gravity_cost(robot, side, y), x, step=1e-4)

    steps = 1e-4 * np.eye(robot.n)
    hessian = np.array([(slope(q + dq) - slope(q - dq)) / 2e-4 for dq in steps])
    tree = TreeTasks(robot, side)
    tree.update(q[tree.order])
    J = np.empty_like(tree.J)
    J[:, tree.order] = tree.J
    null = np.linalg.svd(J)[2][15:]
    curvature = np.linalg.eigvalsh(null @ hessian @ null.T).max()
    s = 0.70 / (robot.mass * tasks.com_height[0])
    return float(1.0 / (gait.dt * s**2 * curvature))


@pytest.mark.parametrize("gamma", [200.0, 1000.0])
def test_a_gravity_gain_that_would_overshoot_is_refused_and_the_largest_one_is_named(
    melson: Robot, gamma: float
):
    gait = walk_gait(**SHORT, ik={"gamma_grav": gamma, "gamma_joint": 0.0})
    with pytest.raises(ConfigError, match=r"ik\.gamma_grav: .* too stiff") as caught:
        solve(melson, gait)
    allowed = float(str(caught.value).split("below ")[1].split(",")[0])
    assert allowed < gamma
    assert allowed == pytest.approx(overshooting_gain(melson, gait), rel=6e-3)  # three digits
    below = {"gamma_grav": 0.99 * allowed, "on_limit": "record"}
    assert np.all(np.isfinite(solve(melson, walk_gait(**SHORT, ik=below)).angles))


def test_a_joint_gain_that_would_overshoot_is_refused_and_the_largest_one_is_named(melson: Robot):
    """An explicit step of dt gamma / range^2 >= 1 passes the middle of the tightest joint."""
    gait = walk_gait(**SHORT)
    allowed = (melson.upper - melson.lower).min() ** 2 / gait.dt
    below = {"gamma_joint": 0.99 * allowed, "on_limit": "record"}
    assert np.all(np.isfinite(solve(melson, walk_gait(**SHORT, ik=below)).angles))
    with pytest.raises(ConfigError, match=rf"ik\.gamma_joint: .* below {allowed:.3g}"):
        solve(melson, walk_gait(**SHORT, ik={"gamma_joint": 1.01 * allowed}))


# --- the rest ---------------------------------------------------------------------------------


def test_the_solution_is_the_same_bit_for_bit_twice(melson: Robot):
    gait = walk_gait(**SHORT, ik={"gamma_grav": 1.6})
    first, second = solve(melson, gait), solve(melson, gait)
    assert first.angles.tobytes() == second.angles.tobytes()
    assert first.report == second.report


def test_solving_changes_neither_robot_nor_tasks(melson: Robot):
    tasks, com = inputs(melson, walk_gait(**SHORT))
    before = [x.copy() for x in (melson.posture, tasks.soles, tasks.hands, com.position)]
    solve_ik(melson, tasks, com, IkParameters(gamma_grav=1.6))
    after = (melson.posture, tasks.soles, tasks.hands, com.position)
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))


def test_a_mirrored_walk_has_mirrored_joint_angles(melson: Robot):
    left = solve(melson, walk_gait(**SHORT, step_yaw=0.1, ik={"gamma_grav": 1.6})).angles
    mirrored = SHORT | {"first_support": "right", "step_yaw": -0.1}
    right = solve(melson, walk_gait(**mirrored, ik={"gamma_grav": 1.6})).angles
    for i, name in enumerate(melson.joint_names):
        swapped = name.replace("left", "#").replace("right", "left").replace("#", "right")
        sign = 1.0 if name.endswith("pitch") else -1.0
        # rounding, kept small by the feedback
        assert_allclose(right[:, melson.joint_names.index(swapped)], sign * left[:, i], atol=1e-8)


def test_progress_is_reported_up_to_the_last_sample(melson: Robot):
    reported: list[tuple[int, int]] = []
    gait = walk_gait(**SHORT)
    tasks, com = inputs(melson, gait)
    solve_ik(melson, tasks, com, gait.ik, lambda done, total: reported.append((done, total)))
    assert reported[-1] == (tasks.n_samples, tasks.n_samples)
    assert [done for done, _ in reported] == sorted(done for done, _ in reported)


@pytest.mark.parametrize("name", IK_SOLVERS.own)
def test_every_solver_meets_the_tasks(melson: Robot, name: str):
    gait = walk_gait(**SHORT, ik={"solver": name})
    stages = run_stages(melson, gait)
    assert np.abs(stages.motion.com - stages.motion.com_ref).max() < 2e-4
    assert np.abs(stages.motion.soles - stages.motion.soles_ref).max() < 1e-4


def test_the_settings_of_a_gait_file_reach_the_solver():
    parameters = IkParameters(
        gamma_joint=1.0,
        gamma_grav=2.0,
        gamma_grav_ramp=0.3,
        gamma_momentum=0.5,
        double_support="optimal",
        iterations=4,
        torso="hold",
        on_limit="record",
    )
    assert ClosedLoopIk.from_parameters(parameters) == ClosedLoopIk(
        gamma_joint=1.0,
        gamma_grav=2.0,
        gamma_grav_ramp=0.3,
        gamma_momentum=0.5,
        double_support="optimal",
        iterations=4,
        torso="hold",
        on_limit="record",
    )
    assert ClosedLoopIk.from_parameters(IkParameters()).on_limit == "hold"

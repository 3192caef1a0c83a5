"""IK step of placo on a motion of mgs; `run.py` starts this script in a Python with placo.

python placo_step.py ROBOT.urdf TASKS.npz REPEATS    print one JSON object

Tasks: both feet (hard), CoM and torso orientation (soft), as in the walking examples of placo. A
step sets the targets, updates the kinematics, solves and integrates, as a control loop does.
"""

from __future__ import annotations

import importlib.metadata
import json
import sys
import time
from typing import Any

import numpy as np
import placo

CHECKED_EVERY = 50  # samples between two measurements of the errors, which are not timed


def main(urdf: str, tasks_file: str, repeats: int) -> None:
    """Print the results with and without joint limits."""
    tasks = dict(np.load(tasks_file))
    figures = {
        name: [_run(urdf, tasks, joint_limits) for _ in range(repeats)]
        for name, joint_limits in (("joint limits", True), ("no limits", False))
    }
    version = importlib.metadata.version("placo")
    json.dump({"version": version, "runs": figures}, sys.stdout)


def _run(urdf: str, tasks: dict[str, Any], joint_limits: bool) -> dict[str, Any]:
    """Mean CPU time of a step [s], and the largest CoM and foot errors after a step [m]."""
    robot, solver, (left, right, com_task, torso_task) = _solver(urdf, tasks, joint_limits)
    feet, com, torso = tasks["feet"], tasks["com"], tasks["torso"]
    names, n, seconds, errors = [str(name) for name in tasks["links"][:2]], len(com), 0.0, []
    for first in range(0, n, CHECKED_EVERY):
        last = min(first + CHECKED_EVERY, n)
        start = time.process_time()
        for k in range(first, last):
            left.T_world_frame = feet[k, 0]
            right.T_world_frame = feet[k, 1]
            com_task.target_world = com[k]
            torso_task.R_world_frame = torso[k]
            robot.update_kinematics()
            solver.solve(True)
        seconds += time.process_time() - start
        robot.update_kinematics()
        gaps = [
            robot.get_T_world_frame(name)[:3, 3] - feet[last - 1, i, :3, 3]
            for i, name in enumerate(names)
        ]
        com_error = np.linalg.norm(robot.com_world() - com[last - 1])
        errors.append([com_error, np.linalg.norm(gaps, axis=1).max()])
    com_error, foot_error = np.max(errors, axis=0)
    return {
        "seconds": seconds / n,
        "com_error": float(com_error),
        "foot_error": float(foot_error),
    }


def _solver(urdf: str, tasks: dict[str, Any], joint_limits: bool) -> tuple[Any, Any, list[Any]]:
    """Robot at the start of the motion, solver, and tasks: left foot, right foot, CoM, torso."""
    robot = placo.RobotWrapper(urdf, placo.Flags.ignore_collisions)
    robot.state.q = tasks["q0"]
    robot.update_kinematics()
    solver = placo.KinematicsSolver(robot)
    solver.enable_joint_limits(joint_limits)
    solver.enable_velocity_limits(False)
    solver.dt = float(tasks["dt"])
    left, right, torso = (str(name) for name in tasks["links"])
    found = []
    for i, name in enumerate((left, right)):
        found.append(solver.add_frame_task(name, tasks["feet"][0, i]))
        found[-1].configure(name, "hard", 1.0, 1.0)
    found.append(solver.add_com_task(tasks["com"][0]))
    found[-1].configure("com", "soft", 1.0)
    found.append(solver.add_orientation_task(torso, tasks["torso"][0]))
    found[-1].configure("torso", "soft", 1.0)
    solver.add_regularization_task(1e-6)
    return robot, solver, found


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))

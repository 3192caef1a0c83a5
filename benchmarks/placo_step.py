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
    """Step times [s] along the motion, and the largest CoM and foot errors after a step [m]."""
    robot = placo.RobotWrapper(urdf, placo.Flags.ignore_collisions)
    robot.state.q = tasks["q0"]
    robot.update_kinematics()
    solver = placo.KinematicsSolver(robot)
    solver.enable_joint_limits(joint_limits)
    solver.enable_velocity_limits(False)
    solver.dt = float(tasks["dt"])
    feet, com, torso = tasks["feet"], tasks["com"], tasks["torso"]
    names = [str(name) for name in tasks["links"]]
    foot_tasks = [solver.add_frame_task(name, feet[0, i]) for i, name in enumerate(names[:2])]
    for task, name in zip(foot_tasks, names[:2], strict=True):
        task.configure(name, "hard", 1.0, 1.0)
    com_task = solver.add_com_task(com[0])
    com_task.configure("com", "soft", 1.0)
    torso_task = solver.add_orientation_task(names[2], torso[0])
    torso_task.configure("torso", "soft", 1.0)
    solver.add_regularization_task(1e-6)
    times = np.empty(len(com))
    com_error = foot_error = 0.0
    for k in range(len(com)):
        start = time.perf_counter()
        foot_tasks[0].T_world_frame = feet[k, 0]
        foot_tasks[1].T_world_frame = feet[k, 1]
        com_task.target_world = com[k]
        torso_task.R_world_frame = torso[k]
        robot.update_kinematics()
        solver.solve(True)
        times[k] = time.perf_counter() - start
        if k % 50 == 0:
            robot.update_kinematics()
            com_error = max(com_error, float(np.linalg.norm(robot.com_world() - com[k])))
            for i, name in enumerate(names[:2]):
                gap = robot.get_T_world_frame(name)[:3, 3] - feet[k, i, :3, 3]
                foot_error = max(foot_error, float(np.linalg.norm(gap)))
    return {"seconds": times.tolist(), "com_error": com_error, "foot_error": foot_error}


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))

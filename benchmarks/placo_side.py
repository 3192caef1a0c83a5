"""Comparison of the IK steps of placo and mgs, run alternately on the same motion."""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from ik_step import mean_step
from spread import spread

from mgs.core.shipped import shipped_folder
from mgs.gait import load_gait
from mgs.motion import Motion
from mgs.pipeline import run_stages
from mgs.robot import load_robot

LINKS = ("left_foot", "right_foot", "torso")
SCRIPT = Path(__file__).with_name("placo_step.py")
RUNS_IN_A_ROW = 3


def compare(python: str, gait: str, rounds: int) -> dict[str, Any]:
    """Mean CPU times of a step [s] of both, and the ratio of their fastest runs (median of rounds).

    Args:
        python: Python interpreter with the package placo.
        gait: name of a Melson gait.
        rounds: number of rounds, in which both run alternately.
    """
    stages = run_stages(load_robot("melson"), load_gait(gait, ("ik.gamma_grav=0",)))
    ours: list[list[float]] = []  # times of each round
    theirs: dict[str, list[list[float]]] = {}
    errors: list[tuple[float, float]] = []
    version = ""
    with tempfile.TemporaryDirectory() as folder:
        tasks = Path(folder) / "tasks.npz"
        write_tasks(stages.motion, tasks)
        for _ in range(rounds):
            ours.append([mean_step(stages) for _ in range(RUNS_IN_A_ROW)])
            found = _run(python, tasks)
            version = found["version"]
            for name, runs in found["runs"].items():
                theirs.setdefault(name, []).append([run["seconds"] for run in runs])
                errors += [(run["com_error"], run["foot_error"]) for run in runs]
    best = np.min(ours, axis=1)
    com_error, foot_error = np.max(errors, axis=0)
    return {
        "version": version,
        "mgs": spread(np.ravel(ours)).to_dict(),
        "placo": {name: spread(np.ravel(runs)).to_dict() for name, runs in theirs.items()},
        "ratio": {
            name: float(np.median(best / np.min(runs, axis=1))) for name, runs in theirs.items()
        },
        "com_error": float(com_error),
        "foot_error": float(foot_error),
    }


def write_tasks(motion: Motion, path: Path) -> None:
    """Write the tasks of placo: feet, CoM and torso along the joint trajectory of a motion."""
    robot, n = motion.robot, motion.n_samples
    data = robot.model.createData()
    frames = [robot.model.getBodyId(link) for link in LINKS]
    feet, torso = np.empty((n, 2, 4, 4)), np.empty((n, 3, 3))
    for k in range(n):
        pin.framesForwardKinematics(robot.model, data, motion.q[k])
        feet[k] = [data.oMf[frame].homogeneous for frame in frames[:2]]
        torso[k] = data.oMf[frames[2]].rotation
    com, q0 = motion.com, motion.q[0]
    np.savez(path, q0=q0, dt=motion.dt, feet=feet, com=com, torso=torso, links=np.array(LINKS))


def _run(python: str, tasks: Path) -> dict[str, Any]:
    urdf = shipped_folder("robots") / "melson" / "robot.urdf"
    command = [python, str(SCRIPT), str(urdf), str(tasks), str(RUNS_IN_A_ROW)]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE)
    found: dict[str, Any] = json.loads(done.stdout)
    return found

"""Trainers' own loaders, run in an interpreter that has them.

They need torch or JAX and hundreds of megabytes, so they are not installed with mgs. To run their
tests, install mjlab, holosoma, LeRobot or LocoMuJoCo (each in an environment of its own if need be)
and name the interpreters:

    MGS_CONSUMERS=/opt/mjlab/bin/python:/opt/loco/bin/python pytest tests/motion_file/formats
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

# What each one does with the path in `file`; arrays that it puts in `out` are given back.
SCRIPTS = {
    "mjlab": """
from mjlab.tasks.tracking.mdp.commands import MotionLoader
motion = MotionLoader(file, torch.arange(int(arguments[0])))
for name in ("joint_pos", "joint_vel", "body_pos_w", "body_quat_w", "body_lin_vel_w"):
    out[name] = getattr(motion, name).numpy()
out["body_ang_vel_w"] = motion.body_ang_vel_w.numpy()
""",
    "holosoma": """
from holosoma.managers.command.terms.wbt import MotionLoader
bodies, joints = arguments[0].split(","), arguments[1].split(",")
motion = MotionLoader(file, bodies, joints)
for name in ("joint_pos", "joint_vel", "body_pos_w", "body_quat_w", "body_lin_vel_w"):
    out[name] = getattr(motion, name).numpy()
out["body_ang_vel_w"] = motion.body_ang_vel_w.numpy()
""",
    "loco_mujoco": """
from loco_mujoco.trajectory import Trajectory
trajectory = Trajectory.load(file, backend=np)
out["qpos"], out["qvel"] = trajectory.data.qpos, trajectory.data.qvel
out["split_points"] = trajectory.data.split_points
out["frequency"] = trajectory.info.frequency
out["joint_names"] = np.array(trajectory.info.joint_names)
indexes = trajectory.info.joint_name2ind_qpos
out["index"] = np.concatenate([indexes[name] for name in trajectory.info.joint_names])
""",
    "lerobot": """
from lerobot.datasets.lerobot_dataset import LeRobotDataset
data = LeRobotDataset("mgs/motion", root=file)
frames = [data[k] for k in range(len(data))]
out["action"] = np.stack([frame["action"].numpy() for frame in frames])
out["timestamp"] = np.array([float(frame["timestamp"]) for frame in frames])
out["names"] = np.array(data.meta.features["action"]["names"])
out["fps"], out["task"] = np.array(data.fps), np.array(frames[0]["task"])
out["mean"] = data.meta.stats["action"]["mean"]
""",
}
BEFORE = """
import sys, warnings
import numpy as np
try:
    import torch
except ModuleNotFoundError:
    pass
warnings.simplefilter("ignore")
file, target, *arguments = sys.argv[1:]
out = {}
"""


@functools.cache
def interpreter(library: str) -> str | None:
    """Interpreter that has a library; None if none has."""
    named = [name for name in os.environ.get("MGS_CONSUMERS", "").split(os.pathsep) if name]
    find = f"import importlib.util as u, sys; sys.exit(u.find_spec({library!r}) is None)"
    for python in [sys.executable, *named]:
        if subprocess.run([python, "-c", find], check=False, capture_output=True).returncode == 0:
            return python
    return None


def loaded_by(library: str, file: Path, *arguments: str) -> dict[str, np.ndarray]:
    """Arrays that a trainer's own loader makes of a file; skips the test if it is not installed."""
    python = interpreter(library)
    if python is None:
        pytest.skip(f"{library} is not installed; see tests/support/consumers.py")
    target = file.parent / "loaded.npz"
    script = BEFORE + SCRIPTS[library] + "np.savez(target, **out)\n"
    command = [python, "-c", script, str(file), str(target), *arguments]
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    environment |= {"HF_HUB_OFFLINE": "1", "CUDA_VISIBLE_DEVICES": "", "HF_HOME": str(file.parent)}
    run = subprocess.run(
        command, capture_output=True, text=True, env=environment, timeout=600, cwd=file.parent,
        check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr[-3000:]
    with np.load(target) as found:
        return dict(found)

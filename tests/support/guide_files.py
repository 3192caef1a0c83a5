"""The files that commands in the documentation name, made when a command needs them.

A guide says `mgs audit dance.csv --robot robots/g1`; here `dance.csv` is the walk of a biped of the
test data, written as a CSV, and `robots/g1` is the folder of that biped.
"""

from __future__ import annotations

import contextlib
import itertools
import shutil
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from mgs.robot import load_robot
from tests.support.bus_robots import motors_of_melson
from tests.support.dynamixel_bus import Setting, simulated_bus
from tests.support.mjcf_biped import CUBE, mjcf
from tests.support.page_commands import ROOT, environment

ONE_UNIT = """mgs: 1
unit: number 7
robot: melson
joints:
  left_knee_pitch: {zero_offset: 0.012, backlash: 0.009, stiffness: 31.0}
"""
SPEEDS = """mgs: 1
base: melson/walk_practical
axes:
  vx: [0.03, 0.05]
  vy: [0.0]
  wz: [0.0]
"""
LITTLE_LIBRARY = "mgs batch run speeds.yaml -o outputs/speeds --workers 1 --physics mujoco"
MADE_BY = {  # shell commands, in a folder that has robots/melson7, the URDF and the texts below
    "walk.mcap": "mgs generate melson/walk_practical --robot robots/melson7 -o walk.mcap",
    "squat.mcap": "mgs generate melson/squat --robot robots/melson7 -o squat.mcap",
    "squat.csv": "mgs replay squat.mcap --engine mujoco --record log.mcap"
    " && mgs export log.mcap -o squat.csv",
    "bag_folder": "mgs export squat.mcap --format rosbag2 -o bag_folder",
    "slow.mcap": "mgs generate melson/walk_5cm --set walk.n_steps=2 -o slow.mcap",
    "fast.mcap": "mgs generate melson/walk_practical --set walk.n_steps=2 -o fast.mcap",
    "my_walk.yaml": "mgs gait show melson/walk_practical > my_walk.yaml",
    "robots/mine": "mgs robot init some.urdf -o robots/mine",
    "robots/g1": "mgs robot init some.urdf -o robots/g1",
    "dance.csv": "mgs generate walk --robot robots/g1 -o g1.mcap"
    " && mgs export g1.mcap --format unitree-csv --fps 30 -o dance.csv",
    "walk.npz": "mgs export walk.mcap --format mjlab -o walk.npz",
    "walk.csv": "mgs export walk.mcap --format unitree-csv --fps 50 -o walk.csv",
    "outputs/speeds": LITTLE_LIBRARY,
}
NEEDED_FIRST = {  # files that the commands above name
    "squat.csv": ["squat.mcap"],
    "bag_folder": ["squat.mcap"],
    "walk.npz": ["walk.mcap"],
    "walk.csv": ["walk.mcap"],
    "dance.csv": ["robots/g1"],
}
PORTS = ("/dev/ttyUSB0", "COM3")
TIMEOUT = 900  # [s]


@dataclass
class GuideFolder:
    """A reader's folder."""

    path: Path
    port: str = ""  # of the simulated servos
    _open: contextlib.ExitStack = field(default_factory=contextlib.ExitStack)

    def __post_init__(self) -> None:
        self.path.mkdir()
        shutil.copy(ROOT / "docs" / "tutorials" / "pico.urdf", self.path / "some.urdf")
        robot = shutil.copytree(ROOT / "robots" / "melson", self.path / "robots" / "melson7")
        joints = load_robot("melson")
        motors = ["motors:"] + [
            f"  {name}: {{id: {motor.id}, model: XM430, sign: {motor.sign}}}"
            for name, motor in motors_of_melson(joints).items()
        ]
        with (robot / "robot.yaml").open("a", encoding="utf-8") as file:
            file.write("\n" + "\n".join(motors) + "\n")
        texts = {
            "motors.yaml": "\n".join(["mgs: 1", *motors, ""]),
            "my_joints.txt": "\n".join(joints.joint_names[:12]) + "\n",
            "number7.yaml": ONE_UNIT,
            "number_7.yaml": ONE_UNIT,
            "speeds.yaml": SPEEDS,
            "some.xml": mjcf(),
            "foot.obj": CUBE,
        }
        for name, text in texts.items():
            (self.path / name).write_text(text, encoding="utf-8")

    def close(self) -> None:
        """End the simulated servos."""
        self._open.close()

    def run(self, command: str) -> subprocess.CompletedProcess[str]:
        """Run a command of a page, after what it needs has been made."""
        words = command.split()
        written = {word for flag, word in itertools.pairwise(words) if flag in WRITES}
        for word in words:
            if word not in written:
                self.make(word)
        for port in PORTS:
            if port in words:
                command = command.replace(port, self._servos()) + " --yes --lost-after 500"
        return self._shell(command)

    def make(self, name: str) -> None:
        """Make a file that commands name, unless it is there."""
        if name not in MADE_BY or (self.path / name).exists():
            return
        for needed in NEEDED_FIRST.get(name, []):
            self.make(needed)
        done = self._shell(MADE_BY[name])
        assert (self.path / name).exists(), f"{MADE_BY[name]}\n{done.stdout}{done.stderr}"

    def _servos(self) -> str:
        if not self.port:
            setting = Setting(servos=tuple(range(1, 20)))
            folder = self.path.parent
            self.port = self._open.enter_context(simulated_bus(folder, setting)).port
        return self.port

    def _shell(self, command: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ["bash", "-c", command], cwd=self.path, env=environment(self.path.parent),
            capture_output=True, text=True, timeout=TIMEOUT, check=False,
        )  # fmt: skip


WRITES = ("-o", "--log", "--record", "--sweep-plot", "--animate", "--strip", "--plot")

"""Write every shipped gait in every format, read it back, and print the worst errors.

    python benchmarks/exports.py                                   about a quarter of an hour
    python benchmarks/exports.py --gaits melson/kick --formats mjlab beyondmimic

Gaits that name no robot are made for each robot that ships. Robots without motors in robot.yaml get
one per joint, with the ids 1, 2 ... An angle counts as wrong where it differs from what was
exported by more than the resolution that the format states. Exit code 1 if one does.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import MgsError
from mgs.core.geometry import rotation_angles
from mgs.gait import list_gaits, load_gait
from mgs.motion import Motion
from mgs.motion.link_motion import link_motion
from mgs.motion_file.export import Exported, export_motion
from mgs.motion_file.formats import FORMATS, Format, RecordedMotion
from mgs.pipeline import generate
from mgs.robot import MotorSpec, Robot, list_robots, load_robot
from mgs.robot.motor_models import MotorName

MOTORS: dict[str, MotorName] = {"feetech": "STS3215", "feetech-sync": "STS3215"}
OTHERS: MotorName = "MX-28"
UNITS = {"angle": "rad", "base": "m", "turn": "rad", "link": "m", "speed": "of the largest"}


@dataclass
class Result:
    """What became of one format over all gaits."""

    read: int = 0
    refused: dict[str, int] = field(default_factory=dict)  # by reason
    wrong: list[str] = field(default_factory=list)
    worst: dict[str, float] = field(default_factory=dict)  # by quantity

    def see(self, quantity: str, errors: Array) -> float:
        """Keep the worst of some errors."""
        error = float(np.abs(errors).max())
        self.worst[quantity] = max(self.worst.get(quantity, 0.0), error)
        return error


def motions(wanted: list[str]) -> Iterator[tuple[str, Motion]]:
    """Every gait on its robot, or on every robot."""
    for name in wanted or list_gaits():
        gait = load_gait(name)
        for robot in [gait.robot] if gait.robot else list_robots():
            title = name if gait.robot else f"{name} of {robot}"
            try:
                yield title, generate(load_robot(robot), gait, name).motion
            except MgsError as error:  # a robot without arms does not wave
                print(f"{title}: not possible: {error}", file=sys.stderr)


def with_motors(fmt: Format, robot: Robot) -> Robot:
    """The robot, with motors, one per joint, if it has none."""
    if robot.spec.motors:
        return robot
    model = MOTORS.get(fmt.name, OTHERS)
    motors = {name: MotorSpec(id=k + 1, model=model) for k, name in enumerate(robot.joint_names)}
    return dataclasses.replace(robot, spec=robot.spec.model_copy(update={"motors": motors}))


def compare(result: Result, title: str, exported: Exported, recorded: RecordedMotion) -> None:
    """Errors of one export."""
    sampled, robot = exported.sampled, exported.sampled.robot
    names = recorded.joint_names or exported.written.joints
    index = [robot.joint_names.index(name) for name in names]
    if len(recorded.joints) != sampled.n_frames:
        result.wrong.append(f"{title}: {len(recorded.joints)} of {sampled.n_frames} frames")
        return
    error = result.see("angle", recorded.joints - sampled.joints[:, index])
    if error > exported.format.resolution:
        result.wrong.append(f"{title}: an angle is off by {error:.3g} rad")
    if recorded.joint_velocity is not None:
        expected = sampled.joint_velocity[:, index]
        result.see("speed", relative(recorded.joint_velocity, expected))
    if recorded.base_position is not None and recorded.base_quat_xyzw is not None:
        result.see("base", recorded.base_position - sampled.base_position)
        turns = rotation_angles(recorded.base_quat_xyzw, sampled.base_quat_xyzw)
        result.see("turn", turns)
    if recorded.links is not None:
        order = recorded.order or "depth-first"
        links = link_motion(sampled, order)
        result.see("link", recorded.links.position - links.position)
        if recorded.links.velocity is not None:
            origin = recorded.links.velocity_of == "origin"
            expected = links.velocity if origin else links.com_velocity
            result.see("speed", relative(recorded.links.velocity, expected))


def relative(found: Array, expected: Array) -> Array:
    """Errors of velocities as parts of the largest one."""
    return np.asarray((found - expected) / max(float(np.abs(expected).max()), 1e-3))


def try_format(result: Result, fmt: Format, title: str, motion: Motion, folder: Path) -> None:
    """Write and read one motion in one format."""
    path = folder / f"{fmt.name}{fmt.suffix}"
    try:
        motion = dataclasses.replace(motion, robot=with_motors(fmt, motion.robot))
        exported = export_motion(motion, path, fmt.name, force=True)
    except MgsError as error:
        reason = str(error).partition("\n")[0]
        if "cannot be written" in reason:
            result.wrong.append(f"{title}: {reason}")
        result.refused[reason] = result.refused.get(reason, 0) + 1
        return
    if not fmt.readable:
        result.read += 1
        return
    compare(result, title, exported, fmt.read(path, motion.robot))
    result.read += 1


def table(results: dict[str, Result]) -> str:
    """Worst errors as a table in Markdown."""
    lines = [
        "| format | read back | angle [rad] | resolution [rad] | base [m] | base [rad] | link [m] "
        "| velocity [of the largest] |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for name, result in results.items():
        total = result.read + sum(result.refused.values())
        cells = [f"`{name}`", f"{result.read} of {total}"]
        for quantity in UNITS:
            value = result.worst.get(quantity)
            cells.append("" if value is None else "0" if value == 0.0 else f"{value:.1e}")
            if quantity == "angle":
                limit = FORMATS[name].resolution
                cells.append("0" if limit == 0.0 else f"{limit:.1e}")
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> int:
    """Run the command and return its exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--gaits", nargs="*", default=[], help="names of gaits; default: all")
    parser.add_argument("--formats", nargs="*", default=list(FORMATS), choices=list(FORMATS))
    arguments = parser.parse_args()
    results = {name: Result() for name in arguments.formats}
    count, started = 0, time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for title, motion in motions(arguments.gaits):
            count += 1
            for name, result in results.items():
                try_format(result, FORMATS[name], title, motion, Path(folder))
            print(f"{time.monotonic() - started:6.0f} s  {title}", file=sys.stderr, flush=True)
    print(table(results))
    print(f"\n{count} motions")
    for name, result in results.items():
        for reason, number in result.refused.items():
            print(f"{name}: {number} refused, such as: {reason[:160]}")
        for line in result.wrong:
            print(f"{name}: {line}")
    return 1 if any(result.wrong for result in results.values()) else 0


if __name__ == "__main__":
    sys.exit(main())

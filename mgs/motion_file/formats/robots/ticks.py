"""Tables of goal positions in ticks of the motors on a bus, which state their own scale."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from mgs.core.errors import ConfigError
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.number_table import number_table, opened_text
from mgs.motion_file.formats.plain.csv_table import rate_of
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.robot import Motors
from mgs.robot.motor_models import Maker

DIGITS = 9  # of a sample time
ROWS = ("id", "at_zero", "ticks_per_rad")  # of figures of the motors, above the head line


def motors_for(sampled: SampledMotion, options: Options, maker: Maker) -> Motors:
    """Motors of the joints that are written, in their order.

    Raises:
        ConfigError: a joint has no motor, or one of another maker.
    """
    names, _ = chosen_joints(sampled.robot, options, None)
    motors = options.motors_of(sampled.robot, names)
    for name, register in zip(names, motors.registers, strict=True):
        if register is not None and register.maker != maker:
            raise ConfigError(
                options.motors_source(sampled.robot),
                f"motors.{name}: a motor of {register.maker}; use the format {register.maker}",
            )
    return motors


def write_ticks(sampled: SampledMotion, path: Path, options: Options, maker: Maker) -> Written:
    """Write the table; see mgs.motion_file.formats.robots.dynamixel for its layout."""
    motors = motors_for(sampled, options, maker)
    names, index = chosen_joints(sampled.robot, options, None)
    ticks = motors.to_ticks(sampled.joints[:, index])
    figures = (motors.ids, motors.at_zero.tolist(), motors.ticks_per_rad.tolist())
    with path.open("w", encoding="utf-8", newline="") as stream:
        stream.write(
            "# goal positions [ticks]; joint angle [rad] = (tick - at_zero) / ticks_per_rad\n"
        )
        for line in options.remarks:
            stream.write(f"# {line}\n")
        for title, values in zip(ROWS, figures, strict=True):
            stream.write(f"# {title},{','.join(map(str, values))}\n")
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["time", *names])
        times = np.round(sampled.times, DIGITS).tolist()
        writer.writerows([t, *row] for t, row in zip(times, ticks.tolist(), strict=True))
    return Written(names)


def read_ticks(path: Path, layout: str) -> RecordedMotion:
    """Motion of a table of ticks.

    Raises:
        ConfigError, MotionFileError: it is missing, damaged or states no scale.
    """
    reading, figures = Reading(path), {}
    with opened_text(path) as stream:
        place, line = stream.tell(), stream.readline()
        while line.startswith("#"):
            title, _, values = line[1:].strip().partition(",")
            if title in ROWS:
                figures[title] = _numbers(reading, title, values)
            place, line = stream.tell(), stream.readline()
        stream.seek(place)
        head, table = number_table(reading, stream, head=True)
    if head[:1] != ["time"] or len(head) < 2:
        raise reading.error("the first column should be time, the others motors")
    names = reading.names("the list of joints", head[1:])
    at_zero, per_rad = (
        reading.array(title, figures.get(title), len(names))
        for title in ("at_zero", "ticks_per_rad")
    )
    if not per_rad.all():
        raise reading.error("ticks_per_rad is 0 for a motor")
    return RecordedMotion(
        layout=layout,
        fps=rate_of(reading, table[:, 0]),
        joint_names=names,
        order=None,
        joints=(table[:, 1:] - at_zero) / per_rad,
        extra={"ids": reading.array("id", figures.get("id"), len(names)).astype(int).tolist()},
    )


def _numbers(reading: Reading, title: str, values: str) -> np.ndarray:
    try:
        return np.array([float(cell) for cell in values.split(",")])
    except ValueError as error:
        raise reading.error(f"{title} should be numbers with commas between them") from error

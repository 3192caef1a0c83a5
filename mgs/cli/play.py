"""The command mgs play."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mgs.cli import play_text
from mgs.cli.common import (
    FiniteRange,
    force_option,
    json_option,
    motion_argument,
    say,
)
from mgs.cli.play_text import Plan
from mgs.cli.stop_wish import stop_wish

if TYPE_CHECKING:
    from mgs.robot.hardware.session import Result, Situation, Wish


@click.command()
@motion_argument
@click.option("--port", metavar="DEV", help="Serial port, such as /dev/ttyUSB0 or COM3.")
@click.option(
    "--protocol", type=click.Choice(["1", "2"]),
    help="Dynamixel protocol, 1.0 or 2.0. Default: that of the motors in robot.yaml.",
)  # fmt: skip
@click.option(
    "--baud", type=click.IntRange(9600, 4_000_000), default=1_000_000, show_default=True,
    help="Speed of the line [bit/s].",
)  # fmt: skip
@click.option(
    "--rate", type=FiniteRange(1.0, 1000.0), default=100.0, show_default=True,
    help="Goals per second [Hz]; the motion is resampled to it.",
)  # fmt: skip
@click.option(
    "--goals", "kind", type=click.Choice(["commanded", "planned"]),
    help="Joint angles to send: planned ones, or commanded ones, which compensate the droop of the "
    "servos under load. Default: commanded if robot.yaml gives the stiffness of all servos.",
)  # fmt: skip
@click.option(
    "--unit", "unit_file", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path),
    help="YAML file with the corrections of this physical robot; mgs compare writes it.",
)  # fmt: skip
@click.option(
    "--motors", "motors_file", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path),
    help="YAML file with the motors, in place of those in the robot.yaml of the motion.",
)  # fmt: skip
@click.option(
    "--near", "near_deg", metavar="DEG", type=FiniteRange(0.1, 90.0), default=3.0,
    show_default=True,
    help="Distance of a joint from its first goal up to which the motion begins at once [deg].",
)  # fmt: skip
@click.option(
    "--approach", "approach_deg", metavar="DEG/S", type=FiniteRange(0.1, 360.0), default=30.0,
    show_default=True,
    help="Largest speed of a joint on the way to the first posture [deg/s].",
)  # fmt: skip
@click.option(
    "--no-approach", is_flag=True, help="Refuse to play unless the robot is in its first posture."
)
@click.option(
    "--lost-after", type=click.IntRange(2, 1000), default=8, show_default=True,
    help="Questions in a row that a servo leaves without an answer before the motion is stopped.",
)  # fmt: skip
@click.option(
    "--max-load", type=click.IntRange(1, 32767),
    help="Load at which the motion is stopped, in the unit of the servos: 1/1023 or 1/1000 of the "
    "largest torque, or steps of the current. Default: none; errors of servos always stop it.",
)  # fmt: skip
@click.option(
    "--on-stop", type=click.Choice(["hold", "off"]), default="hold", show_default=True,
    help="What servos do when the motion is stopped: hold their posture, or lose their torque.",
)  # fmt: skip
@click.option(
    "--at-end", type=click.Choice(["hold", "off"]), default="hold", show_default=True,
    help="What servos do after the last goal: hold their posture, or lose their torque.",
)  # fmt: skip
@click.option(
    "--log", "log_file", metavar="FILE.csv", type=click.Path(dir_okay=False, path_type=Path),
    help="CSV file for the measured joint angles, which mgs compare reads. Default: none.",
)  # fmt: skip
@click.option("--yes", is_flag=True, help="Move without asking first.")
@click.option(
    "--dry-run", is_flag=True, help="Print what would be sent; needs no port and moves nothing."
)
@force_option
@json_option
@click.pass_context
def play(ctx: click.Context, /, file: Path, as_json: bool, **options: Any) -> None:
    """Stream a motion to Dynamixel servos.

    Reads FILE.mcap. Servos are looked at first: all have to answer, in a mode with goal positions
    and without errors. If the posture is not the first one of the motion, the robot goes there
    slowly. Then all goals go out at a fixed rate, and the jitter is measured. Any key stops the
    robot, and so does a servo that is silent, reports an error or has too much load.

    A robot that falls or hits something is dangerous: hang it up or hold it, and have the switch of
    its power at hand. docs/play.md has the safety rules.

    Exit code 0 if all goals were sent, 1 if the motion was stopped or the robot was not ready, 2 if
    the port cannot be opened or the input is malformed.

    \b
    Examples:
      mgs play walk.mcap --dry-run
      mgs play walk.mcap --port /dev/ttyUSB0 --rate 125 --log walk.csv
      mgs play walk.mcap --port COM3 --unit number7.yaml --on-stop off
    """  # noqa: D301
    plan = _plan(file, **options)
    if options["dry_run"]:
        play_text.print_dry_run(plan, as_json)
        return
    ctx.exit(_play(plan, as_json, options))


def _plan(
    file: Path,
    rate: float,
    kind: Any,
    unit_file: Path | None,
    motors_file: Path | None,
    log_file: Path | None,
    force: bool,
    **_: Any,
) -> Plan:
    from mgs.core.atomic_files import refuse_taken
    from mgs.motion.goals import goals_along
    from mgs.motion_file import read_motion
    from mgs.robot.motors import motors_of, read_motors
    from mgs.robot.unit import load_unit

    if log_file is not None:
        refuse_taken(log_file, force)
    motion = read_motion(file)
    robot = motion.robot
    specs = robot.spec.motors if motors_file is None else read_motors(motors_file)
    motors = motors_of(specs, robot.joint_names, motors_file or robot.source)
    unit = None if unit_file is None else load_unit(unit_file, robot)
    goals = goals_along(motion, rate, kind, unit)
    return Plan(file, motors, goals, motors.to_ticks(goals.position))


def _play(plan: Plan, as_json: bool, options: dict[str, Any]) -> int:
    """Play on the port; the exit code."""
    from mgs.core.errors import ConfigError
    from mgs.robot.hardware.bus import Bus
    from mgs.robot.hardware.session import look_around, perform

    if options["port"] is None:
        raise ConfigError("--port", "name the serial port of the servos, or use --dry-run")
    protocol = _protocol(plan, options["protocol"])
    wish = _wish(plan, options)
    with Bus(options["port"], options["baud"], protocol) as bus:
        situation = look_around(bus, plan.motors.ids, plan.ticks, wish)
        _refuse_other_servos(plan, situation)
        text = play_text.situation_words(plan, situation, options)
        say(text, err=as_json)
        if not options["yes"] and not click.confirm("Go on?", err=as_json):
            say("nothing was sent to the servos", err=as_json)
            return 1
        say("any key stops the robot", err=as_json)
        with stop_wish() as stop:
            result = perform(bus, situation, plan.ticks, wish, stop)
    if options["log_file"] is not None and result.motion is not None:
        _write_log(plan, situation, result, options["log_file"], options["force"])
    play_text.report(plan, result, situation, as_json)
    return 0 if result.stopped is None else 1


def _protocol(plan: Plan, wanted: str | None) -> int:
    """Protocol of the motors; refuses motors of another maker or of several protocols."""
    from mgs.core.errors import ConfigError

    known = {register for register in plan.motors.registers if register is not None}
    if others := sorted({r.maker for r in known} - {"dynamixel"}):
        raise ConfigError(
            "motors", f"mgs play speaks to Dynamixel servos, and not to those of {others[0]}"
        )
    protocols = sorted({register.protocol for register in known})
    if wanted is not None:
        if protocols not in ([], [int(wanted)]):
            raise ConfigError("--protocol", f"the motors have protocol {protocols[0]}.0")
        return int(wanted)
    if len(protocols) != 1:
        raise ConfigError(
            "motors",
            "they have both protocols, and one line has one; give each motor of a line the same"
            if protocols
            else "they name no model; add --protocol 1 or --protocol 2",
        )
    return protocols[0]


def _refuse_other_servos(plan: Plan, situation: Situation) -> None:
    """Raise ConfigError if servos on the line are not of the series that the motors say."""
    from mgs.core.errors import ConfigError

    table = situation.line.table
    for name, register in zip(plan.motors.joint_names, plan.motors.registers, strict=True):
        if register is not None and register.address != table.goal.address:
            raise ConfigError(
                "motors",
                f"the goal of {name} is at address {register.address}, but servos on the line have "
                f"the control table of {table.name}, with the goal at {table.goal.address}; "
                "correct the model of the motors",
            )


def _wish(plan: Plan, options: dict[str, Any]) -> Wish:
    import numpy as np

    from mgs.robot.hardware.session import Wish
    from mgs.robot.hardware.watch import StopAt

    per_deg = np.radians(1.0) / plan.motors.resolution
    return Wish(
        rate=plan.goals.rate,
        near=options["near_deg"] * per_deg,
        approach=None if options["no_approach"] else options["approach_deg"] * per_deg,
        stop_at=StopAt(lost_after=options["lost_after"], max_load=options["max_load"]),
        off_when_stopped=options["on_stop"] == "off",
        off_at_end=options["at_end"] == "off",
    )


def _write_log(plan: Plan, situation: Situation, result: Result, path: Path, force: bool) -> None:
    import numpy as np

    from mgs.motion_file.joint_log import write_joint_log
    from mgs.robot.hardware.session import measured

    assert result.motion is not None
    times, ticks = measured(result.motion, situation.line)
    angles = (ticks - plan.motors.at_zero) / plan.motors.ticks_per_rad
    last_sent = np.clip((times * plan.goals.rate).astype(np.intp), 0, len(plan.ticks) - 1)
    told = plan.motors.to_angles(plan.ticks[last_sent])
    write_joint_log(path, plan.motors.joint_names, times, angles, told, force=force)

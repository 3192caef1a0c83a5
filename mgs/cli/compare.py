"""The command mgs compare."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mgs.cli.common import (
    FiniteFloat,
    force_option,
    json_option,
    motion_argument,
    print_json,
    say,
)
from mgs.core.short_text import clipped

if TYPE_CHECKING:
    from mgs.judge.logged.comparison import Comparison, JointComparison
    from mgs.motion_file.joint_log import JointLog


@click.command()
@motion_argument
@click.argument("log", metavar="LOG", type=click.Path(exists=True, path_type=Path))
@click.option(
    "--goals", "kind", type=click.Choice(["commanded", "planned"]),
    help="Joint angles that were sent to the servos. Default: commanded if robot.yaml gives the "
    "stiffness of all servos, as mgs play does.",
)  # fmt: skip
@click.option(
    "--unit", "unit_file", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path),
    help="YAML file with the corrections that were applied when the motion was played.",
)  # fmt: skip
@click.option(
    "--start", type=FiniteFloat(), metavar="S",
    help="Time on the clock of the log when the motion began [s]. Default: found by correlation.",
)  # fmt: skip
@click.option("--topic", help="Topic of the joint states in an MCAP file or a bag.")
@click.option("--degrees", is_flag=True, help="Angles in the log are in degrees.")
@click.option(
    "--hung", is_flag=True,
    help="The robot was hung up, its feet free, so that its legs did not carry it.",
)  # fmt: skip
@click.option(
    "-o", "--output", metavar="FILE.yaml", type=click.Path(dir_okay=False, path_type=Path),
    help="YAML file for the corrections of this physical robot. Default: none.",
)  # fmt: skip
@click.option("--name", default="unnamed", show_default=True, help="Name of the physical robot.")
@click.option(
    "--plot", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path),
    help="PNG or SVG file for a figure of the joint errors. Default: none.",
)  # fmt: skip
@force_option
@json_option
def compare(
    file: Path,
    log: Path,
    kind: Any,
    unit_file: Path | None,
    start: float | None,
    topic: str | None,
    degrees: bool,
    hung: bool,
    output: Path | None,
    name: str,
    plot: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    """Compare a motion with a log of the joints of a robot that executed it.

    Reads FILE.mcap and LOG: a CSV file (columns time and position.JOINT [rad], as mgs play writes
    it), an MCAP file or the folder of a ROS 2 bag with messages sensor_msgs/JointState. Prints for
    each joint its delay, the offset of its zero, the play of its gear, its stiffness, and the joint
    error before and after these are taken into account. Finds the start of the motion in the log
    and refuses a log in which it is ambiguous. Exit code 1 if the log cannot be compared, 2 if it
    cannot be read.

    \b
    Examples:
      mgs compare squat.mcap squat.csv
      mgs compare squat.mcap bag_folder --hung -o number7.yaml --name "number 7"
      mgs compare squat.mcap squat.csv --plot errors.png --json
    """  # noqa: D301
    from mgs.core.atomic_files import refuse_taken
    from mgs.core.errors import ConfigError
    from mgs.judge.logged.comparison import compare_log, unit_spec
    from mgs.motion_file import read_motion
    from mgs.motion_file.joint_log_ros import read_joint_log
    from mgs.robot.unit import load_unit, write_unit

    if not 1 <= len(name) <= 100:
        raise ConfigError("--name", "give the physical robot a name of 1 to 100 characters")
    if plot is not None and plot.suffix not in (".png", ".svg"):
        raise ConfigError("--plot", f"{plot}: the name should end in .png or .svg")
    for path in (output, plot):
        if path is not None:
            refuse_taken(path, force)
    motion = read_motion(file)
    unit = None if unit_file is None else load_unit(unit_file, motion.robot)
    read = read_joint_log(log, topic)
    comparison = compare_log(
        motion, _in_radians(read) if degrees else read, kind=kind, unit=unit, start=start, hung=hung
    )
    if output is not None:
        source = f"{log.name} against {file.name}, {len(comparison.joints)} joints"
        write_unit(unit_spec(comparison, motion, name, source), output, force=force)
    if plot is not None:
        _draw(comparison, f"{file.name} against {log.name}", plot)
    if as_json:
        print_json({"file": str(file), "log": str(log), **comparison.to_dict()})
    else:
        _print(comparison)


def _in_radians(log: JointLog) -> JointLog:
    import numpy as np

    command = None if log.command is None else np.radians(log.command)
    return dataclasses.replace(log, position=np.radians(log.position), command=command)


def _draw(comparison: Comparison, title: str, path: Path) -> None:
    from mgs.report import save_figures
    from mgs.report.logged import plot_comparison

    fmt: Any = path.suffix[1:]
    save_figures({path.stem: plot_comparison(comparison, title)}, path.parent, fmt, force=True)


def _print(comparison: Comparison) -> None:
    import numpy as np

    told = "" if comparison.unit is None else f", corrected for {clipped(comparison.unit, 40)}"
    found = comparison.found
    if found is None:
        begins = f"the motion begins at {comparison.start:.3f} s of the log"
    else:
        begins = (
            f"the motion begins at {comparison.start:.3f} s of the log (found by correlation: "
            f"agreement {found.agreement:.3f}, next best start {found.rival:.3f}); delays are "
            "relative to the median joint"
        )
    say(f"{begins}\njoints were told the {comparison.goals} angles{told}")
    width = max(len("joint"), *(len(joint.name) for joint in comparison.joints))
    say(
        f"{'joint':<{width}}  delay   zero   play   stiffness (described)   RMS error [deg]\n"
        f"{'':<{width}}     ms    deg    deg         N m/rad              before   after"
    )
    for joint in comparison.joints:
        say(f"{joint.name:<{width}} {_row(joint)}")
    before, after = (
        np.degrees(comparison.rms(errors)) for errors in (comparison.before, comparison.after)
    )
    say(f"{'all joints':<{width}} {'':<44} {before:>8.3f} {after:>7.3f}")
    edge = [joint.name for joint in comparison.joints if joint.fit.delay_at_edge]
    if edge:
        say(
            f"warning: delays of {clipped(', '.join(edge), 60)} are at the end of the range that "
            "is looked at (-100 to 500 ms): --start may be wrong; without it the start is found"
        )
    if comparison.without_log:
        say(f"not in the log: {', '.join(comparison.without_log)}")
    if comparison.unknown:
        say(f"in the log, but no joints: {', '.join(comparison.unknown[:10])}")


def _row(joint: JointComparison) -> str:
    import numpy as np

    fit = joint.fit
    delay = "-" if fit.delay is None else f"{1e3 * fit.delay:.1f}"
    play = f"{np.degrees(fit.backlash):.2f}" if fit.knows_backlash else "-"
    stiffness = "-"
    if joint.stiffness is not None:
        error = joint.stiffness_error
        stiffness = "maybe rigid" if error is None else f"{joint.stiffness:.4g} +-{error:.2g}"
    described = ""
    if joint.described_stiffness is not None:
        described = f"({joint.described_stiffness:.4g})"
    turned = "  turns the other way" if fit.sign < 0 else ""
    return (
        f"{delay:>6} {np.degrees(fit.zero_offset):>6.2f} {play:>6} {stiffness:>16} "
        f"{described:>8} {np.degrees(joint.rms_before):>7.3f} "
        f"{np.degrees(joint.rms_after):>7.3f}{turned}"
    )

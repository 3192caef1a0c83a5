"""The command mgs generate."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.common import force_option, json_option, print_json, say, with_progress
from mgs.cli.completion import complete_gait, complete_key, complete_robot, complete_solver

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mgs.judge.motion_checks import Check
    from mgs.motion import Motion
    from mgs.motion.provenance import FilterReport


@click.command()
@click.argument("gait", metavar="GAIT.yaml", shell_complete=complete_gait)
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False, path_type=Path),
    help="Motion file to write. Default: outputs/ROBOT/GAIT.mcap with the names of robot and "
    "gait.",
)  # fmt: skip
@click.option(
    "--robot", "robot_name", metavar="NAME_OR_DIR", shell_complete=complete_robot,
    help="Shipped robot or robot folder to use instead of the robot in the gait file.",
)  # fmt: skip
@click.option(
    "--ik", metavar="NAME", shell_complete=complete_solver,
    help="Inverse-kinematics solver to use instead of ik.solver in the gait file: clik, ik1 to "
    "ik5, prioritized, prioritized-acceleration, trajectory, or a solver of another package.",
)  # fmt: skip
@click.option(
    "--set", "assignments", metavar="KEY=VALUE", multiple=True, shell_complete=complete_key,
    help="Change of a value of the gait file, e.g. walk.n_steps=30. May be repeated.",
)  # fmt: skip
@click.option(
    "--strict", is_flag=True,
    help="Exit with code 1 if the motion fails a static check. It is written all the same.",
)  # fmt: skip
@force_option
@json_option
@click.pass_context
def generate(
    ctx: click.Context,
    gait: str,
    output: Path | None,
    robot_name: str | None,
    ik: str | None,
    assignments: tuple[str, ...],
    strict: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Make a motion file from a gait file.

    Reads GAIT.yaml, which is a file or the name of a shipped gait, and writes a motion file: a
    joint trajectory with its references, for mgs validate and other tools. mgs schema gait
    describes the keys of a gait file.

    Prints tracking errors of soles, hands and centre of mass (CoM), distances from joint limits and
    from the edge of the support polygon, the distance of the zero-moment point (ZMP) of the whole
    robot from its plan, the largest moment about the vertical that the support sole has to bear,
    the computing time, and each static check of mgs validate that the motion fails. Exit code 1 if
    the robot cannot perform the gait.

    \b
    Examples:
      mgs generate melson/walk_5cm
      mgs generate my_walk.yaml -o walk.mcap --set walk.n_steps=30 --set ik.gamma_joint=0
    """  # noqa: D301
    started = time.perf_counter()
    from dataclasses import asdict

    from mgs.cli.verdict_text import line
    from mgs.core.atomic_files import refuse_taken
    from mgs.judge.motion_checks import check_motion
    from mgs.motion_file import write_motion
    from mgs.pipeline.request import request

    solver = {} if ik is None else {"ik.solver": ik}
    wanted = request(robot_name, gait, assignments, **solver)
    folder = Path("outputs") / Path(str(wanted.gait.robot)).name
    path = output or folder / f"{Path(gait).stem}.mcap"
    refuse_taken(path, force)
    made = with_progress("inverse kinematics", wanted.generate)
    motion, seconds = made.motion, made.seconds
    begun = time.perf_counter()
    with_progress("writing", lambda bar: write_motion(motion, path, force=force, progress=bar))
    seconds["write"] = time.perf_counter() - begun
    seconds["total"] = time.perf_counter() - started
    checks = check_motion(motion)
    failed = [check for check in checks if not check.ok]
    if as_json:
        failures = [check.to_dict() for check in failed]
        fit = None if made.fit is None else asdict(made.fit) | {"reserve": made.fit.has_reserve}
        print_json(
            _summary(path, motion, seconds, checks) | {"fit": fit, "failed_checks": failures}
        )
    else:
        _print_summary(path, motion, seconds, checks)
        if made.fit is not None:
            say(f"  fit       {made.fit}")
        for check in failed:
            say(f"  {line(check)}")
    ctx.exit(1 if failed and strict else 0)


def _summary(
    path: Path, motion: Motion, seconds: dict[str, float], checks: Sequence[Check]
) -> dict[str, object]:
    from dataclasses import asdict

    from mgs.judge.tracking import tracking_errors
    from mgs.motion.energy import energy_of

    energy = energy_of(motion)
    yaw = next((check for check in checks if check.name == "yaw_friction"), None)
    return {
        "file": str(path),
        "robot": motion.robot.spec.name,
        "gait": motion.gait_name,
        "solver": motion.provenance.solver.name,
        "samples": motion.n_samples,
        "dt": motion.dt,
        "duration": motion.duration,
        "tracking": asdict(tracking_errors(motion)),
        "zmp_error": motion.provenance.to_dict().get("zmp_error"),
        "energy": None if energy is None else energy.to_dict(),
        "yaw_friction": None if yaw is None else yaw.to_dict(),
        "seconds": seconds,
    }


def _print_summary(
    path: Path, motion: Motion, seconds: dict[str, float], checks: Sequence[Check]
) -> None:
    from mgs.cli.verdict_text import energy_words, yaw_words
    from mgs.judge.motion_checks import joint_position, zmp_margins
    from mgs.judge.tracking import tracking_errors
    from mgs.motion.energy import energy_of

    energy = energy_of(motion)
    energy_line = "" if energy is None else f"  energy    {energy_words(energy)}\n"
    yaw = yaw_words(checks)
    yaw_line = "" if yaw is None else f"  yaw       {yaw}\n"
    tracking, limit = tracking_errors(motion), joint_position(motion)
    solver = motion.provenance.solver.name
    margin = "no balance check for this motion"
    if motion.gait.is_balanced:
        inside = 1e3 * zmp_margins(motion, motion.zmp).min()
        margin = f"multibody ZMP {inside:.1f} mm inside the support polygon"
    stages = ", ".join(f"{stage} {1e3 * t:.0f}" for stage, t in seconds.items())
    say(
        f"{click.format_filename(str(path))}\n"
        f"  robot     {motion.robot.spec.name}, gait {motion.gait_name}, solver {solver}\n"
        f"  motion    {motion.duration:.2f} s, {motion.n_samples} samples of {motion.dt:g} s\n"
        f"  tracking  soles {1e3 * tracking.sole_position:.4f} mm and "
        f"{tracking.sole_rotation:.1e} rad, hands {1e3 * tracking.hand_position:.4f} mm, "
        f"CoM {1e3 * tracking.com:.4f} mm (worst sample)\n"
        f"  margins   {limit.where} {limit.value:.3f} rad from its limit, "
        f"{margin}\n"
        f"{_zmp_line(motion.provenance.zmp_error)}"
        f"{energy_line}"
        f"{yaw_line}"
        f"  time      {stages} ms"
    )


def _zmp_line(error: FilterReport | None) -> str:
    """ZMP errors before and after the dynamic filter; empty for motions without a planned ZMP."""
    if error is None:
        return ""
    before, after = error.before, error.after
    passes = "1 pass" if error.passes == 1 else f"{error.passes} passes"
    return (
        f"  ZMP       mean error {1e3 * before.mean:.2f} mm (largest "
        f"{1e3 * before.max:.2f} mm), after {passes} of the dynamic filter "
        f"{1e3 * after.mean:.2f} mm (largest {1e3 * after.max:.2f} mm)\n"
    )

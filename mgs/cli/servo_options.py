"""Options that choose the servos of replays, shared by several commands."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from mgs.cli.common import FiniteRange

if TYPE_CHECKING:
    from mgs.sim import ServoName

F = TypeVar("F", bound=Callable[..., Any])
KINDS = ("ideal", "model", "pd")  # as mgs.sim.SERVOS, whose import would slow down --help
KINDS_TEXT = (
    "ideal position control (ideal), the servo models of robot.yaml (model), or "
    "proportional-derivative (PD) control with the stall torques and no-load speeds of robot.yaml "
    "(pd)"
)


def servo_option_of(default: str) -> Callable[[F], F]:
    """Option --servo with the given default."""
    return click.option(
        "--servo", type=click.Choice(KINDS), default=default,
        help=f"Servos in the replays: {KINDS_TEXT}. Default: {default}.",
    )  # fmt: skip


def _kinds(ctx: click.Context, param: click.Parameter, value: str) -> tuple[str, ...]:
    """Kinds of servos in a text; ends the command as a usage error if one is unknown."""
    kinds = tuple(part.strip() for part in value.split(","))
    if not set(kinds) <= set(KINDS) or len(set(kinds)) != len(kinds):
        message = f"{value!r} is not a list of servos; use {', '.join(KINDS)}, separated by commas"
        raise click.BadParameter(message, ctx, param)
    return kinds


def servos_option_of(default: str) -> Callable[[F], F]:
    """Option --servo, with the given default, of a command that may replay several kinds."""
    return click.option(
        "--servo", "servos", metavar="KIND[,KIND]", callback=_kinds, default=default,
        help=f"Servos in the replays, one replay for each kind: {KINDS_TEXT}. Default: {default}.",
    )  # fmt: skip


servo_option = servo_option_of("ideal")
feed_forward_option = click.option(
    "--feed-forward/--no-feed-forward", default=None,
    help="Angles that servos other than ideal ones receive: planned angles plus a compensation of "
    "the position error under load (--feed-forward), or the planned angles (--no-feed-forward). "
    "Default: --feed-forward with servo models, --no-feed-forward with PD servos.",
)  # fmt: skip
sag_option = click.option(
    "--sag", "sag_deg", metavar="DEG", type=FiniteRange(0.01, 90.0),
    help="Position error of PD servos at stall torque [deg]. Default: 1.",
)  # fmt: skip
damping_time_option = click.option(
    "--damping-time", metavar="S", type=FiniteRange(0.0, 1.0),
    help="Damping of PD servos divided by their stiffness [s]. Default: 0.01.",
)  # fmt: skip

unit_option = click.option(
    "--unit", metavar="FILE.yaml", type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="Corrections of one physical robot: the simulated robot has its zeros, signs, scales, "
    "stiffness and backlash; of ideal servos only zeros, signs and scales. Default: none.",
)  # fmt: skip
correct_option = click.option(
    "--correct/--no-correct", "corrected", default=True,
    help="Commands in replays with --unit: corrected for that robot, as by mgs export --unit "
    "(--correct), or not (--no-correct). Default: --correct.",
)  # fmt: skip


def check_servos(
    servos: Sequence[ServoName],
    feed_forward: bool | None,
    sag_deg: float | None = None,
    damping_time: float | None = None,
) -> None:
    """Raise ConfigError for an option that has no effect on the servos."""
    from mgs.sim import check_servos

    options = {"--feed-forward": feed_forward, "--sag": sag_deg, "--damping-time": damping_time}
    check_servos(servos, options)

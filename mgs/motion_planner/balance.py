"""The plan of a balance motion: both feet stay while CoM, torso and hands follow waveforms."""

from __future__ import annotations

import numpy as np

from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.gait import BalanceGait
from mgs.motion_planner.motion_plan import BalancePlan
from mgs.motion_planner.standing import feet_abreast, standing_figures
from mgs.robot import Robot


def plan_balance(robot: Robot, gait: BalanceGait) -> BalancePlan:
    """Channels, their times, and the body at rest; see `plan_motion` for the errors."""
    balance, rest = gait.balance, standing_figures(robot)
    n_samples = round(balance.duration / gait.dt) + 1
    still = round(balance.rest / gait.dt)
    names = [channel.task for channel in balance.channels]
    moved = [any(name.startswith(f"{side.label}_hand") for name in names) for side in Side]
    for side in Side:
        if moved[side] and np.isnan(rest.hands[side]).any():
            raise ConfigError(
                "balance.channels",
                f"{side.label}_hand: {robot.spec.name} cannot move it relative to its "
                "torso; leave this channel out",
            )
    return BalancePlan(
        dt=gait.dt,
        n_samples=n_samples,
        footsteps=feet_abreast(robot),
        start=still,
        end=n_samples - 1 - still,
        ease=max(1, round(balance.ease / gait.dt)),
        channels=tuple(balance.channels),
        com=rest.com,
        com_height=balance.com_height or float(rest.com[2]),
        hands=np.where(np.array(moved)[:, None], rest.hands, np.nan),
        torso=rest.torso,
    )

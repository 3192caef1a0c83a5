"""Balancing: both feet stay where they are while CoM, torso and hands follow given waveforms."""

from __future__ import annotations

import numpy as np

from mgs.core.contact import Footstep, Side, Support
from mgs.core.errors import ConfigError
from mgs.gait import BalanceGait
from mgs.motion_planner.motion_plan import BodyPlan, MotionPlan, Phase
from mgs.motion_planner.standing import standing_figures
from mgs.robot import Robot, midpoint_width


def plan_balance(robot: Robot, gait: BalanceGait) -> MotionPlan:
    """One phase on both feet, and what the body does in it; see `plan_motion` for the errors."""
    balance, rest = gait.balance, standing_figures(robot)
    n_samples = round(balance.duration / gait.dt) + 1
    still, ease = round(balance.rest / gait.dt), max(1, round(balance.ease / gait.dt))
    width = midpoint_width(robot)
    names = [channel.task for channel in balance.channels]
    moved = [any(name.startswith(f"{side.label}_hand") for name in names) for side in Side]
    for side in Side:
        if moved[side] and np.isnan(rest.hands[side]).any():
            raise ConfigError(
                "balance.channels",
                f"{side.label}_hand: {robot.spec.name} cannot move it against its torso; "
                "leave this channel out",
            )
    asked = np.array(moved)[:, None]
    return MotionPlan(
        dt=gait.dt,
        n_samples=n_samples,
        footsteps=tuple(Footstep(side, 0.0, 0.5 * side.sign * width, 0.0) for side in Side),
        phases=(Phase(0, n_samples, Support.DOUBLE, (0, 1)),),
        step_height=0.0,
        landing=0.0,
        com_height=balance.com_height or float(rest.com[2]),
        zmp_offset=(0.0, 0.0),
        hand_offsets=np.where(asked, rest.hands - rest.com, np.nan),
        torso=rest.torso,
        body=BodyPlan(
            start=still,
            end=n_samples - 1 - still,
            ease=ease,
            channels=tuple(balance.channels),
            com=rest.com,
            com_height=balance.com_height or float(rest.com[2]),
            hands=np.where(asked, rest.hands, np.nan),
        ),
    )

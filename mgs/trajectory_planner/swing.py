"""Paths of the soles in a walk: at rest on footsteps, and swings between them.

A swing sole moves along the ground by a minimum-jerk blend, or steadily between two ramps, and
rises to step_height by a bump, so that it lifts off and lands without speed or acceleration. With a
landing it arrives above its footstep earlier and comes straight down at the end, by a third of
step_height per single support: a sole that meets the ground too early then neither scuffs nor hits
it fast.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.curves import evaluate
from mgs.core.geometry import bump, cruise, quintic
from mgs.gait.walk import SwingProfile
from mgs.motion_planner import Phase, WalkPlan

LANDING_SPEED = 1.0 / 3.0  # mean speed of a landing, in step heights per single support

RAMP = 0.35  # part of a swing in which the profile `cruise` speeds up, and slows down


def along_ground(s: Array, profile: SwingProfile) -> Array:
    """Part (N,) of its way that a swing sole has gone at parts s (N,) of the time."""
    return cruise(s, RAMP) if profile == "cruise" else quintic(s)


def sole_paths(plan: WalkPlan) -> tuple[Array, Array]:
    """Planar poses x, y [m], yaw [rad] (N, 2, 3) and heights (N, 2) of both soles [m]."""
    poses = np.array([[foot.x, foot.y, foot.yaw] for foot in plan.footsteps])
    heights = np.array([foot.z for foot in plan.footsteps])
    planar, height = np.empty((plan.n_samples, 2, 3)), np.empty((plan.n_samples, 2))
    for phase in plan.phases:
        feet, span = list(phase.feet), slice(phase.start, phase.end)
        planar[span], height[span] = poses[feet], heights[feet]
        if phase.target is not None:
            side = plan.footsteps[phase.target].side
            start, target = poses[phase.feet[side]], poses[phase.target]
            planar[span, side], height[span, side] = _swing(plan, phase, start, target)
    return planar, height


def _swing(plan: WalkPlan, phase: Phase, start: Array, target: Array) -> tuple[Array, Array]:
    """Planar poses (k, 3) and heights (k,) of a swing between planar poses (3,)."""
    samples = np.arange(phase.end - phase.start)
    if phase.path is not None:
        times = plan.dt * samples
        return evaluate(phase.path.planar, times), evaluate(phase.path.height, times)[:, 0]
    s = samples / len(samples)
    along = along_ground(s / (1.0 - plan.landing), plan.swing_profile)
    planar = start + along[:, None] * (target - start)
    return planar, plan.step_height * _swing_height(s, plan.landing)


def _swing_height(s: Array, landing: float) -> Array:
    """Height (N,) of the swing sole in step heights at parts s (N,) of a single support."""
    if landing == 0.0:
        return bump(s)
    above, low = 1.0 - landing, LANDING_SPEED * landing
    up, down = quintic(2.0 * s / above), quintic(2.0 * s / above - 1.0)
    last = quintic(np.clip(s - above, 0.0, landing) / landing)
    return up - (1.0 - low) * down - low * last

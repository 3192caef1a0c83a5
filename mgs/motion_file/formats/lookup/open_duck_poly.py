"""open-duck-poly: reference motions of the Open Duck playground (`PolyReferenceMotion`).

Pickle of a dictionary with one entry per walk, named "vx_vy_wz" after its velocity [m/s, rad/s]:

    coefficients  {"dim_0": 16 numbers, ...}: polynomials in the phase t from 0 to 1, the constant
                  first; one for each of 2 J + 8 quantities: J joint angles [rad], J joint
                  velocities [rad/s], contacts of left and right foot, velocity 3 [m/s] and angular
                  velocity 3 [rad/s] of the root in the world, whose x axis is the heading at t = 0
    period        of two steps [s]
    fps           [Hz]
    frame_offsets first column of each quantity in frames of format open-duck
    start_offset  0: a cycle begins with single support on the left sole
    nb_steps_in_period, startend_double_support_ratio 0

The reader takes the walk with the nearest velocity in each of the three axes, so the grid has to be
full, and takes period and rate from the first walk, so all have to be the same. Joints stand depth
first; the policies that are published for Open Duck expect the joints of that robot.

It evaluates in single precision, in which polynomials with large coefficients lose all digits. So
the fit leaves out those combinations of powers that differ from the others by less than a part of
1e-5 to 1e-9, whichever comes nearest to the frames in single precision. Knees that swing fast are
off by some hundredths of a radian even so, and contacts jump, which no polynomial does; what angles
are off by is printed.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.learning.amp_frames import columns
from mgs.motion_file.formats.learning.motion_lib import foot_contacts
from mgs.motion_file.formats.learning.open_duck import safe_period
from mgs.motion_file.formats.lookup.walk import Walk
from mgs.motion_file.formats.pickle_file import write_pickle

DEGREE = 15
CUTS = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9)  # singular values that are left out, of the largest one
QUANTITIES = ("joints_pos", "joints_vel", "foot_contacts", "world_linear_vel", "world_angular_vel")


def write(walks: Sequence[Walk], path: Path, options: Options) -> Written:
    """Write the table."""
    _refuse_gaps(walks)
    _refuse_other_periods(walks)
    robot = walks[0].sampled.robot
    names, index = chosen_joints(robot, options, "depth-first")
    entries: dict[str, Any] = {}
    worst = 0.0
    for walk in sorted(walks, key=lambda walk: walk.velocity):
        sampled, n = walk.sampled, walk.n_frames
        velocity = np.hstack([sampled.base_linear_velocity, sampled.base_angular_velocity])
        joints, speeds = sampled.joints[:, index], sampled.joint_velocity[:, index]
        table = columns(sampled, joints, speeds, velocity, "world_")
        table["foot_contacts"] = foot_contacts(sampled)
        frames = np.hstack([table[name] for name in QUANTITIES])
        phase = np.arange(n + 1) / n
        fitted = [fit(phase, frames[:, k]) for k in range(frames.shape[1])]
        worst = max(worst, *(error for _, error in fitted[: len(names)]))
        widths = itertools.accumulate((c.shape[1] for c in table.values()), initial=0)
        entries["_".join(f"{v:g}" for v in walk.velocity)] = {
            "coefficients": {f"dim_{k}": c for k, (c, _) in enumerate(fitted)},
            "period": safe_period(n, sampled.fps),
            "fps": round(sampled.fps) if sampled.fps == round(sampled.fps) else sampled.fps,
            "frame_offsets": dict(zip(table, widths, strict=False)),
            "start_offset": 0,
            "nb_steps_in_period": n,
            "startend_double_support_ratio": 0.0,
        }
    write_pickle(path, entries)
    return Written(names, notes=(f"polynomials differ from joint angles by up to {worst:.3g} rad",))


def fit(phase: Array, values: Array) -> tuple[list[float], float]:
    """Coefficients (16,) of the polynomial nearest to values (n,), and its largest error."""
    powers = np.vander(phase, DEGREE + 1, increasing=True)
    scale = np.linalg.norm(powers, axis=0)
    best, least = [0.0] * (DEGREE + 1), math.inf
    for cut in CUTS:
        found = np.linalg.lstsq(powers / scale, values, rcond=cut)[0] / scale
        error = float(np.abs(_single(found, phase) - values).max())
        if error < least:
            best, least = found.tolist(), error
    return best, least


def _single(powers: Array, phase: Array) -> Array:
    """Values (n,) of a polynomial in single precision, by Horner's rule as the reader has them."""
    out = np.zeros(len(phase), dtype=np.float32)
    for coefficient in powers[::-1].astype(np.float32):
        out = out * phase.astype(np.float32) + coefficient
    return out.astype(np.float64)


def _refuse_gaps(walks: Sequence[Walk]) -> None:
    """Refuse walks whose velocities are not a full grid, each once."""
    found = [walk.velocity for walk in walks]
    axes = [sorted({velocity[k] for velocity in found}) for k in range(3)]
    missing = sorted(set(itertools.product(*axes)) - set(found))
    if missing:
        vx, vy, wz = missing[0]
        raise ConfigError(
            "velocities",
            f"{len(missing)} of the {math.prod(map(len, axes))} points of the grid of "
            f"{' x '.join(str(len(axis)) for axis in axes)} velocities are missing, such as "
            f"vx = {vx:g}, vy = {vy:g} m/s, wz = {wz:g} rad/s; fewer digits bring walks together",
        )
    if twice := next((v for v in found if found.count(v) > 1), None):
        raise ConfigError("velocities", f"two walks have the velocity {twice}")


def _refuse_other_periods(walks: Sequence[Walk]) -> None:
    """Refuse walks of different periods."""
    counts = sorted({walk.n_frames for walk in walks})
    if len(counts) > 1:
        raise ConfigError(
            "period",
            f"all walks need the same period; they have {counts[0]} to {counts[-1]} frames",
        )

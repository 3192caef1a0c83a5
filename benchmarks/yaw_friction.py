"""Moment about the vertical that the support sole has to bear, of shipped walks and with free arms.

    python benchmarks/yaw_friction.py [FIGURE.png]

Prints the two tables of docs/theory; with a name it draws the moment over time of the fastest walk.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from mgs.core.contact import Side, Support
from mgs.gait import WalkGait, list_gaits, load_gait
from mgs.judge.motion_checks import check_motion
from mgs.judge.yaw_friction import yaw_limits, yaw_moments
from mgs.motion import Motion
from mgs.motion.dynamics import analyse
from mgs.motion.energy import energy_of
from mgs.pipeline import run_stages
from mgs.robot import load_robot

FASTEST, COMAN = "melson/walk_fastest", "coman/walk_fastest"
AWAY, UPRIGHT = "ik.gamma_momentum=1", "ik.torso=upright"
FREE = ("walk.hands=free", "walk.arm_swing=0")
HELD = ("walk.hands=held", "walk.arm_swing=0.35", "ik.gamma_momentum=0")
QUICK = (  # steps of 18 cm in 0.5 s
    *("walk.step_length=0.18", "walk.double_support=0.07", "walk.single_support=0.43"),
    *("walk.lead_in=1.8", "walk.lead_out=1.8", "walk.step_width=null", "walk.landing=0"),
    *("walk.step_height=0.015", "com.margin=0.04", "com.zmp_tolerance=0.0006"),
    *("ik.gamma_joint=0.35", "ik.torso=free"),
)
VARIANTS = (
    *((FASTEST, more) for more in (HELD, ("ik.gamma_momentum=0",), ("ik.gamma_joint=1",), ())),
    *((COMAN, more) for more in ((), (AWAY,), FREE, (*FREE, AWAY))),
    *((COMAN, (*QUICK, *more)) for more in ((), (UPRIGHT,), (UPRIGHT, *FREE, AWAY))),
)
DRAWN = {"hands held": HELD, "arms and waist against yaw, as shipped": ()}


def made(name: str, settings: tuple[str, ...] = ()) -> Motion:
    """Motion of a shipped gait with changes."""
    gait = load_gait(name, settings)
    return run_stages(load_robot(gait.robot or "melson"), gait, name).motion


def row(motion: Motion) -> str:
    """Moment, available moment, their ratio, cost of transport, and the checks that fail."""
    checks = check_motion(motion)
    yaw = next(check for check in checks if check.name == "yaw_friction")
    failed = ", ".join(check.name for check in checks if not check.ok) or "pass"
    energy = energy_of(motion)
    cost = None if energy is None else energy.cost_of_transport
    told = "" if cost is None else f"{cost:.3f}"
    return f"{yaw.value:.3g} | {yaw.limit:.3g} | {yaw.value / yaw.limit:.2f} | {told} | {failed} |"


def draw(path: Path) -> None:
    """Draw the moment of the fastest walk over time, with what the sole can bear."""
    from mgs.report.canvas import BLUE, VERMILION, new_figure, save_figures, style_axes

    figure = new_figure(7.0, 3.4)
    axes = figure.subplots()
    for (label, settings), colour in zip(DRAWN.items(), (VERMILION, BLUE), strict=True):
        motion = made(FASTEST, settings)
        load = np.choose(motion.support, [0.5, 1.0, 0.0])
        body = analyse(motion.robot, motion.q, motion.dt, load)
        axes.plot(motion.times, yaw_moments(motion, body)[0], color=colour, linewidth=1.5)
        axes.lines[-1].set_label(label)
        if not settings:
            continue
        for side in Side:
            k, spec = motion.support == Support.single(side), motion.robot.sole_spec(side)
            placed = body.wrench, body.zmp, body.soles[:, side]
            for limit in yaw_limits(*placed, spec.length, spec.width):
                axes.plot(motion.times, np.where(k, limit, np.nan), "--", color="0.5", lw=0.9)
    axes.lines[1].set_label("what friction 0.5 gives")
    axes.set_ylim(-0.9, 1.2)
    axes.set_xlim(1.1, 5.9)
    axes.legend(loc="upper right", fontsize=8, frameon=False, ncols=3)
    style_axes(
        axes,
        title=f"{FASTEST}: moment about the vertical through the ZMP, single support",
        xlabel="time [s]",
        ylabel="moment [N m]",
    )
    save_figures({path.stem: figure}, path.parent, force=True)


def main() -> None:
    """Print the tables."""
    if len(sys.argv) > 1:
        draw(Path(sys.argv[1]))
        return
    for name, settings in VARIANTS:
        print(f"| {name} {' '.join(settings)} | {row(made(name, settings))}", flush=True)
    for name in list_gaits():
        gait = load_gait(name)
        if isinstance(gait, WalkGait) and not name.startswith("generic/"):
            print(f"| {name} | {row(made(name))}", flush=True)


if __name__ == "__main__":
    main()

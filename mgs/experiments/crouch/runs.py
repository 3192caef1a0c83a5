"""Runs of the crouch experiment; see the package."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, POSITION_TOLERANCE
from mgs.core.contact import Side
from mgs.core.errors import MgsError
from mgs.experiments.channels import scaled_waves
from mgs.experiments.crouch.losses import electric_power
from mgs.experiments.variant import Variant
from mgs.gait import BalanceGait, Gait, WalkGait, load_gait
from mgs.motion import Motion
from mgs.motion.dynamics import place_on_soles
from mgs.motion.energy import positive_power
from mgs.pipeline import run_stages
from mgs.robot import Robot, build_robot, load_robot

MotionName = Literal["stand", "sway", "walk"]
MOTIONS: tuple[MotionName, ...] = ("stand", "sway", "walk")
FRACTIONS = (1.0, 0.985, 0.97, 0.93, 0.88, 0.82, 0.76)  # of the CoM height on straight legs
METHODS = ("ik1", "ik2", "ik3", "ik4", "ik5", "clik")
JUDGED = "ik4"  # the method of the paper
ITERATED = ("ik2", "ik4", "ik5")
LIMIT_DEG = 0.01  # beyond a joint limit that counts as rounding
FEW = 3  # their iterations, as in figure 7 of the paper
COMAN, MELSON = "coman_legs", "melson"
IDENTIFIED = "bam/mx64"  # servos of MELSON in this experiment

_SINE = "{task: com_y, wave: sine, amplitude: %g, frequency: 0.5}"
_TWIST = "{task: torso_yaw, wave: sine, amplitude: 0.1, frequency: 0.25}"
SWAYS = {COMAN: 0.04, MELSON: 0.02}  # amplitudes [m]
BALANCE = ("balance.duration=5.0", "balance.rest=0.3", "balance.ease=0.7")
STEPS = {COMAN: 0.1, MELSON: 0.05}  # lengths [m]
WALKS = {COMAN: "coman/walk", MELSON: "melson/walk_5cm"}
WALK = (
    *("walk.n_steps=4", "walk.lead_in=0.6", "walk.lead_out=0.6", "walk.double_support=0.2"),
    *("walk.single_support=0.6", "walk.com_tolerance=0.5", "walk.landing=0.2"),
    *("com.passes=1", "com.margin=null"),
)
FARAJI = ("ik.faraji.damping=0.01", "ik.faraji.soft.com=[100, 100, 1]", "ik.faraji.gamma=10")


@dataclass(frozen=True, eq=False)
class Run:
    """One motion at one CoM height, and what it takes."""

    motion: Motion
    window: slice  # the samples of the motion proper
    knee_deg: float  # mean angle of both knees in the window
    torque2: float  # mean sum of the squared torques [(N m)^2]
    work: float  # mean of the power that the joints give [W]
    electric: float | None  # mean electric power [W]; None: the servos are not identified
    sole_error: float  # largest distance of a sole from its reference [m]
    limit_excess_deg: float  # largest angle of a joint beyond its limits
    overload: float  # largest torque over the stall torque

    @property
    def is_feasible(self) -> bool:
        """Whether soles are where they shall be, and joints within their limits and torques."""
        is_met = self.sole_error <= POSITION_TOLERANCE
        return is_met and self.limit_excess_deg <= LIMIT_DEG and self.overload <= 1.0

    @property
    def trouble(self) -> str:
        """Reason why it is not feasible."""
        found = []
        if self.sole_error > POSITION_TOLERANCE:
            found.append(f"soles {1e3 * self.sole_error:.2g} mm off")
        if self.limit_excess_deg > LIMIT_DEG:
            found.append(f"{self.limit_excess_deg:.2g} deg beyond a joint limit")
        if self.overload > 1.0:
            found.append(f"{self.overload:.2g} times the stall torque")
        return " and ".join(found)

    @property
    def cost(self) -> float:
        """Electric power [W] where it is known, else the sum of the squared torques [(N m)^2]."""
        return self.torque2 if self.electric is None else self.electric


@dataclass(frozen=True, eq=False)
class Sweep:
    """One motion with one method over the CoM heights; None: the solver refuses it."""

    robot: str
    motion: MotionName
    method: str
    runs: tuple[Run | None, ...]
    quiet: Run | None  # standing on the straightest legs that are feasible, with the same method

    @property
    def made(self) -> list[Run]:
        """Feasible runs, from stretched to crouched legs."""
        return [run for run in self.runs if run is not None and run.is_feasible]

    @property
    def ratio(self) -> float:
        """Cost on the most crouched legs over that on the most stretched ones."""
        made = self.made
        return made[-1].cost / made[0].cost if len(made) > 1 else float("nan")

    @property
    def net_ratio(self) -> float:
        """Ratio without the cost of quiet stance on stretched legs; no number for standing."""
        made = self.made
        if len(made) < 2 or self.quiet is None or self.motion == "stand":
            return float("nan")
        return (made[-1].cost - self.quiet.cost) / (made[0].cost - self.quiet.cost)


def methods_of(robot: str, motion: MotionName) -> tuple[str, ...]:
    """Methods that a motion is run with; clik leaves the torso free, which sways and twists."""
    if robot == MELSON:
        return (JUDGED,)
    return METHODS[:-1] if motion == "sway" else METHODS


def given_robots() -> dict[str, Robot]:
    """COMAN with a rigid upper body, and Melson with identified servos at all joints."""
    melson = load_robot(MELSON)
    kept = melson.yaml.partition("servos:")[0], melson.yaml.partition("\njoints:")[2]
    servos = "".join(f"  {name}: {{model: {IDENTIFIED}}}\n" for name in ("RX-28", "AX-12"))
    yaml = f"{kept[0]}servos:\n{servos}joints:{kept[1]}"
    return {COMAN: load_robot(COMAN), MELSON: build_robot(yaml, melson.urdf, MELSON)}


def straight_height(robot: Robot) -> float:
    """Height of the CoM above the soles on straight legs, the rest half-sitting [m]."""
    angles = robot.posture.copy()
    for side in Side:
        for name in robot.spec.groups[f"{side.label}_leg"]:
            angles[robot.joint_names.index(name)] = 0.0
    soles = np.zeros((1, 2, 7))
    soles[..., 6] = 1.0
    q = place_on_soles(robot, angles[None], np.zeros(1, np.int8), soles)[0]
    return float(pin.centerOfMass(robot.model, robot.model.createData(), q)[2])


def run_one(
    name: str, robot: Robot, motion: MotionName, method: str, fraction: float, variant: Variant
) -> Run | None:
    """Generate one run; None: the solver refuses it."""
    gait = gait_of(name, robot, motion, method, fraction, variant)
    try:
        made = run_stages(robot, gait, f"{name} {motion}").motion
    except MgsError:
        return None
    return measured(made, _window(gait))


def gait_of(
    name: str, robot: Robot, motion: MotionName, method: str, fraction: float, variant: Variant
) -> Gait:
    """Gait of a run."""
    block = "walk" if motion == "walk" else "balance"
    settings = [
        f"ik.solver={method}",
        "ik.on_limit=record",
        *(FARAJI if method != "clik" else ("ik.torso=upright",)),
        *((f"ik.iterations={FEW}",) if method in ITERATED else ()),
        f"{block}.com_height={fraction * straight_height(robot):.6f}",
    ]
    if motion == "walk":
        settings += [*WALK, f"walk.step_length={variant.amplitude * STEPS[name]}", f"robot={name}"]
        return load_gait(WALKS[name], (*settings, *variant.settings))
    channels = f"{_SINE % SWAYS[name]}, {_TWIST}"
    if method == "clik":
        channels = _SINE % SWAYS[name]
    settings += [*BALANCE, f"balance.channels=[{channels}]", "balance.com_tolerance=0.5"]
    gait = load_gait("coman_legs/sway_twist", (*settings, f"robot={name}", *variant.settings))
    assert isinstance(gait, BalanceGait)
    return scaled_waves(gait, 0.0 if motion == "stand" else variant.amplitude, variant.speed)


def _window(gait: Gait) -> slice:
    """Samples in which a motion has its full amplitude, or in which the robot walks."""
    if isinstance(gait, WalkGait):
        first, last = gait.walk.lead_in, gait.walk.lead_out
    else:
        assert isinstance(gait, BalanceGait)
        first = last = gait.balance.rest + gait.balance.ease
    return slice(round(first / gait.dt), -round(last / gait.dt))


def measured(motion: Motion, window: slice) -> Run:
    """Measures of a motion in a window."""
    robot = motion.robot
    angles = motion.q[:, FLOATING_BASE_NQ:]
    power = electric_power(motion)
    gap = np.linalg.norm(motion.soles[..., :3] - motion.soles_ref[..., :3], axis=-1)
    excess = np.maximum(robot.lower - angles, angles - robot.upper).max()
    return Run(
        motion=motion,
        window=window,
        knee_deg=float(np.degrees(angles[window][:, knees(robot)].mean())),
        torque2=float(squared_torques(motion)[window].sum(axis=1).mean()),
        work=float(positive_power(motion)[window].mean()),
        electric=None if power is None else float(power[window].mean()),
        sole_error=float(gap.max()),
        limit_excess_deg=float(np.degrees(max(excess, 0.0))),
        overload=float((np.abs(motion.torque) / robot.torque_limit).max()),
    )


def squared_torques(motion: Motion) -> Array:
    """Squared torques (N, n) of the joints [(N m)^2]."""
    return np.asarray(motion.torque**2)


def knees(robot: Robot) -> NDArray[np.intp]:
    """Indices of the two knees."""
    return np.array([i for i, name in enumerate(robot.joint_names) if "knee" in name.lower()])

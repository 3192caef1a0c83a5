"""The block `ik` of a gait file: choice and parameters of the inverse kinematics solver."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator

from mgs.core.config import Model, Whole
from mgs.core.plugins import IK_SOLVERS
from mgs.gait.names import SolverName, own_parameters

HARD_SOFT = ("ik1", "ik2", "ik3", "ik4", "ik5")  # solvers that follow postures
Weight = Annotated[list[Annotated[float, Field(gt=0.0, le=1e6)]], Field(min_length=3, max_length=3)]
TaskName = Literal["soles", "torso", "com", "hands"]
PartName = Literal["soles", "torso", "com", "com_xy", "com_z", "hands"]


def _off_of_yaml(value: object) -> object:
    """Text for an unquoted off, which YAML 1.1 reads as false."""
    return "off" if value is False else value


SharingName = Annotated[Literal["off", "shared", "optimal"], BeforeValidator(_off_of_yaml)]


class FarajiParameters(Model):
    """Parameters of the solvers ik1 to ik5: hard and soft tasks, safety region of the joints.

    S. Faraji and A. J. Ijspeert, "Singularity-tolerant inverse kinematics for bipedal robots: An
    efficient use of computational power to reduce energy consumption", IEEE Robotics and Automation
    Letters, 2017.
    """

    hard: list[TaskName] = Field(
        ["soles", "torso", "hands"],
        description="Hard tasks, which the solver meets exactly; com is the centre of mass. A "
        "task without a reference in the motion is ignored.",
    )
    soft: dict[TaskName, Weight] = Field(
        {"com": [1.0, 1.0, 1.0]},
        description="Soft tasks, which the solver meets as well as possible, each with the "
        "weights Q of its x, y and z components; com is the centre of mass.",
    )
    damping: float = Field(
        1e-4,
        gt=0.0,
        le=1e3,
        description="Weight R of the squared changes of the joint angles in one iteration; use "
        "1e-2 for ik1 to ik3 if a leg stretches.",
    )
    gamma: float = Field(
        10.0,
        ge=0.0,
        le=1e3,
        description="Weight of the task velocity error in the solvers ik4 and ik5.",
    )
    gamma_rows: Literal["soft", "all"] = Field(
        "soft",
        description="Tasks to which gamma applies. soft: soft tasks only; all: hard and soft "
        "tasks, as in equation (8) of the paper.",
    )
    region: Literal["ellipse", "polygon"] = Field(
        "ellipse",
        description="Shape of the region of allowed joint positions and speeds (safety region), "
        "for ik3 to ik5.",
    )
    speed_max: float | None = Field(
        None,
        gt=0.0,
        le=100.0,
        description="Largest joint speed in the middle of the joint range [rad/s]; null: speed "
        "limits of the robot.",
    )
    margin: float = Field(
        0.0,
        ge=0.0,
        le=1.0,
        description="Smallest distance q_s from the joint limits [rad].",
    )
    descent: Literal["gauss_newton", "conjugate_gradients"] = Field(
        "gauss_newton",
        description="Iterations of ik2. gauss_newton: damped steps of equation (2); "
        "conjugate_gradients: the same steps as preconditioner of the method of conjugate "
        "gradients, which the paper names.",
    )
    bent_start: bool | None = Field(
        None,
        description="Whether the iterations of a sample start with stretched knees and elbows "
        "slightly bent, in ik2, ik4 and ik5; null: in ik4 and ik5.",
    )
    reserve: bool = Field(
        True,
        description="Whether ik4 and ik5 repeat the last part of the motion with bent knees or "
        "elbows where a hard task would be missed because a stretched limb cannot bend fast "
        "enough; false: as in the paper.",
    )
    posture_weight: float | None = Field(
        None,
        ge=0.0,
        le=1.0,
        description="Weight of the deviation from the half-sitting posture, relative to the "
        "weights of the soft tasks [m^2]; null: 1e-6 if the tasks leave joints undetermined, "
        "else 0.",
    )

    @model_validator(mode="after")
    def _each_task_once(self) -> FarajiParameters:
        if twice := set(self.hard) & set(self.soft):
            raise ValueError(
                f"{min(twice)} is both a hard and a soft task; remove it from one of the two lists"
            )
        if not self.hard or not self.soft:
            raise ValueError("hard and soft need at least one task each")
        return self


class PrioritizedParameters(Model):
    """Parameters of the prioritized solvers: three levels of tasks on a floating base.

    M. Mistry, J. Nakanishi, G. Cheng and S. Schaal, "Inverse kinematics with floating base and
    constraints for full body humanoid robot control", IEEE-RAS Humanoids, 2008.
    """

    critical: list[PartName] = Field(
        ["soles", "com_xy"],
        description="Tasks of the highest priority (level A), which the lower levels cannot "
        "disturb; soles must be among them; com, com_xy and com_z are the centre of mass, its "
        "horizontal and its vertical position.",
    )
    functional: list[PartName] = Field(
        ["hands"], description="Tasks of the middle priority (level B)."
    )
    extraneous: list[PartName] = Field(
        ["torso", "com_z"], description="Tasks of the lowest priority (level E)."
    )
    null_space: Literal["tracking", "projected", "equation_7", "equation_16", "footnote_3"] = Field(
        "tracking",
        description="Formula for the lower levels, with J_B the Jacobian of level B and N_A the "
        "null-space projector of level A. tracking: (J_B N_A)^+, which meets a lower level exactly "
        "if this is possible; projected: N_A J_B^+, with bounds on levels in conflict and with a "
        "posture of the redundant joints. Exactly as printed in the paper, without both: "
        "equation_16; footnote_3, with a damped projector of level E; equation_7, all tasks in one "
        "level.",
    )
    catch_up: float | None = Field(
        0.5,
        gt=0.0,
        le=100.0,
        description="Largest rate at which an old task error is reduced [m/s and rad/s], in the "
        "forms tracking and projected; null: no bound. A bound of 0.5 clips the error that is "
        "corrected in a sample of 10 ms to 10 mm or 0.01 rad, so that joints do not rush when a "
        "task that was out of reach can be met again.",
    )
    feedback: float = Field(
        0.5,
        gt=0.0,
        le=1.0,
        description="Fraction of a task error that is corrected in each sampling period.",
    )
    handover: float = Field(
        0.1,
        ge=0.0,
        le=2.0,
        description="Duration of the transition between the contact constraints of two support "
        "phases [s].",
    )

    @model_validator(mode="after")
    def _each_task_once(self) -> PrioritizedParameters:
        parts = [
            part
            for name in [*self.critical, *self.functional, *self.extraneous]
            for part in (("com_xy", "com_z") if name == "com" else (name,))
        ]
        for part in parts:
            if parts.count(part) > 1:
                raise ValueError(f"{part} is in two levels; remove it from one of them")
        if "soles" not in self.critical:
            raise ValueError(
                "soles must be in critical: without them the pose of the base is undetermined"
            )
        return self


class TrajectoryParameters(Model):
    """Parameters of the solver trajectory, which optimizes the joint angles of all samples at once.

    The solver minimizes a weighted sum of costs over the motion, with all tasks as constraints.
    """

    start: Literal["free", "posture"] = Field(
        "free",
        description="Posture at the start of the motion. free: the posture of least cost; "
        "posture: that of the solver clik, which is as close to the half-sitting posture as the "
        "tasks permit.",
    )
    weight_joint: float = Field(
        0.35,
        ge=0.0,
        le=1e3,
        description="Weight of the joint-limit cost H_joint, which increases with the distance of "
        "the joints from the middle of their ranges.",
    )
    weight_grav: float = Field(
        1.6,
        ge=0.0,
        le=1e3,
        description="Weight of the gravity-torque cost H_grav, half the sum of the squared static "
        "joint torques [1/(N m)^2].",
    )
    weight_acceleration: float = Field(
        3e-5,
        gt=0.0,
        le=1e3,
        description="Weight of the squared joint accelerations [s^4/rad^2].",
    )
    weight_limit: float = Field(
        0.003,
        ge=0.0,
        le=1e3,
        description="Weight of the barrier function that keeps joints inside their limits.",
    )
    iterations: Whole = Field(20, ge=0, le=1000, description="Largest number of iterations.")
    tolerance: float = Field(
        1e-3,
        ge=1e-12,
        le=1.0,
        description="Relative decrease of the cost below which the iteration stops.",
    )


OnLimit = Literal["hold", "refuse", "record"]


class IkParameters(Model):
    """Inverse kinematics (IK): solver, its parameters, and the reaction to joint limits."""

    solver: SolverName = Field(
        "clik",
        description="Name of the inverse kinematics solver. clik: closed-loop inverse kinematics; "
        "ik1 to ik5: hard and soft tasks; prioritized, prioritized-acceleration: three priority "
        "levels; trajectory: optimization of all samples at once; any other name: a solver of "
        "another package.",
    )
    gamma_joint: float = Field(
        0.35,
        ge=0.0,
        le=1e3,
        description="Gain of the null-space motion that keeps joints away from their limits "
        "[rad^2/s]; for the solver clik; 0: no such motion.",
    )
    gamma_grav: float = Field(
        0.0,
        ge=0.0,
        le=1e3,
        description="Gain of the null-space motion that reduces static joint torques [1/((N m)^2 "
        "s)]; for the solver clik; 0: no such motion.",
    )
    gamma_grav_ramp: float = Field(
        0.2,
        ge=1e-4,
        le=10.0,
        description="Duration over which the null-space motion sets in at the start and fades out "
        "at the end of the motion [s]; for the solver clik. With `double_support: off`, "
        "gamma_grav also decreases to zero over this duration before each double support phase, "
        "and increases again after it.",
    )
    gamma_momentum: float = Field(
        0.0,
        ge=0.0,
        le=1.0,
        description="Fraction of the angular momentum about the vertical that a null-space motion "
        "removes, with `walk.hands: free` mostly of the arms; for the solver clik; 0: none.",
    )
    double_support: SharingName = Field(
        "shared",
        description="Assumed distribution of the weight between both soles in double support, "
        "from which the static joint torques follow; for the solvers clik and trajectory. off: "
        "torques are ignored in double support; shared: weight in the proportion that the "
        "reference of the zero-moment point (ZMP) gives; optimal: distribution of least joint "
        "torques with contact forces inside friction cones and soles.",
    )
    iterations: Whole | None = Field(
        None,
        ge=0,
        le=50,
        description="Number of iterations in each sampling period. For clik: Newton updates after "
        "the first step; null: as many as the tolerance requires, normally none. For ik2, ik4 and "
        "ik5: iterations n, at least 1; null: 15.",
    )
    torso: Literal["free", "upright", "hold"] = Field(
        "upright",
        description="Orientation of the torso that the solver clik keeps as far as its other "
        "tasks allow. upright: z axis of the torso vertical and heading of the soles; hold: "
        "orientation in the half-sitting posture, turned with the soles; free: no orientation. "
        "Legs of fewer than six joints keep the pelvis as the soles require; there this key has "
        "no effect.",
    )
    on_limit: OnLimit = Field(
        "hold",
        description="Reaction if a joint reaches a limit. hold: the solver clik holds the joint at "
        "the limit of its range or speed and lets the rest of the body take over; where tasks need "
        "more than that, and with the other solvers, as refuse. refuse: no motion is made if a "
        "joint leaves its range or, in the solvers other than clik and trajectory, if a task is "
        "missed, and an error states the reason. record: the motion is made, and mgs validate "
        "reports the violation.",
    )
    faraji: FarajiParameters = Field(
        default_factory=FarajiParameters, description="Parameters of the solvers ik1 to ik5."
    )
    prioritized: PrioritizedParameters = Field(
        default_factory=PrioritizedParameters,
        description="Parameters of the solvers prioritized and prioritized-acceleration.",
    )
    trajectory: TrajectoryParameters = Field(
        default_factory=TrajectoryParameters, description="Parameters of the solver trajectory."
    )
    parameters: dict[str, Any] = Field(
        {},
        description="Parameters of a solver of another package; the documentation of that package "
        "lists them.",
    )

    @field_validator("parameters")
    @classmethod
    def _are_those_of_the_solver(
        cls, given: dict[str, Any], info: ValidationInfo
    ) -> dict[str, Any]:
        return own_parameters(IK_SOLVERS, "solver", given, info)


class WholeBodyIkParameters(IkParameters):
    """Inverse kinematics (IK) of motions that also prescribe torso orientation and postures."""

    solver: SolverName = Field(
        "ik4",
        description="Name of the inverse kinematics solver: one of ik1 to ik5, which follow joint "
        "postures, or a solver of another package.",
    )

    @field_validator("solver")
    @classmethod
    def _keeps_to_postures(cls, solver: str) -> str:
        if solver in IK_SOLVERS.own and solver not in HARD_SOFT:
            raise ValueError(
                f"{solver} cannot follow the posture of torso and joints that this motion "
                f"prescribes; use one of {', '.join(HARD_SOFT)}"
            )
        return solver

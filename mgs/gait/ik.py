"""The block `ik` of a gait file."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator

from mgs.core.config import Model
from mgs.core.plugins import IK_SOLVERS
from mgs.gait.names import SolverName, own_parameters

HARD_SOFT = ("ik1", "ik2", "ik3", "ik4", "ik5")  # solvers that follow postures
Weight = Annotated[list[Annotated[float, Field(gt=0.0, le=1e6)]], Field(min_length=3, max_length=3)]
TaskName = Literal["soles", "torso", "com", "hands"]
PartName = Literal["soles", "torso", "com", "com_xy", "com_z", "hands"]


def _off_of_yaml(value: object) -> object:
    """YAML 1.1 reads an unquoted off as false."""
    return "off" if value is False else value


SharingName = Annotated[Literal["off", "shared", "optimal"], BeforeValidator(_off_of_yaml)]


class FarajiParameters(Model):
    """Inverse kinematics ik1 to ik5 (Faraji and Ijspeert): hard rows, soft rows, safety region."""

    hard: list[TaskName] = Field(
        ["soles", "torso", "hands"], description="Tasks met exactly; those not asked for are left."
    )
    soft: dict[TaskName, Weight] = Field(
        {"com": [1.0, 1.0, 1.0]},
        description="Tasks that may be compromised, with the weights Q of their x, y, z.",
    )
    damping: float = Field(
        1e-4,
        gt=0.0,
        le=1e3,
        description="R, weight of the joint steps; 1e-2 where a leg stretches in ik1 to ik3.",
    )
    gamma: float = Field(
        10.0, ge=0.0, le=1e3, description="Weight of the task velocity in ik4 and ik5."
    )
    gamma_rows: Literal["soft", "all"] = Field(
        "soft", description="Rows that gamma acts on; all: as eq. (8) is printed."
    )
    region: Literal["ellipse", "polygon"] = Field(
        "ellipse", description="Shape of the safety region of position and speed (ik3 to ik5)."
    )
    speed_max: float | None = Field(
        None, gt=0.0, le=100.0, description="Joint speed mid-range [rad/s]; null: the robot's."
    )
    margin: float = Field(
        0.0, ge=0.0, le=1.0, description="q_s, distance kept from the joint limits [rad]."
    )
    posture_weight: float | None = Field(
        None,
        ge=0.0,
        le=1.0,
        description="Pull to the half-sitting posture, as a part of the soft tasks' weight [m^2]; "
        "null: 1e-6 if joints are left over, else 0.",
    )

    @model_validator(mode="after")
    def _each_task_once(self) -> FarajiParameters:
        if twice := set(self.hard) & set(self.soft):
            raise ValueError(f"{min(twice)} is both hard and soft; keep it in one of them")
        if not self.hard or not self.soft:
            raise ValueError("both hard and soft want at least one task")
        return self


class PrioritizedParameters(Model):
    """Prioritised floating-base inverse kinematics (Mistry et al.): three levels of tasks."""

    critical: list[PartName] = Field(
        ["soles", "com_xy"], description="Level A, met whatever the others ask."
    )
    functional: list[PartName] = Field(["hands"], description="Level B.")
    extraneous: list[PartName] = Field(["torso", "com_z"], description="Level E.")
    null_space: Literal["tracking", "projected"] = Field(
        "tracking",
        description="tracking: (J_B N_A)^+, lower levels are met where they can be; projected: "
        "N_A J_B^+ as in eq. (16).",
    )
    feedback: float = Field(
        0.5, gt=0.0, le=1.0, description="Share of a task error that is taken back per sample."
    )
    handover: float = Field(
        0.1, ge=0.0, le=2.0, description="Time to blend constraint sets at a support switch [s]."
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
                raise ValueError(f"{part} stands in two levels; keep it in one of them")
        if "soles" not in self.critical:
            raise ValueError("soles have to be critical: without them the base is not determined")
        return self


class TrajectoryParameters(Model):
    """Null-space motion of the whole motion at once: weights of what is least in sum."""

    start: Literal["free", "posture"] = Field(
        "free",
        description="free: begin in the best posture; posture: as close to half-sitting as clik.",
    )
    weight_joint: float = Field(0.35, ge=0.0, le=1e3, description="Weight of H_joint.")
    weight_grav: float = Field(
        1.6, ge=0.0, le=1e3, description="Weight of H_grav [1/(N m)^2], scaled as gamma_grav."
    )
    weight_acceleration: float = Field(
        3e-5, gt=0.0, le=1e3, description="Weight of the squared joint accelerations [s^4/rad^2]."
    )
    weight_limit: float = Field(
        0.003, ge=0.0, le=1e3, description="Weight of the barrier before the joint limits."
    )
    iterations: int = Field(20, ge=0, le=1000, description="At most.")
    tolerance: float = Field(
        1e-3,
        ge=1e-12,
        le=1.0,
        description="Part of the objective that an iteration has to gain for another to follow.",
    )


class IkParameters(Model):
    """Inverse kinematics (stage 4)."""

    solver: SolverName = Field(
        "clik", description="Name of the IK solver, one of mgs or one of another package."
    )
    gamma_joint: float = Field(
        0.35, ge=0.0, le=1e3, description="clik: gain of the joint-limit gradient [rad^2/s]."
    )
    gamma_grav: float = Field(
        0.0,
        ge=0.0,
        le=1e3,
        description="clik: gain of the gravity-torque gradient [1/((N m)^2 s)].",
    )
    gamma_grav_ramp: float = Field(
        0.2,
        ge=1e-4,
        le=10.0,
        description="clik: time over which gamma_grav falls before double support [s].",
    )
    double_support: SharingName = Field(
        "shared",
        description="clik, trajectory: how two soles share the weight in the gravity task; off: "
        "gamma_grav is 0 in double support; shared: as the ZMP is shared; optimal: with the least "
        "torque inside friction and sole limits.",
    )
    iterations: int | None = Field(
        None,
        ge=0,
        le=50,
        description="clik: task-only Newton updates per sample, null: until the tolerance is met; "
        "ik2, ik4, ik5: n, null: 15.",
    )
    torso: Literal["free", "upright", "hold"] = Field(
        "free",
        description="Orientation of the torso that clik keeps as far as its other tasks allow. "
        "free: none; upright: its axis vertical, its heading that of the soles; hold: the "
        "orientation in the half-sitting posture, turned with the soles.",
    )
    on_limit: Literal["refuse", "record"] = Field(
        "refuse", description="What to do when a joint leaves its range."
    )
    faraji: FarajiParameters = Field(default_factory=FarajiParameters)
    prioritized: PrioritizedParameters = Field(default_factory=PrioritizedParameters)
    trajectory: TrajectoryParameters = Field(default_factory=TrajectoryParameters)
    parameters: dict[str, Any] = Field(
        {}, description="Parameters of a solver from another package, whose guide lists them."
    )

    @field_validator("parameters")
    @classmethod
    def _are_those_of_the_solver(
        cls, given: dict[str, Any], info: ValidationInfo
    ) -> dict[str, Any]:
        return own_parameters(IK_SOLVERS, "solver", given, info)


class WholeBodyIkParameters(IkParameters):
    """Inverse kinematics where torso and joint postures are asked for too."""

    solver: SolverName = Field(
        "ik4",
        description="Name of the IK solver: ik1 to ik5, which keep to postures, or a solver of "
        "another package.",
    )

    @field_validator("solver")
    @classmethod
    def _keeps_to_postures(cls, solver: str) -> str:
        if solver in IK_SOLVERS.own and solver not in HARD_SOFT:
            raise ValueError(
                f"{solver} cannot follow the posture of torso and joints that this motion asks "
                f"for; use one of {', '.join(HARD_SOFT)}"
            )
        return solver

"""The block `walk` of a gait file: footsteps, timing of the phases, swing foot and ZMP."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from mgs.core.config import Model, Whole
from mgs.core.constants import COM_TOLERANCE
from mgs.core.limits import MAX_BOXES, MAX_STEPS

Duration = Annotated[float, Field(gt=0.0, le=60.0)]
Length = Annotated[float, Field(ge=-1.0, le=1.0)]
SwingProfile = Literal["minimum_jerk", "cruise"]
Turn = Annotated[float, Field(ge=-1.0, le=1.0)]
Coordinate = Annotated[float, Field(ge=-1e3, le=1e3)]
Heading = Annotated[float, Field(ge=-100.0, le=100.0)]


class StepParameters(Model):
    """One step of the list `walk.steps`; a key that is left out has its value in block `walk`."""

    step_length: Length | None = Field(
        None,
        description="Forward distance of the swing sole past the support sole [m]; negative: "
        "backward; null: walk.step_length.",
    )
    lateral: Length | None = Field(
        None,
        description="Sideways distance of the step [m]; positive: to the left, only in steps of "
        "the left foot; negative: to the right, only in steps of the right foot; null: "
        "walk.lateral.",
    )
    step_yaw: Turn | None = Field(
        None, description="Turn of the step [rad]; positive: to the left; null: walk.step_yaw."
    )


class FootstepParameters(Model):
    """One footstep of the list `walk.footsteps`: pose of a sole in the world frame.

    The origin of the world frame lies on the ground midway between the soles at the start; x points
    forward, y to the left. The footstep stands on the ground or on top of the box below it.
    """

    side: Literal["left", "right"] = Field(description="Foot that steps onto this footstep.")
    x: Coordinate = Field(description="Position of the centre of the sole along x [m].")
    y: Coordinate = Field(description="Position of the centre of the sole along y [m].")
    yaw: Heading = Field(
        0.0, description="Heading of the sole [rad]; 0: along x; positive: to the left."
    )


class GoalParameters(Model):
    """Goal of a walk: final pose of the midpoint between the soles in the world frame.

    The origin of the world frame lies on the ground midway between the soles at the start; x points
    forward, y to the left.
    """

    x: Coordinate = Field(0.0, description="Final position along x [m].")
    y: Coordinate = Field(0.0, description="Final position along y [m].")
    yaw: float = Field(
        0.0,
        ge=-3.1416,
        le=3.1416,
        description="Final heading [rad]; 0: along x; positive: to the left.",
    )


class FootRollParameters(Model):
    """Rolling feet: heels rise before lift-off, and soles land on their heels.

    Angles are those of the longest step forward; shorter steps roll less, in proportion. In the
    first third of a double support phase the front sole comes down, then the rear heel rises; a
    front sole that comes down alone takes two thirds.
    """

    toe_off: float = Field(
        0.0,
        ge=0.0,
        le=0.8,
        description="Pitch of the sole at lift-off, when it stands on its toe [rad]; 0: level.",
    )
    heel_strike: float = Field(
        0.0,
        ge=0.0,
        le=0.8,
        description="Pitch of the sole at touch-down, when it lands on its heel with the toe up "
        "[rad]; 0: level.",
    )


class BoxParameters(Model):
    """A box on the ground: a stair to step on or an obstacle to step over.

    The origin of the world frame lies on the ground midway between the soles at the start; x points
    forward, y to the left.
    """

    x: Coordinate = Field(description="Position of the centre of the box along x [m].")
    y: Coordinate = Field(0.0, description="Position of the centre of the box along y [m].")
    yaw: Heading = Field(
        0.0, description="Rotation of the box about the vertical axis [rad]; positive: to the left."
    )
    length: float = Field(
        gt=0.0, le=100.0, description="Length of the box along its own x axis [m]."
    )
    width: float = Field(gt=0.0, le=100.0, description="Width of the box along its own y axis [m].")
    height: float = Field(
        gt=0.0, le=1.0, description="Height of the top of the box above the ground [m]."
    )


class WalkParameters(Model):
    """Parameters of a walk: footsteps, support phases, swing foot and zero-moment point (ZMP).

    Exactly one of the keys n_steps, steps, footsteps and goal determines the footsteps. The origin
    of the world frame lies on the ground midway between the soles at the start; x points forward,
    y to the left, z up.
    """

    n_steps: Whole | None = Field(
        None,
        ge=1,
        le=MAX_STEPS,
        description="Number of equal steps, including the closing step that places the feet side "
        "by side; null: the footsteps are given by steps, footsteps or goal.",
    )
    steps: Annotated[list[StepParameters], Field(min_length=1, max_length=MAX_STEPS)] | None = (
        Field(
            None,
            description="List of individual steps; a closing step that places the feet side by "
            "side is added; null: the footsteps are given by n_steps, footsteps or goal.",
        )
    )
    footsteps: (
        Annotated[list[FootstepParameters], Field(min_length=1, max_length=MAX_STEPS)] | None
    ) = Field(
        None,
        description="List of footsteps as poses in the world frame; null: the footsteps are given "
        "by n_steps, steps or goal.",
    )
    goal: GoalParameters | None = Field(
        None,
        description="Final pose of the robot, from which the planner derives the footsteps. "
        "step_length, lateral and step_yaw are then the largest step sizes; 0: derived from the "
        "leg length. null: the footsteps are given by n_steps, steps or footsteps.",
    )
    sizes: Literal["given", "robot", "relative"] = Field(
        "given",
        description="Origin of the sizes. given: values that the file leaves out are the defaults "
        "listed here; robot: step sizes, durations and the settings of the block com that it "
        "leaves out are derived from leg length and soles of the robot; relative: as robot, and "
        "step_length, lateral and step_height are multiples of the leg length.",
    )
    step_length: Length = Field(
        0.0,
        description="Forward distance of the swing sole past the support sole [m]; negative: "
        "backward.",
    )
    lateral: Length = Field(
        0.0,
        description="Sideways distance of each step of the leading foot [m]; the other foot then "
        "follows. Positive: to the left with the left foot in the lead; negative: to the right "
        "with the right foot in the lead.",
    )
    step_yaw: float = Field(
        0.0,
        ge=-1.0,
        le=1.0,
        description="Change of heading in each step [rad]; positive: to the left.",
    )
    step_width: float | None = Field(
        None,
        gt=0.0,
        le=2.0,
        description="Lateral distance between the centres of both soles [m]; null: their distance "
        "in the half-sitting posture of the robot.",
    )
    first_support: Literal["left", "right"] | None = Field(
        None,
        description="Support foot of the first step; null: the right foot if the walk begins with "
        "a step or a turn to the left, else the left foot; with footsteps, the foot opposite to "
        "the first footstep.",
    )
    last_support: Literal["left", "right"] | None = Field(
        None,
        description="Support foot of the last step; one step is added if the number of steps does "
        "not lead to this foot; null: either foot.",
    )
    lead_in: Duration = Field(
        0.3,
        description="Duration of rest before the first weight shift [s].",
    )
    double_support: Duration = Field(
        0.2,
        description="Duration of each double support phase [s]; the first and the last weight "
        "shift are double support phases.",
    )
    single_support: Duration = Field(0.5, description="Duration of each single support phase [s].")
    lead_out: Duration = Field(
        0.3,
        description="Duration of rest after the last weight shift [s]; at least com.preview with "
        "com.generator: preview.",
    )
    step_height: float = Field(
        0.02,
        gt=0.0,
        le=0.5,
        description="Largest height of the swing sole above the ground [m]; above boxes the sole "
        "rises as far as `clearance` requires.",
    )
    swing_profile: SwingProfile = Field(
        "minimum_jerk",
        description="Speed of the swing sole along the ground over a single support phase. "
        "minimum_jerk: blend of least jerk, whose largest speed is 1.875 times the mean; cruise: "
        "steady in the middle, with a largest speed of 1.54 times the mean and more acceleration. "
        "Steps over boxes have profiles of their own.",
    )
    landing: float = Field(
        0.2,
        ge=0.0,
        le=0.5,
        description="Final fraction of each single support phase in which the swing sole, already "
        "above its footstep, moves down vertically and slowly, so that it can meet the ground "
        "early without harm; 0: no such descent.",
    )
    foot_roll: FootRollParameters | None = Field(
        None,
        description="Rolling of the soles over heels and toes on level ground; null: soles stay "
        "level.",
    )
    com_height: float | None = Field(
        None,
        ge=1e-3,
        le=3.0,
        description="Height of the centre of mass above the ground [m]; null: height in the "
        "half-sitting posture of the robot.",
    )
    leg_stretch: float | None = Field(
        None,
        ge=0.5,
        le=1.2,
        description="Largest distance of an ankle from its hip, as a fraction of that with a "
        "straight knee. The centre of mass is lower than com_height wherever a leg would have to "
        "stretch farther; values above 1 count on a pelvis that turns to help. null: 0.97 with "
        "boxes, and on level ground the height of com_height [m] is kept.",
    )
    com_tolerance: float = Field(
        COM_TOLERANCE,
        gt=0.0,
        le=1.0,
        description="Largest allowed distance of the centre of mass from its reference [m]. "
        "Increase this value if com_height is more than the legs can reach; the solvers ik1 to "
        "ik5 then come as close as possible.",
    )
    zmp_offset: Annotated[list[Length], Field(min_length=2, max_length=2)] = Field(
        [0.0, 0.0],
        description="Reference position of the zero-moment point (ZMP) on the support sole: "
        "distance forward and distance towards the other foot, both from the centre of the sole "
        "[m].",
    )
    zmp_travel: float = Field(
        0.0,
        ge=0.0,
        le=1.0,
        description="Distance that the reference of the zero-moment point (ZMP) travels towards "
        "the toes during each single support phase [m]; 0: the reference stands still. With "
        "foot_roll it is that of the longest step, and shorter steps have less.",
    )
    arm_swing: float = Field(
        0.0,
        ge=0.0,
        le=2.0,
        description="Forward motion of each hand as a fraction of the motion of the opposite "
        "foot, both relative to the midpoint between the soles; 0: no arm swing.",
    )
    hands: Literal["held", "free"] = Field(
        "held",
        description="Task of the hands. held: they keep their places beside the centre of mass, "
        "and move with arm_swing; free: they have no task, and the null-space motions of the "
        "block ik move the arms.",
    )
    boxes: Annotated[list[BoxParameters], Field(max_length=MAX_BOXES)] = Field(
        [],
        description="List of boxes, which are stairs and obstacles: a footstep above a box stands "
        "on top of the box, and the swing sole passes over boxes in its way.",
    )
    clearance: float = Field(
        0.005,
        ge=0.0,
        le=0.2,
        description="Smallest height of the swing sole above the edges of boxes that it passes "
        "[m].",
    )

    @property
    def most_steps(self) -> int:
        """Number of steps with the closing step; 1 for a goal, whose planner finds the number."""
        return self.n_steps or 1 + max(len(self.steps or ()), len(self.footsteps or ()))

    @model_validator(mode="after")
    def _says_once_where_to_go(self) -> WalkParameters:
        keys = ("n_steps", "steps", "footsteps", "goal")
        given = [key for key in keys if getattr(self, key) is not None]
        if len(given) != 1:
            found = " and ".join(given) or "none of them"
            raise ValueError(f"exactly one of {', '.join(keys)} is needed; found {found}")
        return self

    @model_validator(mode="after")
    def _moves_only_as_a_foot_can(self) -> WalkParameters:
        if self.n_steps == 1 and (self.step_length or self.lateral or self.step_yaw):
            raise ValueError(
                "n_steps = 1 is the closing step alone, which does not advance; use n_steps >= 2"
            )
        return self

    @model_validator(mode="after")
    def _swings_hands_that_it_holds(self) -> WalkParameters:
        if self.hands == "free" and self.arm_swing:
            raise ValueError(
                f"arm_swing = {self.arm_swing:g} moves hands that are held; use arm_swing: 0 or "
                "hands: held"
            )
        return self

"""Gait files: what the robot shall do, as written by a person.

The order of the classes is the order of the blocks in a file. SI units; x forward, y left, z up;
angles in rad.
"""

from __future__ import annotations

import importlib.resources
from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import Field, TypeAdapter, create_model, model_validator

from mgs.config import FormatVersion, Model, build, is_file, parse_yaml, read_text, set_key
from mgs.errors import ConfigError

SCHEMA_VERSION = 1
MAX_SAMPLES = 2_000_000  # about 5 GB of arrays

MAX_SECONDS = 36_000.0
COM_TOLERANCE = 2e-4  # [m]

Duration = Annotated[float, Field(gt=0.0, le=60.0)]
Length = Annotated[float, Field(ge=-1.0, le=1.0)]
Displacement = Annotated[float, Field(ge=-2.0, le=2.0)]
Frequency = Annotated[float, Field(gt=0.0, le=20.0)]
Weight = Annotated[list[Annotated[float, Field(gt=0.0, le=1e6)]], Field(min_length=3, max_length=3)]
TaskName = Literal["soles", "torso", "com", "hands"]
PartName = Literal["soles", "torso", "com", "com_xy", "com_z", "hands"]
SolverName = Literal[
    "clik", "ik1", "ik2", "ik3", "ik4", "ik5", "prioritized", "prioritized-acceleration"
]
ChannelName = Literal[
    "com_x", "com_y", "com_z", "torso_roll", "torso_pitch", "torso_yaw",
    "left_hand_x", "left_hand_y", "left_hand_z", "right_hand_x", "right_hand_y", "right_hand_z",
]  # fmt: skip


class WalkParameters(Model):
    """Steps of one walk and their timing; SI units; x forward, y left, z up."""

    n_steps: int = Field(ge=1, le=20_000, description="Steps taken, the closing one included.")
    step_length: Length = Field(
        0.0, description="Advance of the swing sole past the support sole [m]; negative: backward."
    )
    lateral: Length = Field(
        0.0, description="Sideways advance of each step of the leading foot [m]; positive: left."
    )
    step_yaw: float = Field(
        0.0, ge=-1.0, le=1.0, description="Turn of each step [rad]; positive: to the left."
    )
    step_width: float | None = Field(
        None, gt=0.0, le=2.0, description="Distance of the soles [m]; null: as in the posture."
    )
    first_support: Literal["left", "right"] | None = Field(
        None, description="Foot that stands first; null: the one that lets the leading foot begin."
    )
    lead_in: Duration = Field(
        1.8, description="Rest before the first weight shift [s]; at least the preview window."
    )
    double_support: Duration = Field(
        0.2, description="Each phase with both soles down, first and last weight shift too [s]."
    )
    single_support: Duration = Field(0.5, description="Each phase on one sole [s].")
    lead_out: Duration = Field(1.8, description="Rest after the last weight shift [s].")
    step_height: float = Field(
        0.02, gt=0.0, le=0.5, description="Highest point of the swing sole above the ground [m]."
    )
    com_height: float | None = Field(
        None, ge=1e-3, le=3.0, description="Height of the CoM above the ground [m]; null: posture."
    )
    zmp_offset: Annotated[list[Length], Field(min_length=2, max_length=2)] = Field(
        [0.0, 0.0],
        description="Place of the ZMP in a support sole: forward and inward of its centre [m].",
    )

    @model_validator(mode="after")
    def _moves_only_as_a_foot_can(self) -> WalkParameters:
        if self.n_steps == 1 and (self.step_length or self.lateral or self.step_yaw):
            raise ValueError(
                "n_steps = 1 is the closing step alone and goes nowhere; use n_steps >= 2"
            )
        return self


class ComParameters(Model):
    """Preview control of the ZMP (stage 3)."""

    preview: float = Field(1.6, ge=0.1, le=10.0, description="Preview window [s].")
    weight_error: float = Field(
        1.0, gt=0.0, le=1e12, description="Q_e, weight of the ZMP error [1/m^2]."
    )
    weight_jerk: float = Field(
        1e-6, gt=0.0, le=1e6, description="R, weight of the jerk; not invariant to dt [s^6/m^2]."
    )


class Channel(Model):
    """One component of the body's motion, as a displacement from where it stands at rest."""

    task: ChannelName = Field(description="What moves [m] or [rad].")


class ConstantChannel(Channel):
    """A constant displacement."""

    wave: Literal["constant"] = Field(description="Kind of channel.")
    value: Displacement = Field(description="[m] or [rad]")


class SineChannel(Channel):
    """amplitude sin(2 pi frequency t + phase), t from the start of the motion."""

    wave: Literal["sine"] = Field(description="Kind of channel.")
    amplitude: Displacement = Field(description="[m] or [rad]")
    frequency: Frequency = Field(description="[Hz]")
    phase: float = Field(0.0, ge=-10.0, le=10.0, description="[rad]")


class RampChannel(Channel):
    """From 0 to `value` between two times, minimum jerk; stays there."""

    wave: Literal["ramp"] = Field(description="Kind of channel.")
    value: Displacement = Field(description="[m] or [rad]")
    start: float = Field(ge=0.0, le=MAX_SECONDS, description="[s]")
    end: float = Field(ge=0.0, le=MAX_SECONDS, description="[s]")

    @model_validator(mode="after")
    def _ends_after_its_start(self) -> RampChannel:
        if not self.end > self.start:
            raise ValueError(f"end = {self.end:g} s is not after start = {self.start:g} s")
        return self


class FigureEightChannel(Model):
    """A figure eight in a plane: width along its first axis, height along its second."""

    wave: Literal["figure_eight"] = Field(description="Kind of channel.")
    task: Literal["com", "left_hand", "right_hand"] = Field(description="Point that draws it.")
    plane: Literal["xy", "xz", "yx", "yz", "zx", "zy"] = Field("yz", description="Long axis first.")
    width: Displacement = Field(description="From end to end along the first axis [m].")
    height: Displacement = Field(description="From end to end along the second axis [m].")
    frequency: Frequency = Field(description="Eights per second [Hz].")


AnyChannel = Annotated[
    ConstantChannel | SineChannel | RampChannel | FigureEightChannel, Field(discriminator="wave")
]


class BalanceParameters(Model):
    """Both feet stay where they are; CoM, torso and hands follow the sum of their channels.

    Everything is eased in from the half-sitting posture and out to it. Hands without a channel are
    not asked for anything.
    """

    duration: float = Field(gt=0.0, le=MAX_SECONDS, description="Of the whole motion [s].")
    rest: float = Field(0.5, ge=0.0, le=60.0, description="At rest, at either end [s].")
    ease: float = Field(1.0, gt=0.0, le=60.0, description="Fading in, and fading out [s].")
    com_height: float | None = Field(
        None, ge=1e-3, le=3.0, description="Height that com_z adds to [m]; null: posture."
    )
    com_tolerance: float = Field(
        COM_TOLERANCE,
        gt=0.0,
        le=1.0,
        description="How far the CoM may stay behind its reference [m]; more than the default "
        "where more is asked than the robot can reach, which ik1 to ik5 are made for.",
    )
    channels: list[AnyChannel] = Field(
        min_length=1, max_length=100, description="What moves; channels of the same task add up."
    )

    @model_validator(mode="after")
    def _has_room_for_its_ends(self) -> BalanceParameters:
        ends = 2.0 * (self.rest + self.ease)
        if not self.duration > ends:
            raise ValueError(
                f"duration = {self.duration:g} s leaves nothing between the ends, which take "
                f"2 (rest + ease) = {ends:g} s; lengthen duration"
            )
        return self


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


class IkParameters(Model):
    """Inverse kinematics (stage 4)."""

    solver: SolverName = Field("clik", description="Name of the solver.")
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
    iterations: int | None = Field(
        None,
        ge=0,
        le=50,
        description="clik: task-only Newton updates per sample, null: until the tolerance is met; "
        "ik2, ik4, ik5: n, null: 15.",
    )
    on_limit: Literal["refuse", "record"] = Field(
        "refuse", description="What to do when a joint leaves its range."
    )
    faraji: FarajiParameters = FarajiParameters()
    prioritized: PrioritizedParameters = PrioritizedParameters()


class GaitFile(Model):
    """What every gait file has."""

    mgs: FormatVersion = Field(description="Version of this format.")
    robot: str | None = Field(
        None, min_length=1, max_length=4096, description="Shipped robot or a robot folder."
    )
    motion: str
    dt: float = Field(0.01, ge=1e-4, le=0.1, description="Sampling period [s].")

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""
        raise NotImplementedError

    @property
    def com_tolerance(self) -> float:
        """Largest distance of the CoM from its reference that passes [m]."""
        return COM_TOLERANCE

    def to_yaml(self) -> str:
        """The gait as resolved, every default written out."""
        return yaml.safe_dump(self.model_dump(), sort_keys=False, default_flow_style=None)

    def _refuse_too_long(self, remedy: str) -> None:
        if self.duration / self.dt > MAX_SAMPLES:
            raise ValueError(
                f"{self.duration:.0f} s at dt = {self.dt:g} s are {self.duration / self.dt:.2g} "
                f"samples, {MAX_SAMPLES:g} allowed; use {remedy} or a larger dt"
            )


class WalkGait(GaitFile):
    """A gait file with `motion: walk`."""

    motion: Literal["walk"] = Field(description="Kind of motion.")
    walk: WalkParameters
    com: ComParameters = ComParameters()
    ik: IkParameters = IkParameters()

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""
        walk = self.walk
        rests = walk.lead_in + walk.lead_out + walk.double_support
        return rests + walk.n_steps * (walk.double_support + walk.single_support)

    @model_validator(mode="after")
    def _rests_as_long_as_it_previews(self) -> WalkGait:
        for key in ("lead_in", "lead_out"):
            rest = getattr(self.walk, key)
            if rest < self.com.preview:
                raise ValueError(
                    f"walk.{key} = {rest:g} s is shorter than the preview window com.preview = "
                    f"{self.com.preview:g} s; the CoM would not be at rest: lengthen walk.{key}"
                )
        return self

    @model_validator(mode="after")
    def _fits_into_memory(self) -> WalkGait:
        self._refuse_too_long("fewer walk.n_steps")
        return self


class BalanceGait(GaitFile):
    """A gait file with `motion: balance`."""

    motion: Literal["balance"] = Field(description="Kind of motion.")
    balance: BalanceParameters
    ik: IkParameters = IkParameters()

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""
        return self.balance.duration

    @property
    def com_tolerance(self) -> float:
        """Largest distance of the CoM from its reference that passes [m]."""
        return self.balance.com_tolerance

    @model_validator(mode="after")
    def _fits_into_memory(self) -> BalanceGait:
        self._refuse_too_long("a shorter balance.duration")
        return self


Gait = WalkGait | BalanceGait
GAITS: dict[str, type[WalkGait] | type[BalanceGait]] = {"walk": WalkGait, "balance": BalanceGait}


def gait_schema() -> dict[str, Any]:
    """JSON schema of all kinds of gait file."""
    kinds: Any = Annotated[Gait, Field(discriminator="motion")]
    return TypeAdapter(kinds).json_schema()


def load_gait(name_or_path: str | Path, assignments: tuple[str, ...] = ()) -> Gait:
    """Read a gait file, or a shipped gait by name such as `melson/walk_5cm`.

    Args:
        name_or_path: a path, or a name below the folder of shipped gaits.
        assignments: `dotted.key=value`, applied before validation.

    Raises:
        ConfigError: the file is missing or malformed, or a value is out of range.
    """
    path = find_gait(name_or_path)
    return parse_gait(read_text(path), path, assignments)


def parse_gait(text: str, source: str | Path, assignments: tuple[str, ...] = ()) -> Gait:
    """Gait from YAML text; raises ConfigError naming `source`."""
    tree: Any = parse_yaml(text, source)
    for assignment in assignments:
        set_key(tree, assignment)
    return build(_kind_of(tree), tree, source)


def _kind_of(tree: Any) -> type[WalkGait] | type[BalanceGait]:
    """The kind that `motion` names; else one that refuses it and checks the block that is there."""
    kind = tree.get("motion") if isinstance(tree, dict) else None
    if isinstance(kind, str) and kind in GAITS:
        return GAITS[kind]
    looks_like = "balance" if isinstance(tree, dict) and "balance" in tree else "walk"
    any_kind: Any = Literal[tuple(GAITS)]
    return create_model("GaitOfUnknownKind", __base__=GAITS[looks_like], motion=(any_kind, ...))


def find_gait(name_or_path: str | Path) -> Path:
    """Path of a gait given by path or shipped name; raises ConfigError listing what ships."""
    path = Path(name_or_path)
    if is_file(path):
        return path
    shipped = shipped_folder("gaits")
    named = shipped / f"{name_or_path}.yaml"
    if is_file(named) and shipped in named.resolve().parents:
        return named
    names = ", ".join(list_gaits())
    raise ConfigError(name_or_path, f"no such file and no gait of that name; shipped: {names}")


def list_gaits() -> list[str]:
    """Names of the shipped gaits."""
    root = shipped_folder("gaits")
    return sorted(p.relative_to(root).with_suffix("").as_posix() for p in root.rglob("*.yaml"))


def shipped_folder(kind: Literal["gaits", "robots"]) -> Path:
    """Folder of shipped gaits or robots: inside an installed wheel, else beside the package."""
    package = Path(str(importlib.resources.files("mgs")))
    inside = package / "data" / kind
    return (inside if inside.is_dir() else package.parent / kind).resolve()

"""Gait files: what the robot shall do, as written by a person.

The order of the classes is the order of the blocks in a file. SI units; x forward, y left, z up;
angles in rad.
"""

from __future__ import annotations

import importlib.resources
from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import Field, model_validator

from mgs.config import FormatVersion, Model, build, is_file, parse_yaml, read_text, set_key
from mgs.errors import ConfigError

SCHEMA_VERSION = 1
MAX_SAMPLES = 2_000_000  # about 5 GB of arrays

Duration = Annotated[float, Field(gt=0.0, le=60.0)]
Length = Annotated[float, Field(ge=-1.0, le=1.0)]


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


class IkParameters(Model):
    """Inverse kinematics (stage 4)."""

    solver: Literal["clik"] = Field("clik", description="Name of the solver.")
    gamma_joint: float = Field(
        0.35, ge=0.0, le=1e3, description="Gain of the joint-limit gradient [rad^2/s]."
    )
    gamma_grav: float = Field(
        0.0, ge=0.0, le=1e3, description="Gain of the gravity-torque gradient [1/((N m)^2 s)]."
    )
    gamma_grav_ramp: float = Field(
        0.2,
        ge=1e-4,
        le=10.0,
        description="Time over which gamma_grav falls before double support [s].",
    )
    iterations: int | None = Field(
        None,
        ge=0,
        le=50,
        description="Task-only Newton updates per sample; null: until the tolerance is met.",
    )
    on_limit: Literal["refuse", "record"] = Field(
        "refuse", description="What to do when a joint leaves its range."
    )


class Gait(Model):
    """A gait file."""

    mgs: FormatVersion = Field(description="Version of this format.")
    robot: str | None = Field(
        None, min_length=1, max_length=4096, description="Shipped robot or a robot folder."
    )
    motion: Literal["walk"] = Field(description="Kind of motion.")
    dt: float = Field(0.01, ge=1e-4, le=0.1, description="Sampling period [s].")
    walk: WalkParameters
    com: ComParameters = ComParameters()
    ik: IkParameters = IkParameters()

    @model_validator(mode="after")
    def _rests_as_long_as_it_previews(self) -> Gait:
        for key in ("lead_in", "lead_out"):
            rest = getattr(self.walk, key)
            if rest < self.com.preview:
                raise ValueError(
                    f"walk.{key} = {rest:g} s is shorter than the preview window com.preview = "
                    f"{self.com.preview:g} s; the CoM would not be at rest: lengthen walk.{key}"
                )
        return self

    @model_validator(mode="after")
    def _fits_into_memory(self) -> Gait:
        walk = self.walk
        duration = walk.lead_in + walk.lead_out + walk.double_support
        duration += walk.n_steps * (walk.double_support + walk.single_support)
        if duration / self.dt > MAX_SAMPLES:
            raise ValueError(
                f"{duration:.0f} s at dt = {self.dt:g} s are {duration / self.dt:.2g} samples, "
                f"{MAX_SAMPLES:g} allowed; use fewer walk.n_steps or a larger dt"
            )
        return self

    def to_yaml(self) -> str:
        """The gait as resolved, every default written out."""
        return yaml.safe_dump(self.model_dump(), sort_keys=False, default_flow_style=None)


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
    return build(Gait, tree, source)


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

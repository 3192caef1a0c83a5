"""Gait files: one model for each kind of motion."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field, TypeAdapter, model_validator

from mgs.core.arrays import Array
from mgs.core.config import Model, Whole
from mgs.core.geometry import quintic
from mgs.core.limits import MAX_PARTS
from mgs.gait.balance import BalanceParameters
from mgs.gait.com import ComParameters
from mgs.gait.gait_file import GaitFile
from mgs.gait.ik import IkParameters, WholeBodyIkParameters
from mgs.gait.keyframes import KeyframesParameters
from mgs.gait.kick import KickParameters
from mgs.gait.pick_up import PickUpParameters
from mgs.gait.recorded import RecordedGait
from mgs.gait.walk import WalkParameters


class WalkGait(GaitFile):
    """A gait file with `motion: walk`."""

    motion: Literal["walk"] = Field(description="Kind of motion.")
    walk: WalkParameters = Field(
        description="Footsteps, timing and zero-moment point (ZMP) of the walk."
    )
    com: ComParameters = Field(
        default_factory=ComParameters,
        description="Motion of the centre of mass and its correction by the dynamic filter.",
    )
    ik: IkParameters = Field(
        default_factory=IkParameters, description="Inverse kinematics solver and its parameters."
    )

    @property
    def com_tolerance(self) -> float:
        """Largest allowed distance of the CoM from its reference [m]."""
        return self.walk.com_tolerance

    @property
    def planned_duration(self) -> float:
        """Duration of rests and steps [s]; of a walk to a goal the rests alone."""
        walk = self.walk
        rests = walk.lead_in + walk.lead_out + walk.double_support
        return rests + walk.most_steps * (walk.double_support + walk.single_support)

    @model_validator(mode="after")
    def _comes_to_rest(self) -> WalkGait:
        _require_rest(self.motion, self.walk, self.com)
        return self

    @model_validator(mode="after")
    def _fits_into_memory(self) -> WalkGait:
        self._refuse_too_long("fewer walk.n_steps")
        return self


class KickGait(GaitFile):
    """A gait file with `motion: kick`."""

    motion: Literal["kick"] = Field(description="Kind of motion.")
    kick: KickParameters = Field(
        default_factory=KickParameters, description="Ball, strike and timing of the kick."
    )
    com: ComParameters = Field(
        default_factory=ComParameters,
        description="Motion of the centre of mass and its correction by the dynamic filter.",
    )
    ik: IkParameters = Field(
        default_factory=IkParameters, description="Inverse kinematics solver and its parameters."
    )

    @property
    def planned_duration(self) -> float:
        """Duration without the strike [s], whose speed may depend on the robot."""
        kick = self.kick
        moves = 2.0 * (kick.shift + kick.lift) + kick.draw + kick.recover
        return kick.lead_in + moves + kick.lead_out

    @model_validator(mode="after")
    def _fits_into_memory(self) -> KickGait:
        self._refuse_too_long("shorter durations in kick")
        return self

    @model_validator(mode="after")
    def _comes_to_rest(self) -> KickGait:
        _require_rest(self.motion, self.kick, self.com)
        return self


ZmpGait = WalkGait | KickGait  # kinds whose CoM motion follows from the ZMP reference


def _require_rest(block: str, given: WalkParameters | KickParameters, com: ComParameters) -> None:
    """Refuse a rest in the end in which preview control cannot bring the CoM to a standstill.

    At the start it needs no rest: the reference before the motion is its first value.
    """
    if com.generator == "preview" and given.lead_out < com.preview:
        raise ValueError(
            f"{block}.lead_out = {given.lead_out:g} s is shorter than the preview window "
            f"com.preview = {com.preview:g} s, so that the CoM would not come to rest; use a "
            f"longer {block}.lead_out, or com.generator: qp, which needs no such rest"
        )


class BalanceGait(GaitFile):
    """A gait file with `motion: balance`."""

    motion: Literal["balance"] = Field(description="Kind of motion.")
    balance: BalanceParameters = Field(
        description="Displacements of centre of mass, torso and hands."
    )
    ik: IkParameters = Field(
        default_factory=IkParameters, description="Inverse kinematics solver and its parameters."
    )

    @property
    def com_tolerance(self) -> float:
        """Largest allowed distance of the CoM from its reference [m]."""
        return self.balance.com_tolerance

    @property
    def planned_duration(self) -> float:
        """Duration of the motion [s]."""
        return self.balance.duration

    @model_validator(mode="after")
    def _fits_into_memory(self) -> BalanceGait:
        self._refuse_too_long("a shorter balance.duration")
        return self


class KeyframesGait(GaitFile):
    """A gait file with `motion: keyframes`."""

    motion: Literal["keyframes"] = Field(description="Kind of motion.")
    keyframes: KeyframesParameters = Field(description="States of the body over time.")
    ik: WholeBodyIkParameters = Field(
        default_factory=WholeBodyIkParameters,
        description="Inverse kinematics solver and its parameters.",
    )

    @property
    def com_tolerance(self) -> float:
        """Largest allowed distance of the CoM from its reference [m]."""
        return self.keyframes.com_tolerance

    @property
    def is_balanced(self) -> bool:
        """Whether the robot stands on its soles, as planned, at every sample."""
        return self.keyframes.balance == "on"

    @property
    def planned_duration(self) -> float:
        """Duration of the motion [s]."""
        return self.keyframes.duration

    @model_validator(mode="after")
    def _fits_into_memory(self) -> KeyframesGait:
        self._refuse_too_long("earlier keyframes.keys")
        return self


class PickUpGait(GaitFile):
    """A gait file with `motion: pick_up`."""

    motion: Literal["pick_up"] = Field(description="Kind of motion.")
    pick_up: PickUpParameters = Field(description="Object, hand and timing.")
    ik: WholeBodyIkParameters = Field(
        default_factory=WholeBodyIkParameters,
        description="Inverse kinematics solver and its parameters.",
    )

    @property
    def planned_duration(self) -> float:
        """Duration of the motion [s]."""
        return self.pick_up.duration

    @model_validator(mode="after")
    def _fits_into_memory(self) -> PickUpGait:
        self._refuse_too_long("shorter durations in pick_up")
        return self

    def payload(self, times: Array) -> Array | None:
        """Masses (N, 2) in left and right hand [kg]; they increase during the pause."""
        pick_up = self.pick_up
        if not pick_up.payload:
            return None
        hands = {"left": [1.0, 0.0], "right": [0.0, 1.0], "both": [0.5, 0.5]}[pick_up.hand]
        begins = pick_up.times[2]
        taken = quintic((times - begins) / pick_up.pause)
        return np.asarray(pick_up.payload * taken[:, None] * hands)


SingleGait = WalkGait | KickGait | BalanceGait | KeyframesGait | PickUpGait


def _as_written(schema: dict[str, Any]) -> None:
    """Allow the name of a gait and the key `set`, which reading replaces by the resulting gait."""
    gait = schema["properties"]["gait"]
    named = {"type": "string", "minLength": 1}
    schema["properties"]["gait"] = {
        "description": gait.pop("description"), "anyOf": [named, gait]
    }  # fmt: skip
    schema["properties"]["set"] = {
        "description": "Changes of the gait by dotted keys, such as {walk.n_steps: 4}.",
        "type": "object",
    }


class SequencePart(Model):
    """Part of a sequence: one gait, performed once or several times in a row."""

    model_config = ConfigDict(json_schema_extra=_as_written)

    name: str = Field(
        "",
        max_length=200,
        description="Name of the part in messages; empty: the name of the gait, or its kind of "
        "motion.",
    )
    gait: SingleGait = Field(
        discriminator="motion",
        description="Gait of the part: name of a shipped gait; or path of a gait file, relative "
        "to the folder of the sequence file; or the keys of a gait file.",
    )
    repeat: Whole = Field(1, ge=1, le=MAX_PARTS, description="Number of repetitions.")

    @property
    def label(self) -> str:
        """Name of the part in messages."""
        return self.name or self.gait.motion


class SequenceParameters(Model):
    """Parameters of a sequence: gaits one after another, each from where the one before ended."""

    parts: list[SequencePart] = Field(
        min_length=1,
        max_length=MAX_PARTS,
        description="Parts in the order in which they are performed.",
    )
    transition: float = Field(
        1.0,
        ge=0.0,
        le=60.0,
        description="Duration of the transition between two parts if the second part does not "
        "begin in the final posture of the first [s]; 0: such parts are refused.",
    )

    @model_validator(mode="after")
    def _are_not_too_many(self) -> SequenceParameters:
        if (n := sum(part.repeat for part in self.parts)) > MAX_PARTS:
            raise ValueError(f"{n} parts with their repetitions; at most {MAX_PARTS} allowed")
        return self


class SequenceGait(GaitFile):
    """A gait file with `motion: sequence`."""

    motion: Literal["sequence"] = Field(description="Kind of motion.")
    sequence: SequenceParameters = Field(description="Gaits that follow one another.")

    @property
    def com_tolerance(self) -> float:
        """Largest allowed distance of the CoM from its reference [m]: the maximum of all parts."""
        return max(part.gait.com_tolerance for part in self.sequence.parts)

    @property
    def planned_duration(self) -> float:
        """Duration of all parts [s], without transitions and what depends on the robot."""
        return sum(part.repeat * part.gait.planned_duration for part in self.sequence.parts)

    @model_validator(mode="after")
    def _fits_into_memory(self) -> SequenceGait:
        self._refuse_too_long("fewer or shorter sequence.parts")
        return self

    @model_validator(mode="after")
    def _parts_fit_together(self) -> SequenceGait:
        for i, part in enumerate(self.sequence.parts):
            where = f"sequence.parts.{i} ({part.label})"
            if part.gait.dt != self.dt:
                raise ValueError(
                    f"{where}: dt = {part.gait.dt:g} s differs from dt = {self.dt:g} s of the "
                    f"sequence; add set: {{dt: {self.dt:g}}} to this part"
                )
            if not part.gait.is_balanced or part.gait.payload(np.zeros(1)) is not None:
                raise ValueError(
                    f"{where}: a motion without balance or with a payload cannot be part of a "
                    "sequence; make a separate motion of it"
                )
            if part.gait.robot not in (None, self.robot):
                raise ValueError(
                    f"{where}: made for the robot {part.gait.robot}, but the sequence for "
                    f"{self.robot}; add set: {{robot: {self.robot}}} to this part to adopt it"
                )
        return self


PlannedGait = SingleGait | SequenceGait
Gait = PlannedGait | RecordedGait
GAITS: dict[str, type[PlannedGait]] = {  # those that a gait file may ask for
    "walk": WalkGait,
    "kick": KickGait,
    "balance": BalanceGait,
    "keyframes": KeyframesGait,
    "pick_up": PickUpGait,
    "sequence": SequenceGait,
}


def gait_schema() -> dict[str, Any]:
    """JSON schema of all kinds of gait files."""
    kinds: Any = Annotated[PlannedGait, Field(discriminator="motion")]
    return TypeAdapter(kinds).json_schema()

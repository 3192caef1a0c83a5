"""The kinds of gait file, one for each kind of motion."""

from __future__ import annotations

import html
import math
from typing import Annotated, Any, Literal

import numpy as np
import yaml
from pydantic import ConfigDict, Field, TypeAdapter, model_validator

from mgs.core.arrays import Array
from mgs.core.config import FormatVersion, Model
from mgs.core.constants import COM_TOLERANCE
from mgs.core.geometry import quintic
from mgs.gait.balance import BalanceParameters
from mgs.gait.ik import IkParameters, WholeBodyIkParameters
from mgs.gait.keyframes import KeyframesParameters
from mgs.gait.kick import KickParameters
from mgs.gait.pick_up import PickUpParameters
from mgs.gait.walk import ComParameters, WalkParameters

MAX_SAMPLES = 2_000_000  # about 5 GB of arrays
MAX_PARTS = 1000  # of a sequence


class GaitFile(Model):
    """What every gait file has."""

    mgs: FormatVersion = Field(description="Version of this format.")
    robot: str | None = Field(
        None, min_length=1, max_length=4096, description="Shipped robot or a robot folder."
    )
    motion: str
    dt: float = Field(0.01, ge=1e-4, le=0.1, description="Sampling period [s].")

    @property
    def com_tolerance(self) -> float:
        """Largest distance of the CoM from its reference that passes [m]."""
        return COM_TOLERANCE

    @property
    def is_balanced(self) -> bool:
        """Whether the plan knows at every sample how the robot stands."""
        return True

    def payload(self, times: Array) -> Array | None:
        """Masses (N, 2) in left and right hand at times (N,) [s]; None: none at any time."""
        return None

    def to_yaml(self) -> str:
        """The gait as resolved, every default written out."""
        return yaml.safe_dump(self.model_dump(), sort_keys=False, default_flow_style=None)

    def __repr__(self) -> str:
        changed = self.model_dump(exclude_defaults=True, exclude={"mgs", "robot", "motion"})
        told = yaml.safe_dump(changed, sort_keys=False, default_flow_style=True, width=math.inf)
        robot = self.robot or "any robot"
        return f"<{type(self).__name__} for {robot}: {_clipped(told.strip()[1:-1])}>"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """The gait file, every default written out, for a notebook."""
        return f"<pre>{html.escape(self.to_yaml())}</pre>"

    def _refuse_too_long(self, duration: float, remedy: str) -> None:
        if duration / self.dt > MAX_SAMPLES:
            raise ValueError(
                f"{duration:.0f} s at dt = {self.dt:g} s are {duration / self.dt:.2g} samples, "
                f"{MAX_SAMPLES:g} allowed; use {remedy} or a larger dt"
            )


def _clipped(text: str, width: int = 160) -> str:
    return text if len(text) <= width else f"{text[: width - 3]}..."


class WalkGait(GaitFile):
    """A gait file with `motion: walk`."""

    motion: Literal["walk"] = Field(description="Kind of motion.")
    walk: WalkParameters
    com: ComParameters = Field(default_factory=ComParameters)
    ik: IkParameters = Field(default_factory=IkParameters)

    @property
    def com_tolerance(self) -> float:
        """Largest distance of the CoM from its reference that passes [m]."""
        return self.walk.com_tolerance

    @model_validator(mode="after")
    def _rests_as_long_as_it_previews(self) -> WalkGait:
        _require_rests(self.motion, self.walk, self.com)
        return self

    @model_validator(mode="after")
    def _fits_into_memory(self) -> WalkGait:
        walk = self.walk
        rests = walk.lead_in + walk.lead_out + walk.double_support
        steps = walk.most_steps * (walk.double_support + walk.single_support)
        self._refuse_too_long(rests + steps, "fewer walk.n_steps")
        return self


class KickGait(GaitFile):
    """A gait file with `motion: kick`."""

    motion: Literal["kick"] = Field(description="Kind of motion.")
    kick: KickParameters = Field(default_factory=KickParameters)
    com: ComParameters = Field(default_factory=ComParameters)
    ik: IkParameters = Field(default_factory=IkParameters)

    @model_validator(mode="after")
    def _rests_as_long_as_it_previews(self) -> KickGait:
        _require_rests(self.motion, self.kick, self.com)
        return self


ZmpGait = WalkGait | KickGait  # those whose CoM follows from the ZMP


def _require_rests(block: str, given: WalkParameters | KickParameters, com: ComParameters) -> None:
    for key in ("lead_in", "lead_out"):
        rest = getattr(given, key)
        if rest < com.preview:
            raise ValueError(
                f"{block}.{key} = {rest:g} s is shorter than the preview window com.preview = "
                f"{com.preview:g} s; the CoM would not be at rest: lengthen {block}.{key}"
            )


class BalanceGait(GaitFile):
    """A gait file with `motion: balance`."""

    motion: Literal["balance"] = Field(description="Kind of motion.")
    balance: BalanceParameters
    ik: IkParameters = Field(default_factory=IkParameters)

    @property
    def com_tolerance(self) -> float:
        """Largest distance of the CoM from its reference that passes [m]."""
        return self.balance.com_tolerance

    @model_validator(mode="after")
    def _fits_into_memory(self) -> BalanceGait:
        self._refuse_too_long(self.balance.duration, "a shorter balance.duration")
        return self


class KeyframesGait(GaitFile):
    """A gait file with `motion: keyframes`."""

    motion: Literal["keyframes"] = Field(description="Kind of motion.")
    keyframes: KeyframesParameters
    ik: WholeBodyIkParameters = Field(default_factory=WholeBodyIkParameters)

    @property
    def com_tolerance(self) -> float:
        """Largest distance of the CoM from its reference that passes [m]."""
        return self.keyframes.com_tolerance

    @property
    def is_balanced(self) -> bool:
        """Whether the plan knows at every sample how the robot stands."""
        return self.keyframes.balance == "on"

    @model_validator(mode="after")
    def _fits_into_memory(self) -> KeyframesGait:
        self._refuse_too_long(self.keyframes.duration, "earlier keyframes.keys")
        return self


class PickUpGait(GaitFile):
    """A gait file with `motion: pick_up`."""

    motion: Literal["pick_up"] = Field(description="Kind of motion.")
    pick_up: PickUpParameters
    ik: WholeBodyIkParameters = Field(default_factory=WholeBodyIkParameters)

    def payload(self, times: Array) -> Array | None:
        """Masses (N, 2) in left and right hand [kg]; they grow over the pause."""
        pick_up = self.pick_up
        if not pick_up.payload:
            return None
        hands = {"left": [1.0, 0.0], "right": [0.0, 1.0], "both": [0.5, 0.5]}[pick_up.hand]
        begins = pick_up.times[2]
        taken = quintic((times - begins) / pick_up.pause)
        return np.asarray(pick_up.payload * taken[:, None] * hands)


SingleGait = WalkGait | KickGait | BalanceGait | KeyframesGait | PickUpGait


def _as_written(schema: dict[str, Any]) -> None:
    """In a file a part may name its gait and change it; reading puts the outcome in its place."""
    gait = schema["properties"]["gait"]
    named = {"type": "string", "minLength": 1}
    schema["properties"]["gait"] = {
        "description": gait.pop("description"), "anyOf": [named, gait]
    }  # fmt: skip
    schema["properties"]["set"] = {
        "description": "Changes of the gait, applied on reading, such as walk.n_steps: 4.",
        "type": "object",
    }


class SequencePart(Model):
    """One gait of a sequence, once or several times in a row."""

    model_config = ConfigDict(json_schema_extra=_as_written)

    name: str = Field(
        "", max_length=200, description="For messages; empty: that of the gait file, or its motion."
    )
    gait: SingleGait = Field(
        discriminator="motion",
        description="Shipped gait, a path from the file's own folder, or the gait itself.",
    )
    repeat: int = Field(1, ge=1, le=MAX_PARTS, description="Times that it is done.")

    @property
    def label(self) -> str:
        """What messages call it."""
        return self.name or self.gait.motion


class SequenceParameters(Model):
    """Gaits that follow one another; each begins where the one before has ended."""

    parts: list[SequencePart] = Field(
        min_length=1, max_length=MAX_PARTS, description="In this order."
    )
    transition: float = Field(
        1.0,
        ge=0.0,
        le=60.0,
        description="Time between two parts of which one does not begin in the posture that the "
        "other ends in [s]; 0: refuse it.",
    )

    @model_validator(mode="after")
    def _are_not_too_many(self) -> SequenceParameters:
        if (n := sum(part.repeat for part in self.parts)) > MAX_PARTS:
            raise ValueError(f"parts and their repetitions are {n}, {MAX_PARTS} allowed")
        return self


class SequenceGait(GaitFile):
    """A gait file with `motion: sequence`."""

    motion: Literal["sequence"] = Field(description="Kind of motion.")
    sequence: SequenceParameters

    @property
    def com_tolerance(self) -> float:
        """Largest distance of the CoM from its reference that passes [m]: the widest of a part."""
        return max(part.gait.com_tolerance for part in self.sequence.parts)

    @model_validator(mode="after")
    def _parts_fit_together(self) -> SequenceGait:
        for i, part in enumerate(self.sequence.parts):
            where = f"sequence.parts.{i} ({part.label})"
            if part.gait.dt != self.dt:
                raise ValueError(
                    f"{where}: dt = {part.gait.dt:g} s, that of the sequence is {self.dt:g} s; "
                    f"write set: {{dt: {self.dt:g}}} in this part"
                )
            if not part.gait.is_balanced or part.gait.payload(np.zeros(1)) is not None:
                raise ValueError(
                    f"{where}: motions without balance, and payloads, which stay in the hand, have "
                    "no place in a sequence; make a motion of its own of this part"
                )
            if part.gait.robot not in (None, self.robot):
                raise ValueError(
                    f"{where}: made for {part.gait.robot}, the sequence for {self.robot}; write "
                    f"set: {{robot: {self.robot}}} in this part to take it over"
                )
        return self


Gait = SingleGait | SequenceGait
GAITS: dict[str, type[Gait]] = {
    "walk": WalkGait,
    "kick": KickGait,
    "balance": BalanceGait,
    "keyframes": KeyframesGait,
    "pick_up": PickUpGait,
    "sequence": SequenceGait,
}


def gait_schema() -> dict[str, Any]:
    """JSON schema of all kinds of gait file."""
    kinds: Any = Annotated[Gait, Field(discriminator="motion")]
    return TypeAdapter(kinds).json_schema()

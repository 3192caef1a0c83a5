"""The kinds of gait file, one for each kind of motion."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
import yaml
from numpy.typing import NDArray
from pydantic import Field, TypeAdapter, model_validator

from mgs.config import FormatVersion, Model
from mgs.gait.balance import COM_TOLERANCE, BalanceParameters
from mgs.gait.ik import IkParameters, WholeBodyIkParameters
from mgs.gait.keyframes import KeyframesParameters
from mgs.gait.pick_up import PickUpParameters
from mgs.gait.walk import ComParameters, WalkParameters
from mgs.geometry import quintic

Array = NDArray[np.float64]
MAX_SAMPLES = 2_000_000  # about 5 GB of arrays


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

    def _refuse_too_long(self, duration: float, remedy: str) -> None:
        if duration / self.dt > MAX_SAMPLES:
            raise ValueError(
                f"{duration:.0f} s at dt = {self.dt:g} s are {duration / self.dt:.2g} samples, "
                f"{MAX_SAMPLES:g} allowed; use {remedy} or a larger dt"
            )


class WalkGait(GaitFile):
    """A gait file with `motion: walk`."""

    motion: Literal["walk"] = Field(description="Kind of motion.")
    walk: WalkParameters
    com: ComParameters = ComParameters()
    ik: IkParameters = IkParameters()

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
        walk = self.walk
        rests = walk.lead_in + walk.lead_out + walk.double_support
        steps = walk.n_steps * (walk.double_support + walk.single_support)
        self._refuse_too_long(rests + steps, "fewer walk.n_steps")
        return self


class BalanceGait(GaitFile):
    """A gait file with `motion: balance`."""

    motion: Literal["balance"] = Field(description="Kind of motion.")
    balance: BalanceParameters
    ik: IkParameters = IkParameters()

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
    ik: WholeBodyIkParameters = WholeBodyIkParameters()

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
    ik: WholeBodyIkParameters = WholeBodyIkParameters()

    def payload(self, times: Array) -> Array | None:
        """Masses (N, 2) in left and right hand [kg]; they grow over the pause."""
        pick_up = self.pick_up
        if not pick_up.payload:
            return None
        hands = {"left": [1.0, 0.0], "right": [0.0, 1.0], "both": [0.5, 0.5]}[pick_up.hand]
        begins = pick_up.times[2]
        taken = quintic((times - begins) / pick_up.pause)
        return np.asarray(pick_up.payload * taken[:, None] * hands)


Gait = WalkGait | BalanceGait | KeyframesGait | PickUpGait
GAITS: dict[str, type[GaitFile]] = {
    "walk": WalkGait,
    "balance": BalanceGait,
    "keyframes": KeyframesGait,
    "pick_up": PickUpGait,
}


def gait_schema() -> dict[str, Any]:
    """JSON schema of all kinds of gait file."""
    kinds: Any = Annotated[Gait, Field(discriminator="motion")]
    return TypeAdapter(kinds).json_schema()

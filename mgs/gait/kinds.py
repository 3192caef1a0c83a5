"""The kinds of gait file, one for each kind of motion."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import yaml
from pydantic import Field, TypeAdapter, model_validator

from mgs.config import FormatVersion, Model
from mgs.gait.balance import BalanceParameters
from mgs.gait.ik import IkParameters
from mgs.gait.kick import KickParameters
from mgs.gait.walk import COM_TOLERANCE, ComParameters, WalkParameters

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

    def to_yaml(self) -> str:
        """The gait as resolved, every default written out."""
        return yaml.safe_dump(self.model_dump(), sort_keys=False, default_flow_style=None)

    def _refuse_too_long(self, duration: float, remedy: str) -> None:
        if duration / self.dt > MAX_SAMPLES:
            raise ValueError(
                f"{duration:.0f} s at dt = {self.dt:g} s are {duration / self.dt:.2g} samples, "
                f"{MAX_SAMPLES:g} allowed; use {remedy} or a larger dt"
            )


class ZmpGait(GaitFile):
    """A gait whose CoM follows from the ZMP."""

    com: ComParameters = ComParameters()
    ik: IkParameters = IkParameters()

    @model_validator(mode="after")
    def _rests_as_long_as_it_previews(self) -> ZmpGait:
        for key in ("lead_in", "lead_out"):
            rest = getattr(getattr(self, self.motion), key)
            if rest < self.com.preview:
                raise ValueError(
                    f"{self.motion}.{key} = {rest:g} s is shorter than the preview window "
                    f"com.preview = {self.com.preview:g} s; the CoM would not be at rest: lengthen "
                    f"{self.motion}.{key}"
                )
        return self


class WalkGait(ZmpGait):
    """A gait file with `motion: walk`."""

    motion: Literal["walk"] = Field(description="Kind of motion.")
    walk: WalkParameters

    @property
    def com_tolerance(self) -> float:
        """Largest distance of the CoM from its reference that passes [m]."""
        return self.walk.com_tolerance

    @model_validator(mode="after")
    def _fits_into_memory(self) -> WalkGait:
        walk = self.walk
        rests = walk.lead_in + walk.lead_out + walk.double_support
        steps = walk.most_steps * (walk.double_support + walk.single_support)
        self._refuse_too_long(rests + steps, "fewer walk.n_steps")
        return self


class KickGait(ZmpGait):
    """A gait file with `motion: kick`."""

    motion: Literal["kick"] = Field(description="Kind of motion.")
    kick: KickParameters = KickParameters()


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


Gait = WalkGait | KickGait | BalanceGait
GAITS: dict[str, type[Gait]] = {"walk": WalkGait, "kick": KickGait, "balance": BalanceGait}


def gait_schema() -> dict[str, Any]:
    """JSON schema of all kinds of gait file."""
    kinds: Any = Annotated[Gait, Field(discriminator="motion")]
    return TypeAdapter(kinds).json_schema()

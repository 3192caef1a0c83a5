"""What gait files of every kind have in common."""

from __future__ import annotations

import html
import math

from pydantic import Field

from mgs.core.arrays import Array
from mgs.core.config import FormatVersion, Model
from mgs.core.constants import COM_TOLERANCE
from mgs.core.limits import MAX_SAMPLES
from mgs.core.short_text import clipped
from mgs.core.yaml_text import dump_yaml


class GaitFile(Model):
    """Keys that every gait file has."""

    mgs: FormatVersion = Field(description="Version of the file format.")
    robot: str | None = Field(
        None,
        min_length=1,
        max_length=4096,
        description="Name of a shipped robot, or path of a robot folder; null: given by the "
        "option --robot of mgs generate, or by the sequence that contains the gait.",
    )
    motion: str
    dt: float = Field(
        0.01, ge=1e-4, le=0.1, description="Sampling period of the joint trajectory [s]."
    )

    @property
    def com_tolerance(self) -> float:
        """Largest allowed distance of the CoM from its reference [m]."""
        return COM_TOLERANCE

    @property
    def is_balanced(self) -> bool:
        """Whether the robot stands on its soles, as planned, at every sample."""
        return True

    @property
    def has_references(self) -> bool:
        """Whether soles, hands and CoM were planned, so that a motion can miss its plan."""
        return True

    @property
    def planned_duration(self) -> float:
        """Duration of the motion [s], without what depends on the robot: a way to a goal."""
        return 0.0

    def payload(self, times: Array) -> Array | None:
        """Masses (N, 2) in left and right hand [kg] at times (N,) [s]; None: no payload."""
        return None

    def to_yaml(self) -> str:
        """The gait as the text of a gait file that includes all defaults."""
        return dump_yaml(self.model_dump())

    def __repr__(self) -> str:
        changed = self.model_dump(exclude_defaults=True, exclude={"mgs", "robot", "motion"})
        told = dump_yaml(changed, flow=True, width=math.inf)
        robot = self.robot or "any robot"
        return f"<{type(self).__name__} for {robot}: {clipped(told.strip()[1:-1], 160)}>"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """The text of the gait file, all defaults included, for a notebook."""
        return f"<pre>{html.escape(self.to_yaml())}</pre>"

    def _refuse_too_long(self, remedy: str) -> None:
        duration = self.planned_duration
        if duration / self.dt > MAX_SAMPLES:
            raise ValueError(
                f"{duration:.0f} s at dt = {self.dt:g} s are {duration / self.dt:.2g} samples; at "
                f"most {MAX_SAMPLES:g} allowed; use {remedy} or a larger dt"
            )

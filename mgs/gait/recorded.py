"""What stands in the place of a gait in the file of a motion that mgs did not plan."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from mgs.core.config import Model
from mgs.gait.gait_file import GaitFile


class RecordedParameters(Model):
    """Where a recorded motion is from, and what was found out about it."""

    source: str = Field(description="Name of the file that it was read from.")
    layout: str = Field(description="Layout of that file.")
    balanced: bool = Field(
        description="Whether the robot stands on its soles at nearly every sample; else other "
        "parts bear it, or none does, and nothing is said of its balance."
    )
    base: Literal["file", "contacts"] = Field(
        "file",
        description="Where the pose of the base is from: the file, or the contacts of the soles, "
        "since the file has joints only.",
    )
    notes: list[str] = Field([], description="What was decided when the file was read.")


class RecordedGait(GaitFile):
    """A gait in a motion file with `motion: recorded`; no gait file may ask for it."""

    motion: Literal["recorded"] = Field(description="Kind of motion.")
    recorded: RecordedParameters = Field(description="Origin of the motion.")

    @property
    def is_balanced(self) -> bool:
        """Whether the robot stands on its soles at nearly every sample."""
        return self.recorded.balanced

    @property
    def has_references(self) -> bool:
        """Nothing was planned."""
        return False

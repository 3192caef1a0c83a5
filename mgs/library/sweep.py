"""Sweep files: a base gait, what is varied, and how."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema

from mgs.core.config import FormatVersion, Model, build, parse_yaml, read_text

MAX_GAITS = 1_000_000
KINDS = ("values", "linspace", "logspace", "integers", "uniform", "log_uniform")
Ends = Annotated[list[float], Field(min_length=2, max_length=2)]
EndsAndCount = Annotated[list[float], Field(min_length=3, max_length=3)]


class Axis(Model):
    """Values of one key: one of its ways to state them; a plain list is `values`."""

    values: list[Any] | None = Field(
        None, min_length=1, max_length=MAX_GAITS, description="The values themselves."
    )
    linspace: EndsAndCount | None = Field(
        None, description="First, last and number of values, evenly spaced."
    )
    logspace: EndsAndCount | None = Field(
        None, description="First, last and number of values, each the same ratio to the next."
    )
    integers: Annotated[list[int], Field(min_length=2, max_length=2)] | None = Field(
        None, description="First and last of consecutive whole numbers."
    )
    uniform: Ends | None = Field(None, description="Range of draws; not for a grid.")
    log_uniform: Ends | None = Field(
        None, description="Range of draws whose logarithm is uniform; not for a grid."
    )

    @property
    def kind(self) -> str:
        """Which way it is."""
        return next(kind for kind in KINDS if getattr(self, kind) is not None)

    @model_validator(mode="after")
    def _is_stated_once_and_has_values(self) -> Axis:
        given = [kind for kind in KINDS if getattr(self, kind) is not None]
        if len(given) != 1:
            found = " and ".join(given) or "none"
            raise ValueError(f"use a list, or one of {', '.join(KINDS)}; found {found}")
        ends = [float(x) for x in (getattr(self, self.kind))[:2]] if self.kind != "values" else []
        if self.kind in ("integers", "uniform", "log_uniform") and not ends[0] < ends[1]:
            raise ValueError(f"{self.kind}: {ends[0]:g} is not below {ends[1]:g}")
        if self.kind in ("logspace", "log_uniform") and min(ends) <= 0.0:
            raise ValueError(f"{self.kind}: both ends have to be above 0, found {min(ends):g}")
        count = (self.linspace or self.logspace or [0, 0, 1])[2]
        if not (math.floor(count) == count and 1 <= count <= MAX_GAITS):
            raise ValueError(
                f"{self.kind}: the third entry is the number of values, a whole number from 1 to "
                f"{MAX_GAITS}, found {count:g}"
            )
        return self

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """The mapping, or the list that stands for `values`."""
        mapping = handler.resolve_ref_schema(handler(core_schema))
        mapping["minProperties"] = mapping["maxProperties"] = 1
        return {"anyOf": [{"type": "array", "minItems": 1}, mapping]}


def _list_as_values(value: object) -> object:
    return {"values": value} if isinstance(value, list) else value


AnyAxis = Annotated[Axis, BeforeValidator(_list_as_values)]


class Sweep(Model):
    """Which gaits a library has: variations of a base gait."""

    mgs: FormatVersion = Field(description="Version of this format.")
    base: str = Field(
        min_length=1, max_length=4096, description="Gait file or shipped gait that is varied."
    )
    sampling: Literal["grid", "latin_hypercube", "sobol", "table"] = Field(
        "grid",
        description="grid: every combination of all axes; latin_hypercube, sobol: `samples` draws "
        "that fill the space of the axes; table: rows of a CSV file, each with every combination "
        "of the axes, if there are any.",
    )
    samples: int | None = Field(
        None, ge=1, le=MAX_GAITS, description="Number of draws; sobol does best with a power of 2."
    )
    seed: int = Field(0, ge=0, le=2**32 - 1, description="Of the draws.")
    table: str | None = Field(
        None,
        min_length=1,
        max_length=4096,
        description="CSV file, its place relative to the sweep file; its first row names the keys.",
    )
    axes: dict[str, AnyAxis] = Field(
        {}, max_length=50, description="Dotted keys of the gait file and the values that they take."
    )
    filters: list[str] = Field(
        [],
        max_length=100,
        description="Conditions on keys of the gait that all of its variations kept fulfil.",
    )

    @model_validator(mode="after")
    def _is_whole(self) -> Sweep:
        drawn = self.sampling in ("latin_hypercube", "sobol")
        if drawn != (self.samples is not None):
            raise ValueError(
                f"samples: needed, and allowed, with sampling: latin_hypercube and sobol only; "
                f"sampling is {self.sampling}"
            )
        if (self.sampling == "table") != (self.table is not None):
            raise ValueError(
                f"table: needed, and allowed, with sampling: table only; it is {self.sampling}"
            )
        if not self.axes and self.table is None:
            raise ValueError("axes: nothing is varied; name at least one key and its values")
        if not drawn:
            for key, axis in self.axes.items():
                if axis.kind in ("uniform", "log_uniform"):
                    raise ValueError(
                        f"axes.{key}: {axis.kind} is a range to draw from, sampling: "
                        f"{self.sampling} needs values; use linspace or logspace, or sampling: "
                        "latin_hypercube or sobol"
                    )
        return self


def load_sweep(path: Path) -> Sweep:
    """Read a sweep file.

    Raises:
        ConfigError: it is missing or malformed, or a value is out of range.
    """
    return build(Sweep, parse_yaml(read_text(path), path), path)

"""Sweep files: a base gait, the varied keys and their values."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema

from mgs.core.config import FormatVersion, Model, Whole, build
from mgs.core.input_files import read_text
from mgs.core.limits import MAX_GAITS
from mgs.core.yaml_text import parse_yaml

KINDS = ("values", "linspace", "logspace", "integers", "uniform", "log_uniform")
Bounded = Annotated[Whole, Field(ge=-(2**53), le=2**53)]  # as many as numbers of YAML can tell
Ends = Annotated[list[float], Field(min_length=2, max_length=2)]
EndsAndCount = Annotated[list[float], Field(min_length=3, max_length=3)]


class Axis(Model):
    """Values of one key, given by exactly one of these forms; a plain list means `values`."""

    values: list[Any] | None = Field(
        None, min_length=1, max_length=MAX_GAITS, description="List of values of any type."
    )
    linspace: EndsAndCount | None = Field(
        None,
        description="Evenly spaced values, given by first value, last value and number of values; "
        "values in the unit of the key.",
    )
    logspace: EndsAndCount | None = Field(
        None,
        description="Values with a constant ratio between neighbours, given by first value, last "
        "value and number of values; values in the unit of the key.",
    )
    integers: Annotated[list[Bounded], Field(min_length=2, max_length=2)] | None = Field(
        None, description="All integers of a range, given by the first and the last one."
    )
    uniform: Ends | None = Field(
        None,
        description="Range of uniformly distributed random values, given by lower and upper end "
        "in the unit of the key; only with `sampling: latin_hypercube` or `sobol`.",
    )
    log_uniform: Ends | None = Field(
        None,
        description="Range of random values with uniformly distributed logarithm, given by lower "
        "and upper end in the unit of the key; only with `sampling: latin_hypercube` or `sobol`.",
    )

    @property
    def kind(self) -> str:
        """Name of the form that gives the values."""
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
        if ends and not math.isfinite(ends[1] - ends[0]):
            raise ValueError(f"{self.kind}: from {ends[0]:g} to {ends[1]:g} is too wide a range")
        count = (self.linspace or self.logspace or [0, 0, 1])[2]
        if self.integers is not None and self.integers[1] - self.integers[0] >= MAX_GAITS:
            raise ValueError(
                f"integers: from {self.integers[0]} to {self.integers[1]} are more than "
                f"{MAX_GAITS} values; use linspace with a number of values"
            )
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
        """Schema of either a mapping with one key, or a plain list of values."""
        mapping = handler.resolve_ref_schema(handler(core_schema))
        mapping["minProperties"] = mapping["maxProperties"] = 1
        return {"anyOf": [{"type": "array", "minItems": 1}, mapping]}


def _list_as_values(value: object) -> object:
    return {"values": value} if isinstance(value, list) else value


AnyAxis = Annotated[Axis, BeforeValidator(_list_as_values)]


class Sweep(Model):
    """Sweep file: the gaits of a library as variations of a base gait."""

    mgs: FormatVersion = Field(description="Version of the file format.")
    base: str = Field(
        min_length=1,
        max_length=4096,
        description="Base gait: a gait file or the name of a shipped gait.",
    )
    sampling: Literal["grid", "latin_hypercube", "sobol", "table"] = Field(
        "grid",
        description="Method that chooses the gaits. grid: every combination of all axes. "
        "latin_hypercube, sobol: random draws that fill the space of the axes evenly. table: rows "
        "of a CSV file, each combined with every combination of the axes.",
    )
    samples: Whole | None = Field(
        None,
        ge=1,
        le=MAX_GAITS,
        description="Number of random draws for latin_hypercube and sobol; a power of 2 is best "
        "for sobol; null: for grid and table, which draw nothing.",
    )
    seed: Whole = Field(0, ge=0, le=2**32 - 1, description="Seed of the random draws.")
    table: str | None = Field(
        None,
        min_length=1,
        max_length=4096,
        description="Path of the CSV file for `sampling: table`, relative to the sweep file; its "
        "first row holds the keys; null: for the other kinds of sampling.",
    )
    axes: dict[str, AnyAxis] = Field(
        {},
        max_length=50,
        description="Values of each varied key of the gait file, by its dotted name, e.g. "
        "walk.step_length: [0.03, 0.05].",
    )
    filters: list[str] = Field(
        [],
        max_length=100,
        description='Conditions on keys of the gait, e.g. "walk.step_length / walk.single_support '
        '< 0.2"; gaits that do not meet all conditions are left out.',
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
                        f"axes.{key}: {axis.kind} is a range of random values, but sampling: "
                        f"{self.sampling} needs listed values; use linspace or logspace, or "
                        "sampling: latin_hypercube or sobol"
                    )
        return self


def load_sweep(path: Path) -> Sweep:
    """Read a sweep file.

    Raises:
        ConfigError: the file is missing or malformed, or a value is out of range.
    """
    return build(Sweep, parse_yaml(read_text(path), path), path)

"""URDF parser of Pinocchio; its failures are reported as errors in the file."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import pinocchio as pin

from mgs.core.errors import ConfigError

T = TypeVar("T")


def parse_urdf(text: str, source: str) -> pin.Model:
    """Model with a floating base of a URDF text; raises ConfigError naming `source`."""
    return call_parser(lambda: pin.buildModelFromXML(text, pin.JointModelFreeFlyer()), source)


def call_parser(parse: Callable[[], T], source: str) -> T:
    """Result of a Pinocchio parser; raises ConfigError with `source` if the parser fails."""
    try:
        return parse()
    except (RuntimeError, ValueError, ArithmeticError) as error:
        reason = " ".join(str(error).split())
        raise ConfigError(source, f"Pinocchio cannot read it as a URDF: {reason}") from error

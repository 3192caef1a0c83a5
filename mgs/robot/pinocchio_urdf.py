"""URDF parser of Pinocchio; its failures are reported as errors in the file."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar
from xml.etree import ElementTree

import pinocchio as pin

from mgs.core.errors import ConfigError
from mgs.robot.urdf_checks import malformed

T = TypeVar("T")


def parse_urdf(text: str, source: str) -> pin.Model:
    """Model with a floating base of a URDF text.

    Raises:
        ConfigError: the text is not XML, a number or a name in it cannot be taken, or Pinocchio
            cannot read it; the message names `source`.
    """
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise ConfigError(source, f"cannot read it as a URDF: not valid XML: {error}") from error
    if problems := malformed(root, text):
        raise ConfigError(source, problems)
    return call_parser(lambda: pin.buildModelFromXML(text, pin.JointModelFreeFlyer()), source)


def call_parser(parse: Callable[[], T], source: str) -> T:
    """Result of a Pinocchio parser; raises ConfigError with `source` if the parser fails."""
    try:
        return parse()
    except (RuntimeError, ValueError, ArithmeticError) as error:
        reason = " ".join(str(error).split())
        raise ConfigError(source, f"Pinocchio cannot read it as a URDF: {reason}") from error

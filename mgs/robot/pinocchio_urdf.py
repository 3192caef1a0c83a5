"""URDF parser of Pinocchio, given bounded texts; its failures are errors in the file."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar
from xml.etree import ElementTree

import pinocchio as pin

from mgs.core.errors import ConfigError
from mgs.core.short_text import shown
from mgs.robot.urdf_bounds import parse_bounded, refuse_unfit
from mgs.robot.urdf_checks import malformed

T = TypeVar("T")


def parse_urdf(text: str, source: str) -> pin.Model:
    """Model with a floating base of a URDF text.

    Raises:
        ConfigError: the text is not XML, too large, a number or a name in it cannot be taken, or
            Pinocchio cannot read it; the message names `source`.
    """
    safe = bounded(text, source)
    return call_parser(lambda: pin.buildModelFromXML(safe, pin.JointModelFreeFlyer()), source)


def bounded(text: str, source: str) -> str:
    """URDF text written anew, so that Pinocchio reads what has been checked and nothing else.

    Raises:
        ConfigError: it is no XML, too large, malformed, or has shapes that a robot folder may not
            have.
    """
    root = parse_bounded(text, source)
    if problems := malformed(root, text):
        raise ConfigError(source, problems)
    refuse_unfit(root, source)
    return ElementTree.tostring(root, encoding="unicode")


def call_parser(parse: Callable[[], T], source: str) -> T:
    """Result of a Pinocchio parser; raises ConfigError with `source` if the parser fails."""
    try:
        return parse()
    except Exception as error:  # of its bindings, which have types of their own
        reason = shown(error, 300)
        raise ConfigError(source, f"Pinocchio cannot read it as a URDF: {reason}") from error

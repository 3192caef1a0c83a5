"""The sentence that answers an argument of a wrong type.

The front door takes names, paths and objects alike, so a mistaken argument is answered at once
rather than by whatever fails later.
"""

from __future__ import annotations

import reprlib
from pathlib import Path


def wrong_type(argument: str, accepted: str, found: object) -> TypeError:
    """Error to raise for an argument.

    Args:
        argument: what is wrong, such as "the robot".
        accepted: what it may be, such as "a Robot, or the name of one that ships".
        found: what it is.
    """
    kind = type(found).__name__
    told = "None" if found is None else f"{_article(kind)} {kind}: {reprlib.repr(found)}"
    return TypeError(f"{argument} should be {accepted}; found {told}")


def given_path(path: object) -> Path:
    """The path of a file to write; raises TypeError for what is neither a text nor a Path."""
    if not isinstance(path, str | Path):
        raise wrong_type("the path", "a text or a pathlib.Path", path)
    return Path(path)


def _article(noun: str) -> str:
    return "an" if noun[:1].lower() in "aeiou" else "a"

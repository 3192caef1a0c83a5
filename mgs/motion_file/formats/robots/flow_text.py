"""Text that is JSON and YAML alike: what it holds reads the same in both.

YAML 1.1 takes 1e-07 as a text, since its mantissa has no point; JSON allows 1.0e-07, which both
read as a number. Remarks are lines before the content that begin with #, which only YAML allows.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from mgs.core.errors import MotionFileError
from mgs.core.foreign import told_as
from mgs.core.input_files import read_text
from mgs.core.limits import MAX_FILE, MAX_RECORDING
from mgs.core.yaml_text import parse_yaml


def number(value: float) -> str:
    """Shortest text from which the same number is read."""
    text = repr(float(value))
    mantissa, e, exponent = text.partition("e")
    return f"{mantissa}.0e{exponent}" if e and "." not in mantissa else text


def numbers(values: Iterable[float]) -> str:
    """List of numbers."""
    return f"[{', '.join(map(number, values))}]"


def text(value: str) -> str:
    """Text in quotes."""
    return json.dumps(value)


def texts(values: Iterable[str]) -> str:
    """List of texts in quotes."""
    return f"[{', '.join(map(text, values))}]"


def entries(lines: Iterable[str], indent: str = "  ") -> str:
    """List with one entry on each line."""
    return "[\n" + ",\n".join(indent + line for line in lines) + "\n]"


def remarks(lines: Sequence[str]) -> str:
    """Lines before the content that only people read."""
    return "".join(f"# {line}\n" for line in lines)


def read_flow(path: Path, kind: str) -> Any:
    """Content of a text in JSON or YAML.

    Raises:
        ConfigError: the file is missing, too large, or no YAML.
        MotionFileError: it is no JSON and too large to be read as YAML.
    """
    content = read_text(path, MAX_RECORDING, kind)
    start = 0
    while content.startswith("#", start):
        start = content.find("\n", start) + 1 or len(content)

    def failed(reason: str) -> MotionFileError:
        return MotionFileError(path, f"not {kind}: {reason}")

    with told_as(failed):
        try:
            return json.loads(content[start:])
        except json.JSONDecodeError as error:
            if len(content) > MAX_FILE:
                raise failed(f"no JSON ({error}), and too large to be read as YAML") from error
    return parse_yaml(content, path)

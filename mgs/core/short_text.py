"""Values and texts from outside, made short and harmless enough for one line of a message."""

from __future__ import annotations


def shown(value: object, limit: int = 60) -> str:
    """Value as Python writes it, on one line of at most `limit` characters."""
    try:
        text = str(value) if isinstance(value, Exception) else repr(value)
    except ValueError:  # Python writes no integer of more than 4300 digits
        text = "a number of thousands of digits"
    return clipped(text, limit)


def printable(text: str) -> str:
    """Text whose control characters, but for line ends and tabs, are written as in Python."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in "\n\t" else ascii(c)[1:-1] for c in text)


def clipped(text: str, limit: int) -> str:
    """Text on one line of at most `limit` characters, without control characters."""
    text = " ".join(text.split())[: limit + 1]
    text = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)
    return text if len(text) <= limit else text[: limit - 3] + "..."

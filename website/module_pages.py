"""Reference pages of the Python interface: the front door, and every module of every room.

The pages hold directives of mkdocstrings, which reads signatures and docstrings from the sources.
"""

from __future__ import annotations

import inspect
import re
import typing
from pathlib import Path
from typing import Any

import mgs

PACKAGE = Path(mgs.__file__).parent
ROOM = re.compile(r"^\| `(\w+)` \| (.+?) \|", re.MULTILINE)


def rooms() -> dict[str, str]:
    """What each room holds, by its name, as docs/architecture.md says."""
    text = (PACKAGE.parent / "docs" / "architecture.md").read_text(encoding="utf-8")
    return {name: about for name, about in ROOM.findall(text) if (PACKAGE / name).is_dir()}


def front_door_page() -> str:
    """Markdown page of what `import mgs` offers."""
    lines = [
        "# Python interface",
        "",
        "`import mgs` offers these names, and these rooms hold them:",
    ]
    lines += [
        "",
        *(f"- [`mgs.{room}`](python/{room}.md): {about}" for room, about in rooms().items()),
    ]
    lines += ["", "| name | purpose |", "| --- | --- |"]
    for name in sorted(mgs.__all__, key=lambda name: (name.endswith("Error"), name.lower())):
        home = getattr(mgs, name)
        if kinds := typing.get_args(home):
            about = f"One of {', '.join(f'[{kind.__name__}][{_address(kind)}]' for kind in kinds)}."
            lines.append(f"| `mgs.{name}` | {about} |")
        else:
            about = inspect.cleandoc(home.__doc__ or "").partition("\n\n")[0].replace("\n", " ")
            lines.append(f"| [`mgs.{name}`][{_address(home)}] | {about} |")
    return "\n".join([*lines, ""])


def _address(home: Any) -> str:
    return f"{home.__module__}.{home.__qualname__}"


def room_page(room: str) -> str:
    """Markdown page of all modules of a room."""
    lines = [f"# mgs.{room}", "", f"This room holds: {rooms()[room]}.", ""]
    for path in sorted((PACKAGE / room).rglob("*.py")):
        lines += [f"::: {module_name(path)}", ""]
    return "\n".join(lines)


def module_name(path: Path) -> str:
    """Dotted name of a module of mgs."""
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)

"""Folders of the gaits and robots that ship with mgs."""

from __future__ import annotations

import importlib.resources
from pathlib import Path
from typing import Literal


def shipped_folder(kind: Literal["gaits", "robots"]) -> Path:
    """Folder of shipped gaits or robots: inside the installed package, else beside its sources."""
    package = Path(str(importlib.resources.files("mgs")))
    inside = package / "data" / kind
    return (inside if inside.is_dir() else package.parent / kind).resolve()

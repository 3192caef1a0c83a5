"""Import paths of earlier versions: `mgs.errors` is `mgs.core.errors`, the very same module.

A finder instead of files, so that the package's folder shows its rooms alone. It is asked last, and
nothing is imported before somebody uses such a path.
"""

from __future__ import annotations

import importlib
import sys
from importlib.machinery import ModuleSpec
from types import ModuleType

FORMER_PATHS = {
    "mgs.checks": "mgs.judge.motion_checks",
    "mgs.errors": "mgs.core.errors",
    "mgs.verdict": "mgs.judge.verdict",
}


class FormerPaths:
    """Finder and loader (PEP 451) of the modules that have moved."""

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        """What the import system needs to know of a module; None: it has not moved."""
        # a loader in all but its base class: importing importlib.abc takes 9 ms
        return ModuleSpec(name, self) if name in FORMER_PATHS else None  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> None:
        """Leave it to the import system to make an empty module."""

    def exec_module(self, module: ModuleType) -> None:
        """Put the module that has moved in the place of the empty one."""
        sys.modules[module.__name__] = importlib.import_module(FORMER_PATHS[module.__name__])

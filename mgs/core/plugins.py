"""IK solvers and CoM generators by name: those of mgs, and those that other packages register.

A package registers its own under an entry point, and the name becomes a legal value of a gait file:

    [project.entry-points."mgs.ik_solvers"]
    my_solver = "my_package.solver:MySolver"
"""

from __future__ import annotations

import difflib
import importlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mgs
from mgs.core.errors import ConfigError, MgsError


@dataclass(frozen=True)
class Origin:
    """The package that a solver or a generator comes from."""

    name: str
    package: str
    version: str


@dataclass(frozen=True, eq=False)
class Registry:
    """Everything that one key of a gait file may name.

    The classes of mgs are given as `module:class`, so that only the one that is chosen is imported.
    """

    group: str  # of entry points
    key: str  # of the gait file, for messages
    own: Mapping[str, str]

    def names(self) -> list[str]:
        """All legal names, those of mgs first."""
        return [*self.own, *sorted(point.name for point in self._registered())]

    def load(self, name: str) -> Any:
        """The class of a name.

        Raises:
            ConfigError: nothing of that name is installed.
            MgsError: another package registers it and cannot be imported.
        """
        if name in self.own:
            module, _, attribute = self.own[name].partition(":")
            return getattr(importlib.import_module(module), attribute)
        point = self._find(name)
        try:
            return point.load()
        except Exception as error:  # whatever happens while foreign code is imported
            raise MgsError(
                f"{self.key} {name}: {point.value} cannot be imported: {error!r}"
            ) from error

    def origin(self, name: str) -> Origin:
        """The package behind a name; raises ConfigError if nothing of that name is installed."""
        if name in self.own:
            return Origin(name, "mgs", mgs.__version__)
        package = self._find(name).dist
        return Origin(name, package.name, package.version) if package else Origin(name, "", "")

    def _find(self, name: str) -> Any:
        found = [point for point in self._registered() if point.name == name]
        if not found:
            raise ConfigError(self.key, unknown_name(name, self.names()))
        return found[0]

    def _registered(self) -> list[Any]:
        from importlib.metadata import entry_points  # 10 ms, which the names of mgs do without

        return [p for p in entry_points(group=self.group) if p.name not in self.own]


def unknown_name(name: str, known: list[str]) -> str:
    """What to say of a name that is not among the known ones."""
    close = difflib.get_close_matches(name[:100], known, n=1)
    hint = f"did you mean {close[0]!r}? " if close else ""
    return f"{name[:100]!r} is not installed; {hint}known: {', '.join(known)}"


IK_SOLVERS = Registry(
    "mgs.ik_solvers",
    "ik.solver",
    {
        "clik": "mgs.ik_solver.clik:ClosedLoopIk",
        **{f"ik{method}": "mgs.ik_solver.hard_soft:FarajiIk" for method in range(1, 6)},
        "prioritized": "mgs.ik_solver.prioritized:PrioritizedIk",
        "prioritized-acceleration": "mgs.ik_solver.prioritized:PrioritizedIk",
        "trajectory": "mgs.ik_solver.whole_motion:TrajectoryIk",
    },
)
COM_GENERATORS = Registry(
    "mgs.com_generators",
    "com.generator",
    {
        "preview": "mgs.com_generator.preview:PreviewControl",
        "qp": "mgs.com_generator.qp:BoundedZmp",
    },
)

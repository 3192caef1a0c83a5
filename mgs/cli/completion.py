"""Words that the shell completes: gaits, robots, solvers and keys of gait files.

eval "$(_MGS_COMPLETE=bash_source mgs)"        for Bash, in ~/.bashrc
eval "$(_MGS_COMPLETE=zsh_source mgs)"         for Zsh, in ~/.zshrc
_MGS_COMPLETE=fish_source mgs | source         for Fish, in config.fish
"""

from __future__ import annotations

from collections.abc import Iterable

import click
from click.shell_completion import CompletionItem


def complete_gait(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Names of shipped gaits, and files."""
    from mgs.gait import list_gaits

    return [*_matching(list_gaits(), incomplete), CompletionItem(incomplete, type="file")]


def complete_robot(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Names of shipped robots, and folders."""
    from mgs.robot import list_robots

    return [*_matching(list_robots(), incomplete), CompletionItem(incomplete, type="dir")]


def complete_solver(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Names of the inverse-kinematics solvers of mgs."""
    from mgs.core.plugins import IK_SOLVERS

    return _matching(sorted(IK_SOLVERS.own), incomplete)


def complete_key(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Dotted keys of the gait that is named on the line, each with the sign = behind it."""
    from mgs.core.errors import MgsError
    from mgs.gait import load_gait

    try:
        # while an option lacks its value, click leaves the other words in `args`
        gait = ctx.params.get("gait") or next(iter(ctx.args), "")
        content = load_gait(str(gait)).model_dump()
    except MgsError:
        return []
    return _matching((f"{key}=" for key in _keys(content)), incomplete)


def _keys(content: dict[str, object], above: str = "") -> Iterable[str]:
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _keys(value, f"{above}{name}.")
        else:
            yield f"{above}{name}"


def _matching(words: Iterable[str], incomplete: str) -> list[CompletionItem]:
    return [CompletionItem(word) for word in words if word.startswith(incomplete)]

"""The command mgs audit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.colour import bad, good
from mgs.cli.common import json_option, print_json, say, with_progress
from mgs.cli.foreign_options import either_of, foreign_argument, foreign_options

if TYPE_CHECKING:
    from mgs.judge.audit import Audit
    from mgs.judge.recorded import Choices
    from mgs.judge.verdict import Verdict
    from mgs.motion import Motion

MOST_OF_A_KIND = 8  # findings of one kind that are printed


@click.command()
@foreign_argument
@foreign_options
@click.option(
    "--physics", metavar="ENGINES",
    help="Also replay the motion open loop: pybullet, mujoco or pybullet,mujoco. Default: none.",
)  # fmt: skip
@click.option(
    "--format", "fmt", type=click.Choice(["text", "github"]), default="text", show_default=True,
    help="github: findings as annotations for GitHub Actions.",
)  # fmt: skip
@json_option
@click.pass_context
def audit(
    ctx: click.Context,
    file: Path,
    robot: str | None,
    layout: str | None,
    choices: Choices,
    physics: str | None,
    fmt: str,
    as_json: bool,
) -> None:
    """Find what is wrong with a motion, whoever made it.

    Reads FILE, a motion file (MCAP) or a file in one of the layouts that mgs import reads, which
    needs --robot. Contacts are found from the motion. Findings: parts below the floor, a robot that
    floats, soles that slip, joints outside their ranges or beyond their servos in speed or torque,
    links that collide, a zero-moment point (ZMP) outside the soles, jitter and jumps; and in what
    the file states: velocities that are not those of the positions, a wrong clock, frame or order
    of quaternions. Each has its time, amount, limit and place. docs/audit.md explains them.

    An audit takes a small part of the duration of the motion. mgs validate judges motions that mgs
    has planned by stricter checks.

    Exit code 0 if nothing is found, 1 if something is, 2 if the file cannot be read.

    \b
    Examples:
      mgs audit walk.mcap
      mgs audit dance.csv --robot robots/g1 --fps 30
      mgs audit walk.mcap --physics mujoco --json
      mgs audit walk.mcap --format github
    """  # noqa: D301
    import mgs
    from mgs.judge.audit import audit as run
    from mgs.judge.recorded import motion_of

    found, placed, motion = either_of(file, robot, layout, choices)
    notes = [] if motion is not None else [f"layout {found}", *placed.notes]
    if motion is None and physics:
        motion = motion_of(placed, found, file.name, mgs.__version__, file.stem)
    result = with_progress(file.name, lambda bar: run(placed.given, bar, name=str(file)))
    verdict = _replayed(motion, physics) if motion is not None and physics else None
    if as_json:
        replayed = None if verdict is None else verdict.to_dict()
        print_json({**result.to_dict(), "notes": notes, "physics": replayed})
    elif fmt == "github":
        _print_annotations(result, str(file))
    else:
        _print_text(result, notes)
    if verdict is not None and not as_json:
        _print_verdict(verdict)
    passed = result.clean and (verdict is None or verdict.passed)
    ctx.exit(0 if passed else 1)


def _replayed(motion: Motion, physics: str) -> Verdict:
    """Verdict on the replays alone; static checks are the audit's."""
    import dataclasses

    from mgs.judge.validate import validate

    verdict = validate(motion, physics=physics)
    engines = tuple(f"{engine}_" for engine in verdict.engines)
    kept = tuple(check for check in verdict.checks if check.name.startswith(engines))
    return dataclasses.replace(verdict, checks=kept)


def _print_text(result: Audit, notes: list[str]) -> None:
    from mgs.judge.audit import KINDS

    for note in notes:
        say(f"note: {note}")
    contacts = ", ".join(f"{name} {time:.2f} s" for name, time in result.contacts.items() if time)
    if contacts:
        say(f"contacts: {contacts}; balance judged for {result.balance_judged:.2f} s")
    for kind in result.kinds:
        found = [finding for finding in result.findings if finding.kind == kind]
        say(f"{bad(kind)}: {KINDS[kind]}")
        for finding in found[:MOST_OF_A_KIND]:
            unit = f" {finding.unit}" if finding.unit else ""
            where = f"  {finding.where}" if finding.where else ""
            say(
                f"  {finding.start:7.2f} to {finding.end:.2f} s: {finding.amount:.4g}{unit} at "
                f"{finding.time:.2f} s (limit {finding.limit:.4g}){where}"
            )
        if len(found) > MOST_OF_A_KIND:
            say(f"  and {len(found) - MOST_OF_A_KIND} more, see --json")
    n = len(result.findings)
    say(good("CLEAN") if result.clean else f"{bad('FINDINGS')}: {n} of {len(result.kinds)} kinds")


def _print_annotations(result: Audit, file: str) -> None:
    from mgs.judge.audit import annotation

    for finding in result.findings:
        say(annotation(finding, file))


def _print_verdict(verdict: Verdict) -> None:
    from mgs.cli import verdict_text

    for check in verdict.checks:
        say(verdict_text.line(check))
    for replay in verdict.replays:
        say(verdict_text.sentence(replay))

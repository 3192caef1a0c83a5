"""Generate and judge every shipped gait; write docs/gallery.md and the pictures in docs/gallery/.

python benchmarks/gallery.py                 all gaits; same as `make gallery`
python benchmarks/gallery.py melson/kick     the given gaits: table rows on stdout, and pictures
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mgs.core.atomic_files import replace_file
from mgs.gait import list_gaits, load_gait
from mgs.judge.motion_checks import Check, check_motion, zmp_margins
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.pipeline import generate
from mgs.report import write_picture
from mgs.robot import is_modelled, load_robot
from mgs.sim import SERVOS, available_engines, replay

DOCS = Path(__file__).parent.parent / "docs"
HEAD = """# Gallery

This page shows all shipped gaits, as generated and judged by `make gallery`: by static checks, and
by an open-loop replay in each physics engine with ideal servos, with those of the robot's model
and with plain PD servos that sag 1 deg at stall torque.

Abbreviations: CoM is the centre of mass, ZMP the zero-moment point.

- Displacement: change of the midpoint of the soles from start to end.
- ZMP margin: least distance of the ZMP from the edge of the support polygon, over the whole motion
  on level ground.
- Speed, torque: largest ratio of joint speed or torque to the limit of the servo at that instant.
- Static checks and engines: `pass`, or the names of the failed checks.

"""


@dataclass(frozen=True)
class Entry:
    """Row and picture of one gait."""

    name: str
    note: str  # comment at the top of the gait file
    row: str
    picture: str


def main() -> None:
    """Write the page, or print the rows of some gaits."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("gaits", nargs="*", help="names of gaits; default: all shipped gaits")
    names = parser.parse_args().gaits
    print(header(), flush=True)
    entries = []
    for name in names or list_gaits():
        if load_gait(name).robot is None:  # a generic gait names no robot
            continue
        entries.append(entry(name))
        print(entries[-1].row, flush=True)
    if not names:
        replace_file(DOCS / "gallery.md", page(entries).encode())


def header() -> str:
    """Header of the table."""
    engines = " | ".join(f"{engine}, ideal / modelled / PD" for engine in available_engines())
    columns = (
        "gait | robot | duration | displacement | ZMP margin | speed | torque | static checks | "
        f"{engines}"
    )
    return f"| {columns} |\n| --- " + "| --- " * columns.count("|") + "|"


def page(entries: list[Entry]) -> str:
    """Page as Markdown."""
    rows = "\n".join(entry.row for entry in entries)
    pictures = "\n\n".join(
        f"## {entry.name}\n\n{entry.note}\n\n{moving(entry)}"
        f"![{entry.name}](gallery/{entry.picture})"
        for entry in entries
    )
    return f"{HEAD}{header()}\n{rows}\n\n{pictures}\n"


def moving(entry: Entry) -> str:
    """The moving picture of a gait, if website/moving_pictures.py has made one."""
    picture = Path(entry.picture).with_suffix(".gif")
    if not (DOCS / "gallery" / picture).exists():
        return ""
    return f"![{entry.name}, moving](gallery/{picture})\n\n"


def entry(name: str) -> Entry:
    """Generate, judge and draw one gait."""
    gait = load_gait(name)
    assert gait.robot is not None
    motion = generate(load_robot(gait.robot), gait, name).motion
    checks = {check.name: check for check in check_motion(motion)}
    failed = [check.name for check in checks.values() if not check.ok]
    physics = []
    for engine in available_engines():
        fates = []
        for servo in SERVOS:
            if servo == "model" and not is_modelled(motion.robot):
                fates.append("none")
                continue
            result = replay(motion, engine, servo=servo)
            bad = [check.name.removeprefix(f"{engine}_") for check in replay_checks(result)
                   if not check.ok]  # fmt: skip
            fates.append("pass" if not bad else f"FAIL: {', '.join(bad)}")
        physics.append(" / ".join(fates))
    picture = f"{name.replace('/', '-')}.png"
    verdict = f"fails {', '.join(failed)}" if failed else "static checks pass"
    write_picture(motion, DOCS / "gallery" / picture, force=True, verdict=verdict)
    cells = [
        name,
        motion.robot.spec.name,
        f"{motion.duration:.1f} s",
        way(motion),
        margin(motion),
        ratio(checks.get("joint_speed")),
        ratio(checks.get("joint_torque")),
        "pass" if not failed else f"FAIL: {', '.join(failed)}",
        *physics,
    ]
    return Entry(name, note_of(name), f"| {' | '.join(cells)} |", picture)


def way(motion: Motion) -> str:
    """Displacement and rotation of the midpoint of the soles from start to end."""
    if not motion.gait.is_balanced:
        return ""
    middle = motion.soles[:, :, :3].mean(axis=1)
    x, y, z = middle[-1] - middle[0]
    turn = np.degrees(motion.footsteps[-1].yaw - motion.footsteps[0].yaw)
    parts = []
    if np.hypot(x, y) > 1e-3:
        parts.append(f"{x:+.2f}, {y:+.2f} m")
    if abs(turn) > 0.1:
        parts.append(f"{turn:+.0f} deg")
    if abs(z) > 1e-3:
        parts.append(f"{1e3 * z:+.0f} mm up")
    return ", ".join(parts) or "on the spot"


def ratio(check: Check | None) -> str:
    """Value of a check as a percentage of its limit; empty if the check was not made."""
    return "" if check is None else f"{100 * check.value / check.limit:.0f} %"


def margin(motion: Motion) -> str:
    """Least margin of the ZMP over all samples with a support polygon."""
    if not motion.gait.is_balanced:
        return ""
    margins = zmp_margins(motion, motion.zmp)
    return f"{1e3 * margins[np.isfinite(margins)].min():.1f} mm"


def note_of(name: str) -> str:
    """Comment at the top of a gait file."""
    path = Path(__file__).parent.parent / "gaits" / f"{name}.yaml"
    lines = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.removeprefix("#").strip())
    return " ".join(lines)


if __name__ == "__main__":
    main()

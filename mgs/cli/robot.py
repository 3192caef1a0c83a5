"""The commands mgs robot list, show, check and init."""

from __future__ import annotations

from pathlib import Path

import click

from mgs.cli.common import force_option, json_option, print_json, say


@click.group()
def robot() -> None:
    """List, show, check and create robot descriptions.

    A robot description is a folder with robot.urdf and robot.yaml; mgs schema robot describes
    robot.yaml.

    \b
    Examples:
      mgs robot list
      mgs robot init some.urdf -o robots/mine
      mgs robot check robots/mine
    """  # noqa: D301


@robot.command("list", short_help="List the names of the shipped robots.")
@json_option
def list_command(as_json: bool) -> None:
    """List the names of the shipped robots.

    \b
    Example:
      mgs robot list
    """  # noqa: D301
    from mgs.robot import list_robots

    if as_json:
        print_json({"robots": list_robots()})
    else:
        for name in list_robots():
            say(name)


@robot.command(short_help="Show mass, soles, joints, limits and servos of a robot.")
@click.argument("name", metavar="NAME_OR_DIR")
@json_option
def show(name: str, as_json: bool) -> None:
    """Show mass, soles, joints, limits, servos and roles of a robot.

    NAME_OR_DIR is the name of a shipped robot or a robot folder. Gaits for any robot name joints by
    their roles, such as left_knee.

    \b
    Example:
      mgs robot show melson
    """  # noqa: D301
    from dataclasses import asdict

    from mgs.core.contact import Side
    from mgs.robot import load_robot
    from mgs.robot.roles import find_roles

    model = load_robot(name)
    roles = {at.joint: role for role, at in find_roles(model).items()}
    joints = [
        {
            "joint": joint,
            "role": roles.get(i),
            "servo": model.servo_of(joint),
            "lower": float(model.lower[i]),
            "upper": float(model.upper[i]),
            "posture": float(model.posture[i]),
            "speed_limit": float(model.speed_limit[i]),
            "stall_torque": float(model.torque_limit[i]),
            **({"follows": asdict(model.followers[joint])} if joint in model.followers else {}),
        }
        for i, joint in enumerate(model.joint_names)
    ]
    soles = {s.label: [model.sole_spec(s).length, model.sole_spec(s).width] for s in Side}
    if as_json:
        print_json({"robot": model.spec.name, "mass": model.mass, "soles": soles, "joints": joints})
        return
    sizes = " and ".join(f"{1e3 * x:.0f} x {1e3 * y:.0f} mm" for x, y in soles.values())
    say(f"{model.spec.name}: {model.n} joints, {model.mass:.3f} kg")
    say(f"soles, left and right: {sizes}")
    say(
        f"{'joint':24s} {'servo':8s} {'range [deg]':>16s} {'posture':>8s} {'rad/s':>6s} {'N m':>5s}"
        "  role"
    )
    for row, joint in zip(joints, model.joint_names, strict=True):
        degrees = [
            57.29577951308232 * float(str(row[key])) for key in ("lower", "upper", "posture")
        ]
        say(
            f"{joint:24s} {row['servo']!s:8s} {degrees[0]:7.1f} ..{degrees[1]:6.1f} "
            f"{degrees[2]:8.1f} {row['speed_limit']:6.2f} {row['stall_torque']:5.2f}"
            f"  {row['role'] or '-'}"
        )
    for name, follower in model.followers.items():
        say(
            f"{name} = {follower.multiplier:g} {follower.leader} {follower.offset:+g} rad, turned "
            "by the same motor"
        )


@robot.command(short_help="Check a robot folder for errors.")
@click.argument("name", metavar="NAME_OR_DIR")
@json_option
@click.pass_context
def check(ctx: click.Context, name: str, as_json: bool) -> None:
    """Check a robot folder for errors.

    NAME_OR_DIR is the name of a shipped robot or a robot folder. The checks cover inertias, legs,
    symmetry, joint limits, soles, balance and collisions in the half-sitting posture. If all of
    them pass, every installed physics engine loads the robot, and the default walk is planned and
    checked, without physics. Each failed check is printed with a remedy. Exit code 1 if a check
    fails.

    \b
    Example:
      mgs robot check robots/mine
    """  # noqa: D301
    from dataclasses import asdict

    from mgs.robot import load_robot
    from mgs.robot.soundness import check_robot
    from mgs.search.default_walk import check_use

    model = load_robot(name)
    findings = check_robot(model)
    if all(finding.ok for finding in findings):
        findings += check_use(model)
    if as_json:
        print_json({"robot": name, "findings": [asdict(finding) for finding in findings]})
    else:
        for finding in findings:
            say(f"{'ok  ' if finding.ok else 'FAIL'} {finding.name:12s} {finding.figure}")
            if not finding.ok:
                say(f"     remedy: {finding.remedy}")
    ctx.exit(0 if all(finding.ok for finding in findings) else 1)


@robot.command(short_help="Create a first robot folder from the URDF or MJCF of a humanoid.")
@click.argument("urdf", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path))
@click.option(
    "-o", "--output", "folder", required=True, metavar="DIR",
    type=click.Path(file_okay=False, path_type=Path), help="Robot folder to write.",
)  # fmt: skip
@click.option(
    "--package-path", "package_paths", metavar="DIR", multiple=True,
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Folder in which the packages of package:// and model:// names are searched, or in which "
    "an MJCF has meshes and included files besides its own folder. May be repeated.",
)  # fmt: skip
@click.option("--name", metavar="NAME", help="Name of the robot. Default: the name in the file.")
@force_option
@json_option
def init(
    urdf: Path,
    folder: Path,
    package_paths: tuple[Path, ...],
    name: str | None,
    force: bool,
    as_json: bool,
) -> None:
    """Create a first robot folder from the URDF or MJCF of a humanoid.

    Reads FILE, a URDF or an MJCF as its root element says, and writes robot.urdf (a cleaned copy
    without meshes), robot.yaml and README.md into DIR. Legs, soles, hands, posture and servo limits
    are guessed from FILE; robot.yaml marks every guess. Exit code 2 if the file does not describe a
    robot that stands on two legs.

    \b
    Examples:
      mgs robot init some.urdf -o robots/mine
      mgs robot init some.urdf -o robots/mine --package-path ~/ros/src
      mgs robot init some.xml -o robots/mine
    """  # noqa: D301
    from dataclasses import asdict

    from mgs.robot.init import init_robot, write_robot
    from mgs.robot.soundness import check_robot

    draft = init_robot(urdf, name, package_paths)
    write_robot(draft, folder, force)
    found = draft.robot
    findings = check_robot(found)
    soles = {
        side: [spec.length, spec.width]
        for side, spec in (("left", found.spec.soles.left), ("right", found.spec.soles.right))
    }
    if as_json:
        print_json(
            {
                "folder": str(folder),
                "robot": found.spec.name,
                "mass": found.mass,
                "soles": soles,
                "groups": found.spec.groups,
                "locked": sorted(found.spec.locked),
                "notes": draft.notes,
                "findings": [asdict(finding) for finding in findings],
            }
        )
        return
    say(
        f"{click.format_filename(folder)}\n"
        f"  robot   {found.spec.name}, {found.n} joints, {found.mass:.2f} kg\n"
        f"  soles   {1e3 * soles['left'][0]:.0f} x {1e3 * soles['left'][1]:.0f} mm"
    )
    for group, joints in found.spec.groups.items():
        say(f"  {group:9s} {', '.join(joints)}")
    if found.spec.locked:
        say(f"  locked    {', '.join(sorted(found.spec.locked))}")
    for note in draft.notes:
        say(f"  note      {note}")
    for finding in findings:
        if not finding.ok:
            say(f"  FAIL      {finding.name}: {finding.figure}")
            say(f"            {finding.remedy}")

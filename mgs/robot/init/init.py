"""From a URDF to the three files of a robot folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pinocchio as pin

from mgs.core.atomic_files import replace_file
from mgs.core.contact import Side
from mgs.core.errors import ConfigError, OutputExistsError
from mgs.robot.build import build_robot
from mgs.robot.init.anatomy import Anatomy, find_anatomy, heading
from mgs.robot.init.bodies import clean_shapes, cleaned_urdf, link_names, mended_inertias
from mgs.robot.init.collisions import touching_pairs
from mgs.robot.init.figures import servo_figures
from mgs.robot.init.posture import NEAR, find_posture, hand_point, leg_length
from mgs.robot.init.skeleton import Skeleton, build_skeleton
from mgs.robot.init.sole import Sole, find_sole
from mgs.robot.init.source import Source, read_source, turn
from mgs.robot.init.text import Draft, readme, robot_yaml
from mgs.robot.robot import Robot

LEAST_SOLE, LARGEST_SOLE = 0.03, 0.8  # of the leg length; below: a point, beyond: no foot
LEAST_LEG_JOINTS = 5
MOST_LISTED = 5


@dataclass(frozen=True, eq=False)
class DraftFolder:
    """Content of a robot folder, and the robot that it makes."""

    urdf: str
    yaml: str
    readme: str
    robot: Robot
    notes: list[str]  # what was changed and what wants a look


def init_robot(
    urdf: Path, name: str | None = None, package_paths: tuple[Path, ...] = ()
) -> DraftFolder:
    """Read a humanoid's URDF and draft a robot folder.

    Args:
        urdf: the file.
        name: of the robot; None: as the URDF calls it.
        package_paths: folders in which package:// names are looked for first.

    Raises:
        ConfigError: the file is no URDF, or no robot that stands on two soles; says why.
    """
    source, skeleton = _read(urdf, package_paths)
    anatomy = find_anatomy(skeleton, source)
    soles = _soles(skeleton, anatomy, source)
    leg = leg_length(skeleton, anatomy.legs[0], soles[0])
    _refuse_unfit(skeleton, anatomy, soles, leg, source)
    notes = source.notes
    mass = float(pin.computeTotalMass(skeleton.model))
    figures = servo_figures(skeleton, anatomy, source.root, mass, leg)
    torque = {joint: found.effort for joint, found in figures.items()}
    posture = find_posture(skeleton, anatomy, soles, torque)
    if posture.sole_error > NEAR:
        notes.append(
            f"no posture found with both soles level: {posture.sole_error:.2g} m or rad are left"
        )
    links = link_names(skeleton, source.root)
    inertias = mended_inertias(skeleton, leg, links, notes)
    shapes = clean_shapes(skeleton, anatomy, soles, posture.q, notes)
    arms = anatomy.arms
    draft = Draft(
        name=name or source.name,
        skeleton=skeleton,
        links=links,
        anatomy=anatomy,
        soles=soles,
        hands=(hand_point(skeleton, arms[0][-1]), hand_point(skeleton, arms[1][-1]))
        if arms
        else None,
        q=posture.q,
        figures=figures,
        ignored=[],
    )
    efforts = {joint: (found.effort, found.velocity) for joint, found in figures.items()}
    urdf_text = cleaned_urdf(draft.name, skeleton, links, shapes, inertias, efforts)
    robot = build_robot(robot_yaml(draft), urdf_text, urdf)
    draft.ignored.extend(touching_pairs(robot, {draft.links[b] for b in _shins(anatomy)}))
    text = robot_yaml(draft)
    return DraftFolder(
        urdf=urdf_text,
        yaml=text,
        readme=readme(draft, urdf.name, notes),
        robot=build_robot(text, urdf_text, urdf),
        notes=notes,
    )


def write_robot(draft: DraftFolder, folder: Path, force: bool = False) -> None:
    """Write robot.urdf, README.md and robot.yaml.

    Raises:
        OutputExistsError: one of them is there, and not `force`.
        MgsError: the folder cannot be written.
    """
    files = {"robot.urdf": draft.urdf, "README.md": draft.readme, "robot.yaml": draft.yaml}
    for name in files:
        if (folder / name).exists() and not force:
            raise OutputExistsError(folder / name)
    for name, text in files.items():
        replace_file(folder / name, text.encode())


def _read(urdf: Path, package_paths: tuple[Path, ...]) -> tuple[Source, Skeleton]:
    """Source and skeleton, x axis of the base where the robot looks."""
    source = read_source(urdf)
    skeleton = build_skeleton(source, package_paths)
    if yaw := heading(skeleton, source):
        turn(source, yaw)
        skeleton = build_skeleton(source, package_paths)
    if skeleton.missing:
        source.notes.append(
            f"{len(skeleton.missing)} mesh files not found, first {skeleton.missing[0]}: give "
            "their folder with --package-path"
        )
    return source, skeleton


def _soles(skeleton: Skeleton, anatomy: Anatomy, source: Source) -> tuple[Sole, Sole]:
    for foot in anatomy.feet:
        bare = [body for body in skeleton.below(foot) if not skeleton.surfaces[body]]
        if bare:
            lost = f" ({', '.join(skeleton.missing[:MOST_LISTED])})" if skeleton.missing else ""
            raise ConfigError(
                source.path,
                f"foot {skeleton.links[bare[-1]][0]} has no shape that could be read{lost}, its "
                "sole is not known: give the folder of its meshes with --package-path, or the link "
                "a collision box",
            )
    left, right = (find_sole(skeleton.points(f), skeleton.placements[f]) for f in anatomy.feet)
    return left, right


def _refuse_unfit(
    skeleton: Skeleton, anatomy: Anatomy, soles: tuple[Sole, Sole], leg: float, source: Source
) -> None:
    """Raise ConfigError where there are no soles to stand on or too few joints to place them."""
    for side in Side:
        sole, link = soles[side], skeleton.links[anatomy.feet[side]][0]
        size = f"{1e3 * sole.length:.0f} x {1e3 * sole.width:.0f} mm"
        if min(sole.length, sole.width) < LEAST_SOLE * leg:
            raise ConfigError(
                source.path,
                f"point feet: link {link} stands on {size}, below {1e3 * LEAST_SOLE * leg:.0f} mm; "
                "a ZMP needs soles that it can stay in",
            )
        if max(sole.length, sole.width) > LARGEST_SOLE * leg:
            raise ConfigError(
                source.path,
                f"link {link}, the lowest, would stand on {size} under a leg of "
                f"{1e3 * leg:.0f} mm: these are no feet; are the legs in the file?",
            )
    n = len(anatomy.legs[0])
    if n < LEAST_LEG_JOINTS:
        raise ConfigError(
            source.path,
            f"{n} joints per leg ({', '.join(skeleton.name(j) for j in anatomy.legs[0])}), at "
            f"least {LEAST_LEG_JOINTS} are needed to keep a sole level where it is put",
        )


def _shins(anatomy: Anatomy) -> list[int]:
    """The lower half of either leg: what must never touch the other one."""
    return [joint for leg in anatomy.legs for joint in leg[len(leg) // 2 :]]

"""Draft of the three files of a robot folder from a URDF or an MJCF."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.atomic_files import refuse_taken, replace_files
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.foreign import told_as
from mgs.core.short_text import clipped, shown
from mgs.robot.build import build_robot
from mgs.robot.init.anatomy import Anatomy, find_anatomy
from mgs.robot.init.bodies import clean_shapes, cleaned_urdf, link_names, mended_inertias
from mgs.robot.init.clearance import kept_apart, with_clear_arms
from mgs.robot.init.collisions import touching_pairs
from mgs.robot.init.coupled import free_leg_followers
from mgs.robot.init.facing import heading
from mgs.robot.init.figures import servo_figures
from mgs.robot.init.looks import find_looks
from mgs.robot.init.posture import NEAR, find_posture, hand_point, leg_length
from mgs.robot.init.skeleton import Skeleton, build_skeleton
from mgs.robot.init.sole import Sole, find_sole
from mgs.robot.init.source import Source, read_source, turn
from mgs.robot.init.text import Draft, readme, robot_yaml
from mgs.robot.robot import Robot

LEAST_SOLE, LARGEST_SOLE = 0.03, 0.8  # range of plausible sole sizes, as parts of the leg length
LEAST_LEG_JOINTS = 5
TALLEST = 10.0  # [m] largest plausible distance of the highest joint from the lowest one
LARGEST_SHAPE = 30.0  # largest plausible size of a shape, as part of that distance
LONGEST_NAME = 100  # of a robot, as robot.yaml has it
MOST_LISTED = 5  # largest number of missing meshes in a message


@dataclass(frozen=True, eq=False)
class DraftFolder:
    """Contents of a robot folder, and the robot that they describe."""

    urdf: str
    yaml: str
    readme: str
    robot: Robot
    notes: list[str]  # changes of the URDF and results that need a review


def init_robot(
    urdf: Path, name: str | None = None, package_paths: tuple[Path, ...] = ()
) -> DraftFolder:
    """Read the URDF or the MJCF of a humanoid and draft a robot folder.

    Args:
        urdf: path of the file; its root element tells which of the two it is.
        name: name of the robot; None: the name in the file.
        package_paths: folders in which the packages of package:// names are searched first; those
            in which an MJCF may have its meshes and included files besides its own folder.

    Raises:
        ConfigError: the file does not describe a robot that stands on two soles; with the reason.
    """
    with told_as(lambda what: ConfigError(urdf, f"no robot can be made of this file: {what}")):
        return _drafted(urdf, name, package_paths)


def _drafted(urdf: Path, name: str | None, package_paths: tuple[Path, ...]) -> DraftFolder:
    """The draft; see `init_robot`."""
    source, skeleton = _read(urdf, package_paths)
    anatomy = find_anatomy(skeleton, source)
    soles = _soles(skeleton, anatomy, source)
    leg = leg_length(skeleton, anatomy.legs[0], soles[0])
    _refuse_unfit(skeleton, anatomy, soles, leg, source)
    notes = source.notes
    mass = float(pin.computeTotalMass(skeleton.model))
    figures = servo_figures(skeleton, anatomy, source, mass, leg)
    torque = {joint: found.effort for joint, found in figures.items()}
    posture = find_posture(skeleton, anatomy, soles, torque, source.stand)
    if posture.sole_error > NEAR:
        notes.append(
            "no posture with both soles level was found: the remaining error is "
            f"{posture.sole_error:.2g} m or rad"
        )
    links = link_names(skeleton, source.root)
    inertias = mended_inertias(skeleton, leg, links, notes)
    shapes = clean_shapes(skeleton, anatomy, soles, posture.q, notes)
    arms = anatomy.arms
    draft = Draft(
        name=_checked_name(name) if name is not None else clipped(source.name, LONGEST_NAME),
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
    looks = find_looks(skeleton, source.root)
    urdf_text = cleaned_urdf(draft.name, skeleton, links, shapes, looks, inertias, efforts)

    def placed(hands: tuple[float, float]) -> tuple[Robot, Array]:
        q = find_posture(skeleton, anatomy, soles, torque, source.stand, hands).q
        return build_robot(robot_yaml(replace(draft, q=q)), urdf_text, urdf), q

    robot = build_robot(robot_yaml(draft), urdf_text, urdf)
    robot, q, still = with_clear_arms(robot, skeleton, anatomy, links, placed, notes)
    draft = draft if q is None else replace(draft, q=q)
    found = {*touching_pairs(robot, kept_apart(skeleton, anatomy, links)), *still}
    draft.ignored.extend(sorted(found))
    draft.ignored.extend(_apart(source, skeleton, links, draft.ignored))
    text = robot_yaml(draft)
    return DraftFolder(
        urdf=urdf_text,
        yaml=text,
        readme=readme(draft, urdf.name, notes),
        robot=build_robot(text, urdf_text, urdf),
        notes=notes,
    )


def _checked_name(name: str) -> str:
    """The name that a user gives the robot; it stands in comments and in XML."""
    if not 0 < len(name) <= LONGEST_NAME or not name.isprintable() or name != name.strip():
        raise ConfigError(
            "name",
            f"{shown(name)} is no name of a robot; use 1 to {LONGEST_NAME} characters on one line",
        )
    return name


def _apart(
    source: Source, skeleton: Skeleton, links: list[str], known: list[tuple[str, str]]
) -> list[tuple[str, str]]:
    """Pairs of links that the source excludes from collisions, as far as they are not `known`."""
    body_of = {name: body for body, names in enumerate(skeleton.links) for name in names}
    pairs = {
        tuple(sorted((links[body_of[one]], links[body_of[other]]))) for one, other in source.apart
    }
    seen = {tuple(sorted(pair)) for pair in known}
    return sorted((one, other) for one, other in pairs - seen if one != other)


def write_robot(draft: DraftFolder, folder: Path, force: bool = False) -> None:
    """Write robot.urdf, README.md and robot.yaml.

    Raises:
        OutputExistsError: one of the files exists and `force` is False.
        MgsError: the folder cannot be written, or holds a link or a device of one of these names.
    """
    files = {"robot.urdf": draft.urdf, "README.md": draft.readme, "robot.yaml": draft.yaml}
    for name in files:
        refuse_taken(folder / name, force)
    replace_files(folder, {name: text.encode() for name, text in files.items()})


def _read(urdf: Path, package_paths: tuple[Path, ...]) -> tuple[Source, Skeleton]:
    """Source and skeleton of a URDF, turned so that x of the base points forward."""
    source = read_source(urdf, package_paths)
    skeleton = build_skeleton(source, package_paths)
    _refuse_units(skeleton, source)
    if free_leg_followers(source, skeleton):
        skeleton = build_skeleton(source, package_paths)
    if yaw := heading(skeleton, source):
        turn(source, yaw)
        skeleton = build_skeleton(source, package_paths)
    if skeleton.missing:
        source.notes.append(
            f"{len(skeleton.missing)} mesh files were not found, e.g. {skeleton.missing[0]}; give "
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
                f"foot {skeleton.links[bare[-1]][0]} has no readable shape{lost}, so that its sole "
                "cannot be determined; give the folder of its meshes with --package-path, or add a "
                "collision box to the link",
            )
    left, right = (find_sole(skeleton.points(f), skeleton.placements[f]) for f in anatomy.feet)
    return left, right


def _refuse_units(skeleton: Skeleton, source: Source) -> None:
    """Raise ConfigError if the joints, or the meshes beside them, seem to be in millimetres."""
    model = skeleton.model
    joints = np.array([p.translation for p in skeleton.placements[1:]])
    height = float(np.ptp(joints[:, 2]))
    if height > TALLEST:
        raise ConfigError(
            source.path, f"the joints of this robot span {height:.0f} m: are these millimetres?"
        )
    for body in range(1, model.njoints):
        reach = float(np.abs(skeleton.points(body)).max())
        if reach > LARGEST_SHAPE * max(height, 0.05):
            raise ConfigError(
                source.path,
                f"the shapes of link {skeleton.links[body][0]} reach {reach:.3g} m, but the joints "
                f"of the robot span {height:.2g} m: is its mesh in millimetres? Then give it "
                'scale="0.001 0.001 0.001"',
            )


def _refuse_unfit(
    skeleton: Skeleton, anatomy: Anatomy, soles: tuple[Sole, Sole], leg: float, source: Source
) -> None:
    """Raise ConfigError if soles have an implausible size or legs have too few joints."""
    for side in Side:
        sole, link = soles[side], skeleton.links[anatomy.feet[side]][0]
        size = f"{1e3 * sole.length:.0f} x {1e3 * sole.width:.0f} mm"
        if min(sole.length, sole.width) < LEAST_SOLE * leg:
            raise ConfigError(
                source.path,
                f"point feet are not supported: the sole of link {link} is {size}, at least "
                f"{1e3 * LEAST_SOLE * leg:.0f} mm in each direction are needed",
            )
        if max(sole.length, sole.width) > LARGEST_SOLE * leg:
            raise ConfigError(
                source.path,
                f"the lowest link, {link}, is not a foot: its sole would be {size} for a leg "
                f"length of {1e3 * leg:.0f} mm; check that the URDF contains the legs, and that "
                "its shapes are in the same unit as its joints: a mesh in millimetres needs "
                'scale="0.001 0.001 0.001"',
            )
    n = len(anatomy.legs[0])
    if n < LEAST_LEG_JOINTS:
        raise ConfigError(
            source.path,
            f"a leg has {n} joints ({', '.join(skeleton.name(j) for j in anatomy.legs[0])}); at "
            f"least {LEAST_LEG_JOINTS} are needed to keep a sole level",
        )

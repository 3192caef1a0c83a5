"""A recording for the viewer Rerun: a motion file, what its loader does not draw, a blueprint.

Rerun's loader of MCAP files shows the robot, its transforms and poses. Paths and markers it keeps
as tables, so that here paths of CoM and ZMP, footsteps, boxes and balls are added as 3D objects.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from mgs.core.atomic_files import part_of, refuse_taken
from mgs.core.contact import Side
from mgs.core.errors import MgsError
from mgs.core.geometry import quat_xyzw_from_yaw
from mgs.motion import Motion
from mgs.motion_file import read_motion
from mgs.motion_file.topics import WORLD

COM, ZMP, REFERENCE = (168, 68, 138), (0, 135, 95), (110, 116, 128)
SIDES = {Side.LEFT: (0, 114, 178), Side.RIGHT: (213, 94, 0)}
BOX, BALL = (180, 184, 194), (230, 159, 0)
FLAT = 0.001  # [m] half the thickness of a footstep
LINE = 0.006  # radius of a line, as part of the height of the CoM


def write_recording(file: Path, output: Path, *, force: bool = False) -> Path:
    """Write a Rerun recording (.rrd) of a motion file.

    Raises:
        MgsError: the package rerun-sdk is not installed.
        MotionFileError: the motion file is missing or damaged.
        OutputExistsError: the file exists and `force` is False.
    """
    try:
        import rerun as rr
        from rerun.chunk import McapReader
    except ImportError as error:
        raise MgsError(
            f"{output}: a Rerun recording needs the package rerun-sdk 0.41 or later: "
            "pip install 'mgs[rerun]', or write a page (-o FILE.html)"
        ) from error
    refuse_taken(output, force)
    motion = read_motion(file)
    output.parent.mkdir(parents=True, exist_ok=True)
    part = part_of(output)
    try:
        with rr.RecordingStream("mgs", recording_id=file.stem) as stream:
            stream.save(str(part), default_blueprint=_blueprint(rr, motion))
            rr.send_chunks(McapReader(file).stream(), recording=stream)
            for entity, shapes in scene_objects(rr, motion).items():
                stream.log(f"mgs/{entity}", rr.CoordinateFrame(WORLD), *shapes, static=True)
            stream.flush()
            stream.disconnect()
        part.replace(output)
    finally:
        part.unlink(missing_ok=True)
    return output


def scene_objects(rr: Any, motion: Motion) -> dict[str, list[Any]]:
    """Objects of Rerun by the name of their entity; empty ones are left out."""
    radius, ground = LINE * float(motion.com[0, 2]), np.zeros(motion.n_samples)
    objects = {"com_path": [rr.LineStrips3D([motion.com], colors=[COM], radii=[radius])]}
    if motion.gait.is_balanced:
        for name, points, colour in (
            ("zmp_path", motion.zmp, ZMP),
            ("zmp_reference_path", motion.zmp_ref, REFERENCE),
        ):
            line = np.column_stack([points, ground])
            objects[name] = [rr.LineStrips3D([line], colors=[colour], radii=[radius])]
    for side in Side:
        sole = motion.robot.sole_spec(side)
        steps = [step for step in motion.footsteps if step.side is side]
        objects[f"footsteps/{side.label}"] = [
            rr.Boxes3D(
                centers=[[step.x, step.y, step.z] for step in steps],
                half_sizes=[[0.5 * sole.length, 0.5 * sole.width, FLAT]] * len(steps),
                quaternions=[rr.Quaternion(xyzw=quat_xyzw_from_yaw(step.yaw)) for step in steps],
                colors=[SIDES[side]] * len(steps),
            )
        ]
    return objects | _scene(rr, motion)


def _scene(rr: Any, motion: Motion) -> dict[str, list[Any]]:
    boxes, balls = motion.scene.boxes, motion.scene.balls
    objects = {}
    if boxes:
        half = [[0.5 * box.length, 0.5 * box.width, 0.5 * box.height] for box in boxes]
        objects["boxes"] = [
            rr.Boxes3D(
                centers=[[box.x, box.y, 0.5 * box.height] for box in boxes],
                half_sizes=half,
                quaternions=[rr.Quaternion(xyzw=quat_xyzw_from_yaw(box.yaw)) for box in boxes],
                colors=[BOX] * len(boxes),
                fill_mode="solid",
            )
        ]
    if balls:
        objects["balls"] = [
            rr.Ellipsoids3D(
                centers=[[ball.x, ball.y, ball.radius] for ball in balls],
                half_sizes=[[ball.radius] * 3 for ball in balls],
                colors=[BALL] * len(balls),
                fill_mode="solid",
            )
        ]
    return objects


def _blueprint(rr: Any, motion: Motion) -> Any:
    """One 3D view of robot and scene, without the collision shapes of the robot."""
    import rerun.blueprint as rrb

    name = ElementTree.fromstring(motion.robot.urdf).get("name", "")
    collisions = f"/{rr.escape_entity_path_part(name)}/collision_geometries/**"
    view = rrb.Spatial3DView(
        origin="/", contents=["+ /**", f"- {collisions}"], name="Robot and scene"
    )
    return rrb.Blueprint(view, collapse_panels=True)

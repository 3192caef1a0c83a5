"""Poses and velocities of links, compared with MuJoCo's, whose model is made from the same URDF."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mgs.motion.link_motion import link_motion
from mgs.motion.sampled import sample
from mgs.robot.orders import robot_order
from tests.support.mujoco_oracle import joint_order, mujoco_model, place
from tests.support.shipped import generated

MOTIONS = ["melson/walk_arc", "coman/walk_arc", "coman_legs/squat"]


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("links", ["moving", "all"])
def test_links_are_where_mujoco_places_them_and_as_fast(name: str, links: str):
    motion = generated(name).stages.motion
    frames = sample(motion, 10.0)
    found = link_motion(frames, "depth-first", links)
    model = mujoco_model(motion.robot, fuse=links == "moving")
    assert [model.body(i).name for i in range(1, model.nbody)] == list(found.names)
    assert joint_order(model) == robot_order(motion.robot, "depth-first", links).joints
    data = mujoco.MjData(model)
    velocity = np.zeros(6)
    for k in range(frames.n_frames):
        place(model, data, motion.robot, frames.q[k], frames.v[k])
        assert np.abs(data.xpos[1:] - found.position[k]).max() < 1e-9
        along = np.abs(np.sum(np.roll(data.xquat[1:], -1, axis=1) * found.quat_xyzw[k], axis=1))
        assert np.abs(along - 1.0).max() < 1e-9
        for i in range(1, model.nbody):
            kind = mujoco.mjtObj.mjOBJ_XBODY
            mujoco.mj_objectVelocity(model, data, kind, i, velocity, 0)
            assert np.abs(velocity[:3] - found.angular_velocity[k, i - 1]).max() < 1e-9
            assert np.abs(velocity[3:] - found.velocity[k, i - 1]).max() < 1e-9
            arm = data.xipos[i] - data.xpos[i]
            com_velocity = velocity[3:] + np.cross(velocity[:3], arm)
            assert np.abs(com_velocity - found.com_velocity[k, i - 1]).max() < 1e-9


@pytest.mark.parametrize("name", MOTIONS)
def test_the_breadth_first_order_has_the_same_links_level_by_level(name: str):
    motion = generated(name).stages.motion
    frames = sample(motion, 5.0)
    deep, wide = (link_motion(frames, order) for order in ("depth-first", "breadth-first"))
    assert set(deep.names) == set(wide.names)
    index = [deep.names.index(link) for link in wide.names]
    assert np.array_equal(deep.position[:, index], wide.position)
    assert np.array_equal(deep.com_velocity[:, index], wide.com_velocity)

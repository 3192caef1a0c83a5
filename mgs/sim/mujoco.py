"""MuJoCo behind the engine interface; the only place with MuJoCo's quaternion order wxyz."""

from __future__ import annotations

from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, GRAVITY
from mgs.core.geometry import quat_xyzw_from_yaw
from mgs.core.scene import BALL_FRICTION, EMPTY, Scene
from mgs.robot import Robot
from mgs.sim.audit import EngineModel
from mgs.sim.conditions import Conditions, bumps, gravity_on_slope
from mgs.sim.far_shapes import FarShapes
from mgs.sim.model import joint_names, link_name, simulation_urdf
from mgs.sim.mujoco_servos import (
    add_servos,
    couple_joints,
    friction_torques,
    harden_friction,
    pd_torques,
    set_damping,
)
from mgs.sim.servo import Driven, DryFriction, JointState
from mgs.sim.settings import ServoName, Settings

XYZW_FROM_WXYZ = [1, 2, 3, 0]
WXYZ_FROM_XYZW = [3, 0, 1, 2]
THREE = np.arange(3)
# Parts of a step that a robot on its soles has no use for. Leaving them out changes no result.
UNUSED = ("EQUALITY", "SPRING", "DAMPER", "SENSOR", "MIDPHASE")
IMPRATIO = 10.0  # friction this much stiffer than the normal contact: soles do not creep
CONTACT_TIME = 0.005  # [s] of MuJoCo's contact spring; 0.02 by default lets the robot tilt


class MujocoEngine:
    """One robot on a plane, with boxes and balls."""

    def __init__(
        self,
        robot: Robot,
        settings: Settings,
        servo: ServoName = "ideal",
        conditions: Conditions | None = None,
        scene: Scene = EMPTY,
    ) -> None:
        """Compile the model."""
        import mujoco

        self._mj: Any = mujoco
        self._robot, self._settings, self._servo = robot, settings, servo
        self._conditions, self._scene = conditions, scene
        self._gain = np.ones(robot.n) if conditions is None else conditions.gain
        self._former_handler = mujoco.get_mju_user_warning()
        # MuJoCo would write MUJOCO_LOG.TXT where the user stands; `read` looks at its counters
        mujoco.set_mju_user_warning(lambda _: None)
        self._model = self._compile()
        self._data = mujoco.MjData(self._model)
        self._angles = np.array([self._model.joint(name).qposadr[0] for name in joint_names(robot)])
        self._bodies = [
            self._model.body(link_name(joint)).id for joint in range(1, robot.model.njoints)
        ]
        self._xyz_xyzw_joints = np.array([0, 1, 2, 4, 5, 6, 3, *self._angles])
        self._warnings = self._data.warning
        self._hands = [robot.model.frames[frame] for frame in robot.hand_frames]
        feet = [robot.model.frames[frame].parentJoint for frame in robot.sole_frames]
        side_of_body = {self._bodies[joint - 1]: side for side, joint in enumerate(feet)}
        side_of_geom = np.array([side_of_body.get(body, -1) for body in self._model.geom_bodyid])
        self._on_soles = sole_pairs(side_of_geom, self._model.geom_bodyid == 0)
        self._far_shapes = FarShapes(self._model, self._data, side_of_geom)
        self._balls = [self._model.joint(f"ball_{i}") for i in range(len(scene.balls))]

    @property
    def version(self) -> str:
        """Version of MuJoCo."""
        return str(self._mj.mj_versionString())

    def place(self, q: Array) -> None:
        """Put the robot at q, at rest."""
        mj, data = self._mj, self._data
        mj.mj_resetData(self._model, data)
        data.qpos[:3] = q[:3]
        data.qpos[3:7] = q[3:7][WXYZ_FROM_XYZW]
        data.qpos[self._angles] = q[FLOATING_BASE_NQ:]
        mj.mj_forward(self._model, data)

    def drive(self, position: Array, velocity: Array) -> Array:
        """Make k steps of the engine's servos towards (k, n) joint states; gives their forces."""
        step, model, data = self._mj.mj_step, self._model, self._data
        ctrl, force = data.ctrl[: self._robot.n], data.actuator_force
        self._far_shapes.leave_out(len(position) * self._settings.dt)
        forces = np.empty((len(position), model.nu))
        for target, row in zip(self._controls(position, velocity), forces, strict=True):
            ctrl[:] = target
            step(model, data)
            row[:] = force
        return forces

    def torques(self, driven: Array) -> Driven:
        """Torques of the forces that `drive` has given."""
        if self._servo == "pd":
            return pd_torques(driven, self._robot.torque_limit)
        return Driven(driven, None)

    def joints(self) -> JointState:
        """Current state of the joints."""
        data, dofs = self._data, self._angles - 1  # the free joint: one velocity less than angles
        return JointState(data.qpos[self._angles], data.qvel[dofs], data.qfrc_applied[dofs])

    @property
    def rotors(self) -> Array:
        """Inertia (n,) of the rotors [kg m^2]."""
        return np.asarray(self._model.dof_armature[self._angles - 1])

    def push(
        self, torque: Array, free_speed: Array, friction: DryFriction | None = None
    ) -> JointState:
        """Make one step with torques (n,) [N m] and dry friction besides.

        They may damp as they like: every joint has its rotor to slow down.
        """
        del free_speed
        dofs, data = self._angles - 1, self._data
        if friction is not None:
            self._model.dof_frictionloss[dofs] = friction.bound
        data.qfrc_applied[dofs] = torque
        self._mj.mj_step(self._model, data)
        state = self.joints()
        if friction is None:
            return state
        return state._replace(torque=state.torque + friction_torques(self._model, data)[dofs])

    def carry(self, payload: Array) -> None:
        """From now on weights of masses (2,) [kg] pull at the hands where they are now."""
        data = self._data
        data.xfrc_applied[:] = 0.0
        for mass, frame in zip(payload, self._hands, strict=True):
            body = self._bodies[frame.parentJoint - 1]
            lever = data.xpos[body] - data.xipos[body]
            lever = lever + data.xmat[body].reshape(3, 3) @ frame.placement.translation
            weight = mass * self._model.opt.gravity
            data.xfrc_applied[body] += [*weight, *np.cross(lever, weight)]

    def _controls(self, position: Array, velocity: Array) -> Array:
        if self._servo == "pd":
            return position
        # a position servo has no speed target: it enters as a shift of the position target,
        # together with the way back to the beginning of the step, where MuJoCo evaluates servos
        return position + (self._settings.damping - self._settings.dt) * velocity

    def read(self) -> Array:
        """Current q (7 + n,); NaN once the simulation has diverged."""
        if any(self._warnings.number):
            return np.full(self._robot.model.nq, np.nan)
        return np.asarray(self._data.qpos[self._xyz_xyzw_joints])

    def contacts(self) -> Array:
        """What the floor does to the soles (2, 5): forces [N], first moments [N m]."""
        contact = self._data.contact
        first = contact.efc_address  # of its constraint forces, -1: none
        if not len(self._data.efc_force):
            return np.zeros((2, 5))
        # with elliptic cones these are the forces along the axes of the contact's frame
        axes = contact.frame.reshape(-1, 3, 3)
        f = (self._data.efc_force[first[:, None] + THREE][:, None] @ axes)[:, 0]
        rows = np.concatenate([f, f[:, 2:] * contact.pos[:, :2]], axis=1)
        one, other = contact.geom.T
        return np.asarray((self._on_soles[one, other].T * (first >= 0)) @ rows)

    def balls(self) -> Array:
        """Positions and velocities (b, 6) of the balls."""
        data = self._data
        states = [
            [*data.qpos[(at := b.qposadr[0]) : at + 3], *data.qvel[(v := b.dofadr[0]) : v + 3]]
            for b in self._balls
        ]
        return np.array(states).reshape(-1, 6)

    def inspect(self) -> EngineModel:
        """The robot as MuJoCo understands it."""
        model, data, mj = self._model, self._data, self._mj
        mj.mj_kinematics(model, data)
        mj.mj_comPos(model, data)
        mj.mj_crb(model, data)
        robot = self._robot
        hinges = {
            name: model.joint(own)
            for name, own in zip(robot.joint_names, joint_names(robot), strict=True)
        }
        stall = {model.actuator(i).name: model.actuator_forcerange[i, 1] for i in range(model.nu)}
        quats = data.xquat[self._bodies][:, XYZW_FROM_WXYZ]
        return EngineModel(
            joints={name: (*h.range, stall[h.name]) for name, h in hinges.items()},
            mass=float(model.body_subtreemass[self._bodies[0]]),
            com=data.subtree_com[self._bodies[0]].copy(),
            inertia=self._inertia(),
            links=np.concatenate([data.xpos[self._bodies], quats], axis=1),
        )

    def _inertia(self) -> Array:
        """Joint-space inertia (n, n) less the armatures."""
        columns = np.zeros((self._model.nv, self._model.nv))
        for unit, column in zip(np.eye(self._model.nv), columns, strict=True):
            self._mj.mj_mulM(self._model, self._data, column, unit)
        joints = self._angles - 1  # the free joint has one velocity less than positions
        armature = np.diag(self._model.dof_armature[joints])
        return columns[np.ix_(joints, joints)] - armature

    def close(self) -> None:
        """Give back the handler of warnings."""
        self._mj.set_mju_user_warning(self._former_handler)

    def _compile(self) -> Any:
        mj, settings = self._mj, self._settings
        spec = mj.MjSpec.from_string(simulation_urdf(self._robot))
        option = spec.option
        option.timestep = settings.dt
        option.iterations = settings.iterations
        slope = np.zeros(2) if self._conditions is None else self._conditions.slope
        option.gravity = gravity_on_slope(slope, GRAVITY).tolist()
        option.integrator = mj.mjtIntegrator.mjINT_IMPLICITFAST
        option.cone = mj.mjtCone.mjCONE_ELLIPTIC
        option.impratio = IMPRATIO
        unused = {*UNUSED} if self._scene.balls else {*UNUSED, "ISLAND"}  # one island without balls
        for name in unused - ({"EQUALITY"} if self._robot.followers else set()):
            option.disableflags |= int(getattr(mj.mjtDisableBit, f"mjDSBL_{name}"))
        spec.worldbody.first_body().add_freejoint()  # else the base is welded to the world
        for geom in spec.geoms:  # the robot touches the ground, not itself
            geom.contype, geom.conaffinity = 1, 0
            geom.friction = [settings.friction, 0.0, 0.0]
            geom.solref = [max(CONTACT_TIME, 2.0 * settings.dt), 1.0]
        spec.worldbody.add_geom(
            type=mj.mjtGeom.mjGEOM_PLANE,
            size=[0.0, 0.0, 1.0],
            contype=0,
            conaffinity=1,
            friction=[settings.friction, 0.0, 0.0],  # a pair has the larger one
            solref=[max(CONTACT_TIME, 2.0 * settings.dt), 1.0],  # a pair has the mean
        )
        for box in (*self._scene.boxes, *bumps(self._conditions)):
            spec.worldbody.add_geom(
                type=mj.mjtGeom.mjGEOM_BOX,
                pos=[box.x, box.y, 0.5 * box.height],
                quat=quat_xyzw_from_yaw(box.yaw)[WXYZ_FROM_XYZW],
                size=[0.5 * box.length, 0.5 * box.width, 0.5 * box.height],
                contype=0,
                conaffinity=1,
                friction=[settings.friction, 0.0, 0.0],
                solref=[max(CONTACT_TIME, 2.0 * settings.dt), 1.0],
            )
        for i, ball in enumerate(self._scene.balls):  # after the robot, whose addresses stay
            body = spec.worldbody.add_body(name=f"ball_{i}", pos=[ball.x, ball.y, ball.radius])
            body.add_freejoint(name=f"ball_{i}")
            body.add_geom(
                type=mj.mjtGeom.mjGEOM_SPHERE,
                size=[ball.radius, 0.0, 0.0],
                mass=ball.mass,
                contype=1,  # meets the ground, as the robot does, and the robot
                conaffinity=1,
                priority=1,  # its friction counts in all its pairs
                friction=[BALL_FRICTION, 0.0, 0.0],
                solref=[max(CONTACT_TIME, 2.0 * settings.dt), 1.0],
            )
        add_servos(spec, self._robot, settings, self._servo, self._gain)
        couple_joints(spec, self._robot, settings.dt)
        model = spec.compile()
        if self._servo == "pd":
            set_damping(model, self._robot, settings, self._gain)
        harden_friction(model, settings.dt)
        return model


def sole_pairs(side_of_geom: Array, is_ground: Array) -> Array:
    """How the force on the second of two shapes (g, g) counts on the soles (g, g, 2): 1, -1 or 0.

    Args:
        side_of_geom: side (g,) of each sole, -1 for all other shapes.
        is_ground: whether a shape (g,) is the floor or one of its boxes.
    """
    on_second = is_ground[:, None, None] & (side_of_geom[:, None] == np.arange(2))
    counts = on_second.astype(np.float64)
    return counts - counts.swapaxes(0, 1)

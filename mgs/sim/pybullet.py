"""PyBullet behind the engine interface.

Every departure from PyBullet's defaults below is there because the default simulates something
else than the robot given; docs/simulation.md has the figures.
"""

from __future__ import annotations

import importlib.metadata
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV, GRAVITY
from mgs.core.scene import EMPTY, Scene
from mgs.robot import Robot
from mgs.sim.audit import EngineModel
from mgs.sim.conditions import Conditions, bumps, gravity_on_slope
from mgs.sim.model import joint_names, simulation_urdf
from mgs.sim.pybullet_scene import BASE, add_balls, add_ground, couple_joints
from mgs.sim.servo import Driven, DryFriction, JointState, with_friction
from mgs.sim.settings import ServoName, Settings

CORRECTION_TIME = 0.005  # [s] in which a motor makes up for an error of position


class PybulletEngine:
    """One robot on a plane, in a DIRECT client of its own.

    PyBullet has no rotor inertia: `Robot.armature` is left out here, unlike in MuJoCo.
    """

    def __init__(
        self,
        robot: Robot,
        settings: Settings,
        servo: ServoName = "ideal",
        conditions: Conditions | None = None,
        scene: Scene = EMPTY,
    ) -> None:
        """Connect and load; `servo` makes no difference here, motors do as each step says."""
        import pybullet

        self._p: Any = pybullet
        del servo
        self._robot, self._settings = robot, settings
        self._conditions, self._scene = conditions, scene
        gain = 1.0 if conditions is None else conditions.gain
        self._stiffness = settings.stiffness * robot.torque_limit * gain  # (n,) [N m/rad]
        self._strength = (robot.motors * robot.torque_limit).tolist()  # (n,) [N m]
        self._yield, self._torque = np.zeros(robot.n), np.zeros(robot.n)  # [rad], [N m]
        self._client = pybullet.connect(pybullet.DIRECT)
        slope = np.zeros(2) if conditions is None else conditions.slope
        self._gravity = gravity_on_slope(slope, GRAVITY)  # (3,) [m/s^2]
        self._payload = np.zeros(2)
        self._hands = [robot.model.frames[frame] for frame in robot.hand_frames]
        self._configure()
        boxes = (*scene.boxes, *bumps(conditions))
        self._grounds = add_ground(pybullet, self._client, boxes)
        self._body = self._load_robot()
        self._joints = self._joint_indices()
        couple_joints(pybullet, self._client, self._body, self._joints, robot)
        feet = [robot.model.frames[frame].parentJoint for frame in robot.sole_frames]
        self._side_of_link = {self._joints[joint - 2]: side for side, joint in enumerate(feet)}
        self._balls = add_balls(pybullet, self._client, scene.balls, settings.friction)
        self._quiet_links()

    @property
    def version(self) -> str:
        """Version of PyBullet."""
        return importlib.metadata.version("pybullet")

    def place(self, q: Array) -> None:
        """Put the robot at q, at rest."""
        p, client = self._p, self._client
        offset, turn = p.getDynamicsInfo(self._body, BASE, physicsClientId=client)[3:5]
        # PyBullet's base pose is that of the base's inertial frame
        position, quat_xyzw = p.multiplyTransforms(q[:3].tolist(), q[3:7].tolist(), offset, turn)
        p.resetBasePositionAndOrientation(self._body, position, quat_xyzw, physicsClientId=client)
        p.resetBaseVelocity(self._body, [0.0] * 3, [0.0] * 3, physicsClientId=client)
        self._yield, self._torque = np.zeros(self._robot.n), np.zeros(self._robot.n)
        for joint, angle in zip(self._joints, q[FLOATING_BASE_NQ:].tolist(), strict=True):
            p.resetJointState(self._body, joint, angle, 0.0, physicsClientId=client)

    def drive(self, position: Array, velocity: Array) -> Array:
        """Make k steps of ideal servos towards (k, n) joint states; gives their torques."""
        p, body, joints, client = self._p, self._body, self._joints, self._client
        torques = np.empty_like(position)
        for target, speed, torque in zip(position, velocity, torques, strict=True):
            self._command(target, speed)
            self._step()
            torque[:] = [state[3] for state in p.getJointStates(body, joints, client)]
            self._torque = torque
        return torques

    def torques(self, driven: Array) -> Driven:
        """The torques that `drive` has given."""
        return Driven(driven, None)

    def joints(self) -> JointState:
        """Current state of the joints."""
        states = self._p.getJointStates(self._body, self._joints, self._client)
        return JointState(*np.array([(s[0], s[1], s[3]) for s in states]).T)

    @property
    def rotors(self) -> Array:
        """None: PyBullet has no rotors."""
        return np.zeros(self._robot.n)

    def push(
        self, torque: Array, free_speed: Array, friction: DryFriction | None = None
    ) -> JointState:
        """Make one step with torques (n,) [N m] that would be zero at free_speed (n,) [rad/s].

        Links are light without their rotors, a foot by a factor of 90: the damping of a servo would
        throw it to and fro at any step beyond 0.2 ms. Therefore a motor that aims at free_speed
        and has no more force than the torque: it gives all of it, except where that would take the
        joint past the speed at which a servo has none left. A joint that dry friction holds is
        held by its motor, at speed 0 with the bound of the friction, against the torque.
        """
        p, client = self._p, self._client
        against = None
        if friction is not None:
            torque, free_speed, against = with_friction(torque, free_speed, friction)
            p.setJointMotorControlArray(
                self._body, self._joints, p.TORQUE_CONTROL, forces=against, physicsClientId=client
            )
        p.setJointMotorControlArray(
            self._body,
            self._joints,
            p.VELOCITY_CONTROL,
            targetVelocities=free_speed.tolist(),
            forces=np.abs(torque).tolist(),
            velocityGains=[1.0] * self._robot.n,
            physicsClientId=client,
        )
        self._step()
        state = self.joints()
        return state if against is None else state._replace(torque=state.torque + against)

    def carry(self, payload: Array) -> None:
        """From now on weights of masses (2,) [kg] pull at the hands."""
        self._payload = payload

    def _step(self) -> None:
        """One step; PyBullet forgets forces from outside with every one."""
        p, client = self._p, self._client
        for mass, frame in zip(self._payload.tolist(), self._hands, strict=True):
            if not mass:
                continue
            link = self._joints[frame.parentJoint - 2]
            state = p.getLinkState(self._body, link, 0, 1, physicsClientId=client)
            at, _ = p.multiplyTransforms(
                state[4], state[5], frame.placement.translation.tolist(), [0.0, 0.0, 0.0, 1.0]
            )
            weight = (mass * self._gravity).tolist()
            p.applyExternalForce(
                self._body, link, weight, at, p.WORLD_FRAME, physicsClientId=client
            )
        p.stepSimulation(client)

    def _command(self, position: Array, velocity: Array) -> None:
        """Aim the motors at joint states (n,) at the end of the step, less what servos yield.

        PyBullet's motor is a rigid constraint: two feet on the ground and a plan that is off by a
        tenth of a millimetre make it press to its limit. The spring and damper of `Settings` are
        therefore put in series with it, solved for the yield x = q_plan - q:

            dx/dt = (torque / stiffness - x) / damping

        Torques are known one step late, therefore the loop of motor, yield and an inertia I at a
        joint hunts unless I < CORRECTION_TIME * damping * stiffness. The yield's speed is no part
        of the target: it would put the step in place of CORRECTION_TIME.
        """
        n, settings = self._robot.n, self._settings
        missing = self._torque / self._stiffness - self._yield
        self._yield = self._yield + settings.dt / settings.damping * missing
        self._p.setJointMotorControlArray(
            self._body,
            self._joints,
            self._p.POSITION_CONTROL,
            targetPositions=(position - self._yield).tolist(),
            targetVelocities=velocity.tolist(),
            forces=self._strength,
            positionGains=[min(1.0, settings.dt / CORRECTION_TIME)] * n,
            velocityGains=[1.0] * n,
            physicsClientId=self._client,
        )

    def read(self) -> Array:
        """Current q (7 + n,)."""
        base = self._base_pose()
        states = self._p.getJointStates(self._body, self._joints, self._client)
        return np.concatenate([base, [state[0] for state in states]])

    def contacts(self) -> Array:
        """What the floor does to the soles (2, 5): forces [N], first moments [N m]."""
        found = np.zeros((2, 5))
        for point in self._p.getContactPoints(bodyA=self._body, physicsClientId=self._client):
            side = self._side_of_link.get(point[3], -1)
            if side < 0 or point[2] not in self._grounds:
                continue
            (x, y, _), parts = point[5], zip((7, 11, 13), (9, 10, 12), strict=True)
            f = sum(point[size] * np.array(point[axis]) for axis, size in parts)
            found[side] += [*f, f[2] * x, f[2] * y]
        return found

    def balls(self) -> Array:
        """Positions and velocities (b, 6) of the balls."""
        p, client = self._p, self._client
        states = [
            [
                *p.getBasePositionAndOrientation(ball, client)[0],
                *p.getBaseVelocity(ball, client)[0],
            ]
            for ball in self._balls
        ]
        return np.array(states).reshape(-1, 6)

    def inspect(self) -> EngineModel:
        """The robot as PyBullet understands it."""
        p, body, client = self._p, self._body, self._client
        every = range(BASE, p.getNumJoints(body, client))
        mass = sum(p.getDynamicsInfo(body, link, client)[0] for link in every)
        links = [BASE, *self._joints]
        masses = np.array([p.getDynamicsInfo(body, link, client)[0] for link in links])
        states = p.getLinkStates(body, self._joints, 0, 1, physicsClientId=client)
        base_com = p.getBasePositionAndOrientation(body, client)[0]
        coms = np.array([base_com, *(state[0] for state in states)])
        infos = [p.getJointInfo(body, joint, client) for joint in self._joints]
        own = dict(zip(joint_names(self._robot), self._robot.joint_names, strict=True))
        return EngineModel(
            joints={own[info[1].decode()]: (info[8], info[9], info[10]) for info in infos},
            mass=float(mass),
            com=masses @ coms / masses.sum(),
            inertia=self._inertia(),
            links=np.array([self._base_pose(), *([*state[4], *state[5]] for state in states)]),
        )

    def _inertia(self) -> Array:
        """Joint-space inertia (n, n); PyBullet's own order is by joint index."""
        angles = self.read()[FLOATING_BASE_NQ:]
        by_index = angles[np.argsort(self._joints)].tolist()
        full = self._p.calculateMassMatrix(self._body, by_index, physicsClientId=self._client)
        joints = FLOATING_BASE_NV + np.array(self._joints)
        return np.array(full)[np.ix_(joints, joints)]

    def close(self) -> None:
        """Disconnect from the engine."""
        if self._client >= 0:
            self._p.disconnect(self._client)
            self._client = -1

    def _configure(self) -> None:
        p, client = self._p, self._client
        p.setGravity(*self._gravity.tolist(), physicsClientId=client)
        p.setPhysicsEngineParameter(
            fixedTimeStep=self._settings.dt,
            numSolverIterations=self._settings.iterations,
            numSubSteps=0,
            solverResidualThreshold=0.0,  # always all iterations: equal work, equal results
            enableConeFriction=1,  # a friction pyramid lets soles creep along its edges
            deterministicOverlappingPairs=1,
            enableFileCaching=0,  # by path: the next robot's temporary file may bear the same name
            physicsClientId=client,
        )

    def _load_robot(self) -> int:
        p = self._p
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "robot.urdf"
            path.write_text(simulation_urdf(self._robot), encoding="utf-8")
            # without the flag inertias are made up from the contact shapes
            flags = p.URDF_USE_INERTIA_FROM_FILE
            return int(p.loadURDF(str(path), flags=flags, physicsClientId=self._client))

    def _joint_indices(self) -> list[int]:
        p, client = self._p, self._client
        indices = {
            p.getJointInfo(self._body, joint, client)[1].decode(): joint
            for joint in range(p.getNumJoints(self._body, client))
        }
        return [indices[name] for name in joint_names(self._robot) if name in indices]

    def _quiet_links(self) -> None:
        p, client = self._p, self._client
        for link in (BASE, *self._joints):
            p.changeDynamics(
                self._body,
                link,
                lateralFriction=self._settings.friction,
                spinningFriction=0.0,
                rollingFriction=0.0,
                restitution=0.0,
                linearDamping=0.0,  # air drag that no robot has; 0.04 by default
                angularDamping=0.0,
                jointDamping=0.0,
                physicsClientId=client,
            )

    def _base_pose(self) -> Array:
        p, client = self._p, self._client
        position, quat_xyzw = p.getBasePositionAndOrientation(self._body, client)
        offset, turn = p.getDynamicsInfo(self._body, BASE, client)[3:5]
        inverse = p.invertTransform(offset, turn)
        position, quat_xyzw = p.multiplyTransforms(position, quat_xyzw, *inverse)
        return np.array([*position, *quat_xyzw])

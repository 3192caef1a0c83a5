"""Robots: URDF and robot.yaml combined in a Pinocchio model with soles, hands and limits."""

from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.robot.build import build_robot
from mgs.robot.collision_shapes import shape_corners
from mgs.robot.legs import missing_turn
from mgs.robot.limbs import arm_mask, leg_joints, leg_length, leg_mask, midpoint_width
from mgs.robot.load import find_robot, list_robots, load_robot
from mgs.robot.motors import Motors, MotorSpec, motors_of, read_motors
from mgs.robot.robot import Robot
from mgs.robot.servo_spec import ServoSpec
from mgs.robot.servos import Servos, is_modelled, pd_servos, servo_sources, servos_of
from mgs.robot.spec import FrameSpec, RobotSpec, SoleSpec

__all__ = [
    "FLOATING_BASE_NQ",
    "FLOATING_BASE_NV",
    "FrameSpec",
    "MotorSpec",
    "Motors",
    "Robot",
    "RobotSpec",
    "ServoSpec",
    "Servos",
    "SoleSpec",
    "arm_mask",
    "build_robot",
    "find_robot",
    "is_modelled",
    "leg_joints",
    "leg_length",
    "leg_mask",
    "list_robots",
    "load_robot",
    "midpoint_width",
    "missing_turn",
    "motors_of",
    "pd_servos",
    "read_motors",
    "servo_sources",
    "servos_of",
    "shape_corners",
]

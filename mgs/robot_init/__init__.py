"""A robot folder from a URDF that nobody wrote for mgs: `init_robot`.

    source      the file as a tree of revolute joints
    points      surfaces of its links, meshes included
    skeleton    both as Pinocchio's model
    anatomy     which joints are legs, arms, waist and head
    sole        the rectangle under a foot
    posture     half-sitting
    figures     torque and speed of joints
    bodies      the cleaned copy
    text        robot.yaml and README.md
"""

from mgs.robot_init.init import DraftFolder, init_robot, write_robot

__all__ = ["DraftFolder", "init_robot", "write_robot"]

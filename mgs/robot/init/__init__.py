"""A robot folder from a URDF that nobody wrote for mgs: `init_robot`.

source reads the file as a tree of revolute joints, points the surfaces of its links; skeleton is
both as Pinocchio's model. anatomy tells legs, arms, waist and head, sole the rectangles under the
feet, posture half-sitting, figures torque and speed of joints, collisions which shapes overlap
anyway. bodies writes the cleaned copy, text robot.yaml and README.md; init calls them all.
"""

from mgs.robot.init.init import DraftFolder, init_robot, write_robot

__all__ = ["DraftFolder", "init_robot", "write_robot"]

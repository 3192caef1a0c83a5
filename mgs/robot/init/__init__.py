"""First version of a robot folder, made from a third-party URDF by `init_robot`.

`source` reads the URDF as a tree of revolute joints, `points` the surfaces of its links, and
`skeleton` combines both in a Pinocchio model. `anatomy` identifies legs, arms, waist and head,
`sole` the contact rectangles, `posture` the half-sitting posture, `figures` torque and speed limits
and `collisions` the pairs of shapes that always overlap. `bodies` writes the cleaned URDF, `text`
robot.yaml and README.md. `init` calls all of them.
"""

from mgs.robot.init.init import DraftFolder, init_robot, write_robot

__all__ = ["DraftFolder", "init_robot", "write_robot"]

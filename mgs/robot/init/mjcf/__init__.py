"""Reading of MJCF, the robot format of MuJoCo, as the URDF that the rest of `init` works on.

`sources` collects a model and the files that belong to it, `text` keeps what describes the robot,
`compiled` lets MuJoCo compile that, and `urdf` writes the compiled model as links and joints.
"""

from mgs.robot.init.mjcf.read import Drive, Mjcf, read_mjcf

__all__ = ["Drive", "Mjcf", "read_mjcf"]

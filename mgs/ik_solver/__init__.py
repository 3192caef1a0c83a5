"""Stage 4: inverse kinematics, from task references and CoM motion to joint angles."""

from mgs.ik_solver.joint_trajectory import JointTrajectory
from mgs.ik_solver.residuals import refuse_speed
from mgs.ik_solver.solve import IkSolver, solve_ik

__all__ = ["IkSolver", "JointTrajectory", "refuse_speed", "solve_ik"]

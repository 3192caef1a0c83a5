"""mgs: offline motion generation for humanoid robots.

A gait file passes through four stages, motion planner, trajectory planner, CoM generator and
inverse kinematics, and becomes a joint trajectory that a position-controlled robot plays back.
"""

__version__ = "0.1.0"

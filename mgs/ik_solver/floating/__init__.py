"""Inverse kinematics of a robot on a floating base, both soles among its tasks."""

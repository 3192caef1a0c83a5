"""Inverse kinematics of a robot with a floating base; both soles are among its tasks."""

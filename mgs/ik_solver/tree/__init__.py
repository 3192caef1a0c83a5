"""Inverse kinematics of a robot as a tree that grows out of its support sole."""

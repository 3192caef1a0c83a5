"""Searches that rest on verdicts: how fast a robot can walk, and what corrects a motion."""

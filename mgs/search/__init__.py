"""Searches with verdicts as criterion: fastest walk of a robot, correction of a motion."""

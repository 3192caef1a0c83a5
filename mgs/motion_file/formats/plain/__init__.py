"""Formats of mgs itself: joint angles with their names, for spreadsheets and scripts."""

from mgs.motion_file.formats.format import Format

_HERE = "mgs.motion_file.formats.plain"

PLAIN: tuple[Format, ...] = (
    Format("csv", "table of joint angles and velocities with names", ".csv", f"{_HERE}.csv_table"),
    Format("npz", "NumPy arrays of joint angles and velocities", ".npz", f"{_HERE}.arrays"),
)

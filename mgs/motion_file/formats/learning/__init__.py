"""Formats of reference motions from which policies are trained."""

from mgs.motion_file.formats.format import Format

_HERE = "mgs.motion_file.formats.learning"
SINGLE = 4e-7  # [rad] that an angle below pi changes by when it is written in single precision

LEARNING: tuple[Format, ...] = (
    Format(
        "unitree-csv", "table of base and joints without names (LAFAN1)",
        ".csv", f"{_HERE}.unitree_csv", fps=30.0, closed=True, resolution=1e-6,
    ),
)  # fmt: skip

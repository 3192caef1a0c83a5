"""Formats of reference motions from which policies are trained."""

from mgs.motion_file.formats.format import Format

_HERE = "mgs.motion_file.formats.learning"
SINGLE = 4e-7  # [rad] by which an angle up to 2 pi changes in single precision
DIGITS = 1e-7  # [rad] by which one changes that is written with 7 digits after the point

LEARNING: tuple[Format, ...] = (
    Format(
        "unitree-csv", "table of base and joints without names (LAFAN1)",
        ".csv", f"{_HERE}.unitree_csv", fps=30.0, resolution=1e-9,
    ),
    Format(
        "beyondmimic", "arrays for whole_body_tracking in Isaac Lab",
        ".npz", f"{_HERE}.beyondmimic", fps=50.0, resolution=SINGLE,
    ),
    Format(
        "mjlab", "arrays for tracking tasks of mjlab",
        ".npz", f"{_HERE}.mjlab", fps=50.0, resolution=SINGLE,
    ),
    Format(
        "holosoma", "arrays for whole-body tracking of holosoma",
        ".npz", f"{_HERE}.holosoma", fps=50.0, resolution=SINGLE,
    ),
    Format(
        "gmr", "pickle of GMR, TWIST and TWIST2",
        ".pkl", f"{_HERE}.gmr", fps=30.0,
    ),
    Format(
        "motion-lib", "pickle of PHC, ASAP, HumanoidVerse and SONIC",
        ".pkl", f"{_HERE}.motion_lib", fps=30.0, resolution=SINGLE,
    ),
    Format(
        "sonic", "folder of tables for the controller of GR00T SONIC",
        "", f"{_HERE}.sonic", fps=50.0, resolution=DIGITS,
    ),
    Format(
        "protomotions", "tensors for ProtoMotions (needs torch)",
        ".motion", f"{_HERE}.protomotions", fps=30.0, resolution=SINGLE, extra="protomotions",
    ),
    Format(
        "locomujoco", "trajectory of LocoMuJoCo",
        ".npz", f"{_HERE}.locomujoco", fps=100.0, resolution=SINGLE,
    ),
    Format(
        "amp", "frames for AMP_for_hardware and its forks",
        ".json", f"{_HERE}.amp", fps=50.0, closed=True, resolution=DIGITS,
    ),
    Format(
        "isaaclab-amp", "arrays for the AMP tasks of Isaac Lab",
        ".npz", f"{_HERE}.isaaclab_amp", fps=60.0, resolution=SINGLE,
    ),
    Format(
        "open-duck", "frames of the Open Duck motion generator",
        ".json", f"{_HERE}.open_duck", fps=50.0, closed=True, resolution=DIGITS,
    ),
    Format(
        "lerobot", "data set of LeRobot, version 3 (needs pyarrow)",
        "", f"{_HERE}.lerobot", fps=50.0, resolution=SINGLE, extra="parquet",
    ),
)  # fmt: skip

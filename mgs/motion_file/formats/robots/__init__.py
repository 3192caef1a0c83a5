"""Formats that robots and their motion players load."""

import math

from mgs.motion_file.formats.format import Format

_HERE = "mgs.motion_file.formats.robots"
HALF_A_TICK = math.pi / 1024  # [rad] of the coarsest motors, of 10 bit
KEYFRAMES = math.radians(10.0)  # [rad] that a player of keyframes may stray by; it is reported

ROBOTS: tuple[Format, ...] = (
    Format(
        "dynamixel", "table of ticks for Dynamixel servos",
        ".csv", f"{_HERE}.dynamixel", resolution=HALF_A_TICK,
    ),
    Format(
        "dynamixel-sync", "Sync Write packets for Dynamixel servos",
        ".csv", f"{_HERE}.dynamixel_sync", resolution=HALF_A_TICK,
    ),
    Format(
        "feetech", "table of ticks for Feetech servos",
        ".csv", f"{_HERE}.feetech", resolution=HALF_A_TICK,
    ),
    Format(
        "feetech-sync", "Sync Write packets for Feetech servos",
        ".csv", f"{_HERE}.feetech_sync", resolution=HALF_A_TICK,
    ),
    Format(
        "op3-action", "action file of ROBOTIS OP3, reduced to keyframes",
        ".bin", f"{_HERE}.op3_action", fps=125.0, closed=True, resolution=KEYFRAMES,
        uses=frozenset({"approach", "tolerance"}),
    ),
    Format("jtc", "trajectory for ros2_control", ".yaml", f"{_HERE}.jtc"),
    Format(
        "play-motion2", "parameters of play_motion2 (TALOS, KANGAROO, TIAGo)",
        ".yaml", f"{_HERE}.play_motion2", fps=50.0,
    ),
    Format(
        "bitbots", "animation of the Bit-Bots",
        ".json", f"{_HERE}.bitbots", fps=100.0, closed=True, resolution=1e-12,
        uses=frozenset({"approach"}),
    ),
    Format(
        "nubots", "script of the NUbots (NUgus)",
        ".yaml", f"{_HERE}.nubots", fps=50.0, closed=True, uses=frozenset({"approach"}),
    ),
    Format(
        "hulks", "motion of the HULKs for NAO",
        ".json", f"{_HERE}.hulks", fps=50.0, closed=True,
    ),
    Format(
        "naoqi", "lists for ALMotion.angleInterpolation of NAO and Pepper",
        ".json", f"{_HERE}.naoqi", fps=50.0, closed=True, uses=frozenset({"approach"}),
    ),
    Format(
        "webots", "motion file of the simulator Webots",
        ".motion", f"{_HERE}.webots", fps=50.0, closed=True,
    ),
    Format(
        "openhrp", "patterns for the SequencePlayer of hrpsys and OpenHRP",
        "", f"{_HERE}.openhrp", fps=200.0,
    ),
    Format(
        "blf-mat", "joint-trajectory-player of bipedal-locomotion-framework",
        ".mat", f"{_HERE}.blf_mat", fps=100.0,
    ),
    Format("rosbag2", "bag for ros2 bag play", "", f"{_HERE}.rosbag2"),
)  # fmt: skip

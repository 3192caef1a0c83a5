"""Names of the roles that joints have on any humanoid, such as left_knee."""

from __future__ import annotations

import difflib

from mgs.core.contact import Side

TURNS = ("roll", "pitch", "yaw")  # about the axes x, y and z of the body
LEG_ROLES = ("hip_roll", "hip_pitch", "hip_yaw", "knee", "ankle_roll", "ankle_pitch", "ankle_yaw")
ARM_ROLES = (
    "shoulder_roll", "shoulder_pitch", "shoulder_yaw", "elbow", "wrist_roll", "wrist_pitch",
    "wrist_yaw",
)  # fmt: skip
SIDED_ROLES = tuple(f"{side.label}_{role}" for side in Side for role in (*LEG_ROLES, *ARM_ROLES))
ROLES = (*SIDED_ROLES, *(f"{part}_{turn}" for part in ("waist", "head") for turn in TURNS))


def checked_role(name: str) -> str:
    """The name of a role; raises ValueError with the nearest name where there is none."""
    if name in ROLES:
        return name
    close = difflib.get_close_matches(name, ROLES, n=1)
    hint = f"; did you mean {close[0]!r}?" if close else f"; roles: {', '.join(ROLES)}"
    raise ValueError(f"{name!r} is no role of a joint{hint}")

"""What to change in a gait that a robot cannot do: one remedy for each kind of gait and of error.

The stages state facts, such as which task is missed when and by how much. What would help depends
on the kind of gait that was asked for, and is added to the error where the kind is known.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import reduce

from mgs.core.errors import (
    ComNotAtRestError,
    ComOutsideFeetError,
    CycleError,
    FootstepError,
    IkError,
    JointLimitError,
    JointSpeedError,
    MgsError,
    ZmpMarginError,
)
from mgs.gait.gait_file import GaitFile
from mgs.gait.kinds import (
    BalanceGait,
    KeyframesGait,
    KickGait,
    PickUpGait,
    SequenceGait,
    WalkGait,
)


@dataclass(frozen=True)
class Change:
    """A change of one key of a gait file that may help."""

    key: str  # dotted path in the gait file
    text: str  # the change, with {} in the place of the key
    if_set: bool = False  # offered only where the key is there and not zero


GAMMA = Change("ik.gamma_joint", "a larger {}")
RECORD = Change("ik.on_limit", "{}: record, which keeps the motion")
SETTLE = Change("ik.solver", "{}: ik4, with which the posture settles at once")

RECORD_SPEED = Change("ik.on_limit", "{}: record, with which mgs validate reports the speed")

WALK = (
    Change("walk.step_length", "a shorter {}", if_set=True),
    Change("walk.lateral", "a smaller {}", if_set=True),
    Change("walk.step_yaw", "a smaller {}", if_set=True),
    Change("walk.steps", "smaller {}", if_set=True),
    Change("walk.footsteps", "{} nearer to each other", if_set=True),
    Change("walk.step_width", "a smaller {}", if_set=True),
    Change("walk.boxes", "lower {}", if_set=True),
    Change("walk.arm_swing", "a smaller {}", if_set=True),
    Change("walk.single_support", "a longer {}"),
)
KICK = (
    Change("kick.ball.x", "a nearer ball ({})"),
    Change("kick.direction", "a {} nearer to zero", if_set=True),
    Change("kick.back_swing", "a shorter {}"),
    Change("kick.follow_through", "a shorter {}"),
    Change("kick.step_width", "a smaller {}", if_set=True),
)
BALANCE = (
    Change("balance.channels", "smaller {}"),
    Change("balance.ease", "a longer {}"),
)
KEYFRAMES = (
    Change("keyframes.keys", "smaller displacements in {}"),
    Change("keyframes.keys", "more time between {}"),
)
PICK_UP = (
    Change("pick_up.object", "a {} nearer to the feet"),
    Change("pick_up.payload", "a smaller {}", if_set=True),
    Change("pick_up.approach", "a longer {}"),
)


def _rest(block: str) -> dict[type[MgsError], tuple[Change, ...]]:
    """Remedies of the kinds of gait whose CoM follows the ZMP and which rest before and after."""
    lead_in, lead_out = (Change(f"{block}.{key}", "a longer {}") for key in ("lead_in", "lead_out"))
    middle = Change(f"{block}.zmp_offset", "a {} nearer to the middle of the sole")
    return {
        ComNotAtRestError: (lead_out, Change("com.preview", "a longer {}")),
        ZmpMarginError: (middle, lead_in, lead_out),
    }


REMEDIES: dict[type[GaitFile], dict[type[MgsError], tuple[Change, ...]]] = {
    WalkGait: {
        FootstepError: (
            Change("walk.step_width", "a larger {}"),
            Change("walk.step_yaw", "a smaller {}", if_set=True),
            Change("walk.steps", "smaller turns in {}", if_set=True),
            Change("walk.footsteps", "{} farther from each other", if_set=True),
        ),
        IkError: (*WALK, Change("walk.com_height", "a lower {}")),
        JointLimitError: (GAMMA, *WALK, Change("walk.com_height", "another {}"), RECORD),
        JointSpeedError: (
            *WALK,
            Change("walk.step_height", "a lower {}"),
            Change("walk.com_height", "a lower {}"),
            RECORD_SPEED,
        ),
        CycleError: (Change("walk.n_steps", "a larger {}"), SETTLE),
        **_rest("walk"),
    },
    KickGait: {
        IkError: (*KICK, Change("kick.com_height", "a lower {}")),
        JointLimitError: (GAMMA, *KICK, Change("kick.com_height", "another {}"), RECORD),
        JointSpeedError: (
            Change("kick.speed", "a lower {}"),
            Change("kick.back_swing", "a longer {}"),
            Change("kick.follow_through", "a longer {}"),
        ),
        **_rest("kick"),
    },
    BalanceGait: {
        ComOutsideFeetError: (Change("balance.channels", "a smaller com_y in {}"),),
        IkError: (*BALANCE, Change("balance.com_height", "a lower {}")),
        JointSpeedError: (*BALANCE, RECORD_SPEED),
        JointLimitError: (GAMMA, *BALANCE, Change("balance.com_height", "another {}"), RECORD),
    },
    KeyframesGait: {
        ComOutsideFeetError: (Change("keyframes.keys", "a com nearer to the middle in {}"),),
        IkError: KEYFRAMES,
        JointSpeedError: (KEYFRAMES[1], RECORD_SPEED),
        JointLimitError: (*KEYFRAMES, RECORD),
    },
    PickUpGait: {
        ComOutsideFeetError: (Change("pick_up.object", "a {} nearer to the middle"),),
        IkError: PICK_UP,
        JointSpeedError: (PICK_UP[2], RECORD_SPEED),
        JointLimitError: (*PICK_UP, RECORD),
    },
    SequenceGait: {
        CycleError: (Change("sequence.parts", "a walk of more steps in {}"),),
    },
}


@contextmanager
def remedies_for(gait: GaitFile) -> Iterator[None]:
    """Complete errors raised inside: one without a remedy gets that for this kind of gait."""
    try:
        yield
    except MgsError as error:
        error.remedy = error.remedy or remedy_of(gait, error)
        raise


def remedy_of(gait: GaitFile, error: MgsError) -> str:
    """Changes of the gait that may help against an error, as a clause; empty where none is known.

    A change is left out where it cannot have an effect: of a key that the gait does not set, or
    that its IK solver does not use.
    """
    found = REMEDIES.get(type(gait), {}).get(type(error), ())
    texts = [change.text.format(change.key) for change in found if _has_effect(gait, change)]
    if not texts:
        return ""
    *first, last = texts
    return f"use {', '.join(first)} or {last}" if first else f"use {last}"


def _has_effect(gait: GaitFile, change: Change) -> bool:
    """Whether a change can have an effect on the motion of this gait."""
    if change is GAMMA:
        return bool(_value(gait, "ik.solver") == "clik")
    return not change.if_set or bool(_value(gait, change.key))


def _value(gait: GaitFile, key: str) -> object:
    """Value of a dotted key."""
    return reduce(getattr, key.split("."), gait)

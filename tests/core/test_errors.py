"""Errors carry their data, end with their remedy, and can be sent to another process."""

from __future__ import annotations

import pickle

import pytest

from mgs.core import errors
from mgs.core.errors import (
    ComNotAtRestError,
    ComOutsideFeetError,
    ConfigError,
    CycleError,
    DivergenceError,
    FootstepError,
    HardwareError,
    IkError,
    InfeasibleGaitError,
    InputError,
    JointLimitError,
    JointSpeedError,
    LogError,
    MgsError,
    MotionFileError,
    OutputExistsError,
    SeamError,
    SimulationError,
    ZmpMarginError,
)

EXAMPLES = [
    MgsError("something"),
    InputError("something"),
    ConfigError("a.yaml", ["dt: missing", "walk: missing"]),
    MotionFileError("a.mcap", "truncated"),
    InfeasibleGaitError("something"),
    FootstepError(2, 3, -0.004, 0.056),
    ComOutsideFeetError(0.2),
    ComNotAtRestError(4e-3, 2e-3, (2e-3, 1e-3)),
    ZmpMarginError(1.25, "left", 0.031, 0.03),
    IkError(1.25, "CoM", 3e-3, 2e-4, "m"),
    JointLimitError(1.25, "left_knee_pitch", -0.1, 0.0, 2.2),
    JointSpeedError(1.25, "left_knee_pitch", 7.5, 6.0),
    SeamError("sequence.parts.1 (walk)", "the CoM is 0.007 m off", "let both agree"),
    CycleError("no two steps"),
    SimulationError("no engine"),
    DivergenceError("diverged"),
    HardwareError("servo 3 does not answer"),
    LogError("too short"),
    OutputExistsError("a.mcap"),
]


def test_there_is_an_example_of_every_error():
    declared = {
        value
        for value in vars(errors).values()
        if isinstance(value, type) and issubclass(value, MgsError)
    }
    assert declared == {type(error) for error in EXAMPLES}


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda error: type(error).__name__)
def test_malformed_input_exits_with_2_and_every_other_error_with_1(error: MgsError):
    assert error.exit_code == (2 if isinstance(error, InputError) else 1)


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda error: type(error).__name__)
def test_an_error_is_the_same_after_pickling(error: MgsError):
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert copy.args == error.args
    assert vars(copy) == vars(error)


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (
            FootstepError(2, 3, -0.004, 0.056),
            "footsteps 2 and 3 overlap by 4.0 mm; their centres are 0.056 m apart",
        ),
        (
            ComOutsideFeetError(0.2),
            "the CoM is asked to go 0.200 m sideways from the middle, beyond both feet",
        ),
        (
            ComNotAtRestError(4e-3, 2e-3, (2e-3, 1e-3)),
            "the CoM still moves at 4.0 mm/s, 2.0 mm from its goal when the motion ends (2 mm/s "
            "and 1 mm are allowed)",
        ),
        (
            ZmpMarginError(1.25, "left", 0.031, 0.03),
            "t = 1.250 s: in left support no CoM motion keeps the ZMP 31.0 mm inside the support "
            "polygon, at most 30.0 mm",
        ),
        (
            ZmpMarginError(0.0, "double", 0.0, -0.147),
            "t = 0.000 s: in double support no CoM motion keeps the ZMP 0.0 mm inside the support "
            "polygon, it is 147.0 mm outside",
        ),
        (
            IkError(1.25, "CoM", 3e-3, 2e-4, "m"),
            "t = 1.250 s: CoM is 0.003 m off, 0.0002 m allowed",
        ),
        (
            JointLimitError(1.25, "knee", -0.1, 0.0, 2.2),
            "t = 1.250 s: joint knee at -0.1000 rad is 0.1000 rad outside its range "
            "[0.0000, 2.2000] rad",
        ),
        (
            JointLimitError(0.0, "knee", 2.5, 0.0, 2.2),
            "t = 0.000 s: joint knee at 2.5000 rad is 0.3000 rad outside its range "
            "[0.0000, 2.2000] rad",
        ),
        (
            JointSpeedError(1.25, "knee", 7.5, 6.0),
            "t = 1.250 s: joint knee would have to move at 7.50 rad/s, but its servo reaches "
            "6.00 rad/s",
        ),
    ],
)
def test_a_message_states_time_place_and_size_and_no_remedy(error: MgsError, message: str):
    assert str(error) == message
    assert error.remedy == ""


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda error: type(error).__name__)
def test_a_remedy_ends_the_message_also_after_pickling(error: MgsError):
    told = pickle.loads(pickle.dumps(error))
    told.remedy = "use another robot"
    for copy in (told, pickle.loads(pickle.dumps(told))):
        assert str(copy).endswith("; use another robot")
        assert str(copy).startswith(error.args[0])

"""Errors carry their data, tell a remedy, and survive the way between processes."""

from __future__ import annotations

import pickle

import pytest

from mgs.core import errors
from mgs.core.errors import (
    ConfigError,
    CycleError,
    DivergenceError,
    FootstepError,
    IkError,
    InfeasibleGaitError,
    InputError,
    JointLimitError,
    MgsError,
    MotionFileError,
    OutputExistsError,
    SeamError,
    SimulationError,
)

EXAMPLES = [
    MgsError("something"),
    InputError("something"),
    ConfigError("a.yaml", ["dt: missing", "walk: missing"]),
    MotionFileError("a.mcap", "truncated"),
    InfeasibleGaitError("something"),
    FootstepError(2, 3, -0.004, "try a larger step_width"),
    IkError(1.25, "CoM", 3e-3, 2e-4, "m"),
    JointLimitError(1.25, "left_knee_pitch", -0.1, 0.0, 2.2),
    SeamError("sequence.parts.1 (walk)", "the CoM is 0.007 m off", "let both agree"),
    CycleError("no two steps"),
    SimulationError("no engine"),
    DivergenceError("diverged"),
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
def test_an_error_is_the_same_after_a_journey_to_another_process(error: MgsError):
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert copy.args == error.args
    assert vars(copy) == vars(error)


def test_messages_say_where_and_by_how_much():
    assert str(FootstepError(2, 3, -0.004, "x")) == "footsteps 2 and 3 overlap by 4.0 mm; x"
    assert "t = 1.250 s: CoM is 0.003 m off, 0.0002 m allowed" in str(EXAMPLES[6])
    message = str(JointLimitError(1.25, "knee", -0.1, 0.0, 2.2))
    assert "joint knee at -0.1000 rad is 0.1000 rad outside its range [0.0000, 2.2000]" in message
    assert "is 0.3000 rad outside" in str(JointLimitError(0.0, "knee", 2.5, 0.0, 2.2))

"""Errors of arithmetic in a solver become messages that name a remedy."""

from __future__ import annotations

import numpy as np
import pytest

from mgs.core.errors import InfeasibleGaitError
from mgs.core.plugins import IK_SOLVERS
from mgs.gait import load_gait
from mgs.ik_solver.solve import solve_ik
from mgs.pipeline import Stages
from mgs.robot import Robot


@pytest.mark.parametrize(
    "error", [ArithmeticError("DAQP ended"), np.linalg.LinAlgError("singular")]
)
def test_an_arithmetic_error_becomes_a_message_with_a_remedy(
    melson: Robot, walk_5cm: Stages, monkeypatch: pytest.MonkeyPatch, error: Exception
):
    def breaks(*_: object) -> None:
        raise error

    gait = load_gait("melson/walk_5cm", ("ik.solver=ik2",))
    monkeypatch.setattr(IK_SOLVERS.load("ik2"), "solve", breaks)
    with pytest.raises(InfeasibleGaitError, match=rf"ik2: {error}; .* take ik4"):
        solve_ik(melson, walk_5cm.tasks, walk_5cm.com, gait.ik)

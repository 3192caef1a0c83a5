"""Reports of the solvers: their kinds, and the keys that motion files contain."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mgs.ik_solver import JointTrajectory
from mgs.ik_solver.clik import ClosedLoopReport
from mgs.ik_solver.hard_soft import FarajiReport
from mgs.ik_solver.joint_trajectory import SolverReport
from mgs.ik_solver.prioritized import Phase, PrioritizedReport
from mgs.ik_solver.whole_motion import TrajectoryReport

PHASE = Phase(0.5, "left", rows=6, rank=6, base_rank=6, critical_rows=8, critical_rank=8, count=2)
REPORTS = [
    ClosedLoopReport(3),
    FarajiReport(1e-9, 0, 1),
    PrioritizedReport((PHASE,), 2, {"left sole": 1e-6}),
    TrajectoryReport([2.0, 1.0], 1, 1e-4),
]
KEYS = [
    ["newton_updates", "held_steps"],
    ["hard_error", "elastic_samples", "recovering_samples", "returns"],
    ["phases", "corrections", "worst_errors"],
    ["objective", "iterations", "projected_gradient"],
]
PHASE_KEYS = [
    "start", "support", "rows", "rank", "base_rank", "critical_rows", "critical_rank", "count",
]  # fmt: skip


@pytest.mark.parametrize(("report", "keys"), list(zip(REPORTS, KEYS, strict=True)))
def test_a_report_has_the_keys_of_motion_files_and_is_plain_data(
    report: SolverReport, keys: list[str]
):
    data = report.to_dict()
    assert list(data) == keys
    assert json.loads(json.dumps(data)) == data  # lists and dictionaries, no tuples


def test_a_phase_is_reported_with_its_ranks():
    (phase,) = json.loads(json.dumps(REPORTS[2].to_dict()))["phases"]
    assert list(phase) == PHASE_KEYS
    assert (phase["support"], phase["critical_rank"], phase["count"]) == ("left", 8, 2)


def test_a_report_of_another_solver_is_an_error():
    joints = JointTrajectory(np.zeros((2, 3)), report=REPORTS[0])
    assert joints.report_of(ClosedLoopReport) is REPORTS[0]
    with pytest.raises(TypeError, match="ClosedLoopReport, not a FarajiReport"):
        joints.report_of(FarajiReport)
    with pytest.raises(TypeError, match="NoneType"):
        JointTrajectory(np.zeros((2, 3))).report_of(FarajiReport)

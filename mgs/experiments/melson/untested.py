"""Sentences of the article that state a result and cannot be tested here, with the reasons."""

from __future__ import annotations

from mgs.experiments.claim import Claim

UNTESTED = (
    (
        "tested_on_robot",
        "the method has been tested in simulations and experiments on a humanoid robot Melson",
        "Abstract",
        "there is no robot; `mgs validate` replays the gaits melson/s1, melson/s2 and melson/s3 in "
        "two physics engines (docs/gallery.md)",
    ),
    (
        "fewer_operations",
        "with the Jacobian of the CoM the gravity torques need n iterations instead of n^2",
        "Section 3.3",
        "a statement on formulas; tests/ik_solver/tree compares eq. (24) with virtual work",
    ),
    (
        "left_ankle_roll_torque",
        "for the ankle about x, the torque has not been reduced in scenario 3",
        "Section 5, Fig. 5",
        "cannot fail: the axis is fixed to the support sole, so that the CoM, which is a task, "
        "determines the torque; tests/experiments shows this",
    ),
    (
        "same_task",
        "for each scenario the task space trajectory is the same",
        "Section 5",
        "cannot fail: stages 1 to 3 do not know the secondary task; tests/experiments compares "
        "the trajectories bit by bit",
    ),
    (
        "task_met",
        "with both values of gamma_joint the task trajectory is performed correctly",
        "Section 5",
        "the solver refuses a motion that misses a task; tests/experiments measures errors below "
        "0.1 mm and 0.01 deg in all runs with a model that the solver does not use",
    ),
    (
        "validated",
        "all experiments validated the correctness of the algorithm",
        "Section 6",
        "a summary of the claims above",
    ),
)  # fmt: skip


def untested_claims() -> dict[str, Claim]:
    """Claims by id, without a figure."""
    return {
        id_: Claim(id_, sentence, "", "not applicable", reason, source=source)
        for id_, sentence, source, reason in UNTESTED
    }

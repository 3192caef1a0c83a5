"""Claims on the walk of thirty steps: figures 9 and 10 of the article."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.experiments.claim import Claim
from mgs.experiments.melson.runs import Study, peak, stride_poses
from mgs.experiments.melson.text import show
from mgs.experiments.melson.thresholds import ENCODER_STEP, LAST_STRIDES

DRIFT_JOINT = "right_hip_roll"
HOW = (
    "range of the angles at the starts of left single supports, at equal phases, over the last ten "
    f"of 30 steps; less than one encoder step of the servos, {ENCODER_STEP:.2f} deg, counts as none"
)


def drift_series(study: Study) -> dict[str, Array]:
    """Angle (n_steps / 2,) [deg] of the joint of figure 10 once every two steps, by scenario."""
    i = study.robot.joint_names.index(DRIFT_JOINT)
    return {name: stride_poses(walk)[:, i] for name, walk in study.long.items()}


def drift_claims(study: Study) -> list[Claim]:
    """Claims on the pose after 30 steps and on joint drift."""
    return [_final_poses(study), *_figure_10(study), _cyclic(study)]


def _final_poses(study: Study) -> Claim:
    ends = {name: walk.angles[[0, -1]] for name, walk in study.long.items()}
    apart = ends["S1"][1] - ends["S2"][1]
    joint = study.robot.joint_names[int(np.abs(apart).argmax())].replace("_", " ")
    change = {name: peak(end[1] - end[0]) for name, end in ends.items()}
    return Claim(
        "final_poses_differ",
        "the final pose after 30 steps is different for different values of gamma_joint",
        f"{peak(apart):.1f} deg, {joint}",
        peak(apart) > ENCODER_STEP,
        "largest difference of a joint between S1 and S2; the first poses are equal. Last pose "
        f"against first pose: {show(change, 'deg', 1)}; that of S2 moves too, because the "
        "half-sitting posture is not the minimum of H_joint",
        {"difference": peak(apart)},
        "Section 5, Fig. 9",
        ("S1", "S2"),
    )


def _figure_10(study: Study) -> list[Claim]:
    series = drift_series(study)
    moved = {name: float(np.ptp(angle[-LAST_STRIDES - 1 :])) for name, angle in series.items()}
    whole = {name: float(np.ptp(angle)) for name, angle in series.items()}
    sentences = (
        ("drift_visible", "S1", "in the first scenario (gamma_joint = 0) joint drift is visible"),
        ("drift_absent", "S2", "in the second scenario (gamma_joint = 1) there is no joint drift"),
    )
    return [
        Claim(
            id_,
            f"{sentence} (right hip about x)",
            f"{moved[name]:.4f} deg",
            (moved[name] > ENCODER_STEP) == (name == "S1"),
            f"{HOW}. Over all 30 steps: {whole[name]:.2f} deg",
            {"last": moved[name], "all": whole[name]},
            "Section 5, Fig. 10",
            (name,),
        )
        for id_, name, sentence in sentences
    ]


def _cyclic(study: Study) -> Claim:
    poses = stride_poses(study.long["S2"])
    moved = np.ptp(poses[-LAST_STRIDES - 1 :], axis=0)
    worst = int(moved.argmax())
    return Claim(
        "cyclic",
        "joint limit avoidance guarantees cyclic joint motions and avoids joint drift (all joints)",
        f"{moved[worst]:.4f} deg, {study.robot.joint_names[worst].replace('_', ' ')}",
        bool(moved[worst] < ENCODER_STEP),
        f"largest {HOW}. The first strides are a transient: over all 30 steps joints move by up "
        f"to {float(np.ptp(poses, axis=0).max()):.1f} deg",
        {"last": float(moved[worst])},
        "Section 3.2",
        ("S2",),
    )

"""Sequences: where they lead, and that nothing jumps where one part follows another."""

from __future__ import annotations

import cmath
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.core.errors import ConfigError, InfeasibleGaitError, SeamError
from mgs.core.plugins import IK_SOLVERS
from mgs.gait import SequenceGait, SingleGait, load_gait
from mgs.judge.motion_checks import check_motion
from mgs.motion import Motion
from mgs.pipeline import generate, run_stages
from mgs.robot import load_robot
from tests.support.strategies import balance_gait, constant, numbers, sine, walk_gait

MELSON = load_robot("melson")
DT = 0.02
QUICK = {
    "dt": DT,
    "com": {"preview": 0.9, "passes": 0},
    "lead_in": 0.9,
    "lead_out": 0.9,
    "double_support": 0.4,
    "single_support": 0.4,
}


def quick_walk(**changes: Any) -> SingleGait:
    return walk_gait(**{**QUICK, "n_steps": 2, **changes})


def quick_sway(**changes: Any) -> SingleGait:
    return balance_gait(sine("com_y", 0.02), dt=DT, ease=0.5, duration=3.0, **changes)


def sequence_of(*gaits: SingleGait, repeat: int = 1, **block: Any) -> SequenceGait:
    parts = [{"gait": gait.model_dump(), "repeat": repeat} for gait in gaits]
    tree = {"mgs": 1, "motion": "sequence", "dt": DT, "sequence": {"parts": parts, **block}}
    return SequenceGait.model_validate(tree)


def made(*gaits: SingleGait, **block: Any) -> Motion:
    return generate(MELSON, sequence_of(*gaits, **block)).motion


def seams(motion: Motion, *gaits: SingleGait) -> list[int]:
    """Samples at which a part begins, from the durations alone; there are no transitions."""
    lengths = [run_stages(MELSON, gait).plan.n_samples - 1 for gait in gaits]
    assert motion.n_samples == sum(lengths) + 1
    return [int(k) for k in np.cumsum(lengths)[:-1]]


def middle(soles: np.ndarray) -> tuple[complex, float]:
    """Place and heading midway between two soles (2, 7) that stand side by side, flat."""
    place = complex(*soles[:, :2].mean(axis=0))
    heading = cmath.phase(sum(complex(w, z) ** 2 for z, w in soles[:, 5:]))
    return place, heading


short_walks = st.builds(
    quick_walk,
    n_steps=st.integers(2, 3),
    step_length=numbers(-0.04, 0.04),
    lateral=numbers(-0.02, 0.02),
    step_yaw=numbers(-0.15, 0.15),
    first_support=st.sampled_from(["left", "right", None]),
)


@settings(max_examples=8)
@given(st.lists(short_walks, min_size=2, max_size=3))
def test_a_sequence_ends_where_its_parts_add_up_to_in_the_complex_plane(gaits):
    """Each part is a turn and a shift z -> z exp(i yaw) + place, composed from the left."""
    place, heading = 0j, 0.0
    for gait in gaits:
        step, turn = middle(run_stages(MELSON, gait).motion.soles_ref[-1])
        place, heading = place + step * cmath.exp(1j * heading), heading + turn
    motion = made(*gaits)
    found, turned = middle(motion.soles[-1])
    assert abs(found - place) < 1e-4  # [m], the inverse kinematics' own tolerance
    assert abs(turned - heading) < 2e-4
    assert abs(middle(motion.soles_ref[-1])[0] - place) < 1e-12
    for part, step in zip((0, 1), motion.footsteps[-2:], strict=True):
        assert step.side == motion.footsteps[-2 + part].side
        at = motion.soles_ref[-1, step.side]
        assert_allclose([step.x, step.y], at[:2], atol=1e-12)


WALKS = (quick_walk(step_length=0.03, step_yaw=0.1), quick_walk(lateral=0.02), quick_sway())


@pytest.fixture(scope="module")
def mixed() -> Motion:
    return made(*WALKS)


def test_joints_do_not_jump_at_a_seam(mixed: Motion):
    """Second differences of the joint angles at a seam, where all is at rest, are next to none."""
    q = mixed.q[:, 7:]
    for k in seams(mixed, *WALKS):
        assert np.abs(np.diff(q[k - 2 : k + 3], axis=0)).max() < 0.05 * DT
        assert np.abs(np.diff(q[k - 2 : k + 3], 2, axis=0)).max() < 0.02 * DT


def test_velocities_are_central_differences_across_seams_too(mixed: Motion):
    model = MELSON.model
    for k in (*seams(mixed, *WALKS), 40, mixed.n_samples - 40):
        v = pin.difference(model, mixed.q[k - 1], mixed.q[k + 1]) / (2 * DT)
        assert_allclose(mixed.v[k], v, atol=1e-6)


def test_poses_of_a_moved_part_are_those_of_its_joints(mixed: Motion):
    """Forward kinematics from the base that the sequence states."""
    data = MELSON.model.createData()
    for k in range(0, mixed.n_samples, 25):
        pin.framesForwardKinematics(MELSON.model, data, mixed.q[k])
        com = pin.centerOfMass(MELSON.model, data, mixed.q[k])
        assert_allclose(mixed.com[k], com, atol=1e-9)
        frames = (*MELSON.sole_frames, *MELSON.hand_frames, MELSON.torso_frame)
        poses = np.vstack([mixed.soles[k], mixed.hands[k], mixed.torso[k][None]])
        for frame, pose in zip(frames, poses, strict=True):
            assert np.abs(pin.log6(data.oMf[frame].actInv(pin.XYZQUATToSE3(pose)))).max() < 1e-9
    quat = mixed.q[:, 3:7]
    assert np.sum(quat[1:] * quat[:-1], axis=1).min() > 0.9  # no change of sign


def test_a_sequence_passes_every_static_check(mixed: Motion):
    assert [check.name for check in check_motion(mixed) if not check.ok] == []


def test_a_sequence_of_one_part_is_that_part():
    gait = quick_walk(step_length=0.03)
    alone, motion = run_stages(MELSON, gait).motion, made(gait)
    for name in ("support", "q", "v", "torque", "com", "zmp", "soles_ref", "torso_ref"):
        assert np.array_equal(getattr(alone, name), getattr(motion, name)), name
    assert motion.footsteps == alone.footsteps


@pytest.mark.parametrize("solver", IK_SOLVERS.own)
def test_every_solver_begins_with_the_joints_that_it_is_given(solver: str):
    ik = {"solver": solver, "torso": "free"}
    gait = quick_walk(step_length=0.03, dt=0.01, lead_in=1.8, lead_out=1.8, ik=ik)
    alone = run_stages(MELSON, gait).motion.q[:, 7:]
    first = run_stages(MELSON, gait, start=alone[-1]).motion.q[0, 7:]
    assert_allclose(first, alone[-1], atol=5e-4)
    if solver == "clik":  # which drifts: what it is given tells
        assert np.abs(alone[-1] - alone[0]).max() > 5e-3


def test_a_part_may_be_repeated():
    gait = quick_walk(step_length=0.03)
    once, thrice = made(gait), generate(MELSON, sequence_of(gait, repeat=3)).motion
    assert thrice.n_samples - 1 == 3 * (once.n_samples - 1)
    assert thrice.soles_ref[-1, 0, 0] == pytest.approx(3 * once.soles_ref[-1, 0, 0])


LOW = quick_walk(step_length=0.03, com_height=0.26)


def test_a_transition_leads_to_another_posture_over_soles_that_stay():
    motion = made(quick_walk(), LOW)
    n = run_stages(MELSON, LOW).plan.n_samples - 1
    assert motion.n_samples == 2 * n + 51  # a second of transition
    over = slice(n, n + 51)
    assert motion.com[n, 2] - motion.com[n + 50, 2] > 0.005
    assert np.abs(motion.soles[over] - motion.soles[n]).max() < 1e-4
    assert [check.name for check in check_motion(motion) if not check.ok] == []
    drop = np.diff(motion.com[over, 2])
    assert drop.max() < 1e-6  # it goes down and nothing else


def test_without_a_transition_another_posture_is_refused_with_the_difference():
    with pytest.raises(
        SeamError, match=r"parts\.1 \(walk\) .* the CoM is 0\.00\d+ m off"
    ) as caught:
        made(quick_walk(), LOW, transition=0.0)
    assert caught.value.part == "sequence.parts.1 (walk)"
    assert str(caught.value).endswith(
        "; use a longer sequence.transition than 0, or the same CoM and hands in both parts"
    )


def test_another_step_width_is_refused_whatever_the_transition():
    with pytest.raises(SeamError, match=r"the left sole is 0\.01\d* m off, 0\.0002 m allowed"):
        made(quick_walk(), quick_walk(step_width=0.12))


def test_a_part_that_does_not_end_at_rest_is_refused(monkeypatch):
    swift = balance_gait(constant("com_x", 0.03), dt=DT, rest=0.0, ease=0.06, duration=1.0)
    with pytest.raises(SeamError, match=r"the speed of \w+ is .* rad/s off"):
        made(swift, quick_walk())


def test_what_a_part_cannot_do_is_told_with_its_name():
    far = quick_walk(step_length=0.3)
    with pytest.raises(InfeasibleGaitError, match=r"^sequence\.parts\.1 \(walk\): t = ") as caught:
        made(quick_walk(), far)
    assert "; use a shorter walk.step_length" in str(caught.value)
    short = quick_walk(single_support=0.04)
    with pytest.raises(ConfigError, match=r"^sequence\.parts\.1 \(walk\): walk\.single_supp"):
        made(quick_walk(), short)


def test_progress_of_the_parts_is_that_of_the_whole():
    told: list[tuple[int, int]] = []
    gait = sequence_of(quick_walk(), quick_walk())
    generate(MELSON, gait, progress=lambda done, total: told.append((done, total)))
    assert [done for done, _ in told] == sorted(done for done, _ in told)
    assert {total for _, total in told} == {told[-1][0]}


def test_walk_turn_walk_comes_back_facing_the_other_way():
    gait = load_gait("melson/walk_turn_walk", ("com.passes=0",))
    place, heading = middle(generate(MELSON, gait).motion.soles[-1])
    assert abs(place) < 0.01
    assert abs(abs(heading) - np.pi) < 0.01

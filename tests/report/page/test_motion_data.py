"""What a page says about a motion, against closed forms and other ways to compute it."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from mgs.core.constants import FLOATING_BASE_NV, GRAVITY
from mgs.motion import Motion
from mgs.motion.energy import energy_of, positive_power
from mgs.report.page.motion_data import (
    contact_force,
    ground_data,
    kept_samples,
    motion_arrays,
)
from tests.report.page.test_arrays import unpacked


@pytest.mark.parametrize(("n", "most"), [(1, 10), (2, 2), (10, 10), (11, 10), (160_401, 16_000)])
def test_kept_samples_are_evenly_spread_and_end_with_the_last(n: int, most: int):
    kept = kept_samples(n, most)
    assert kept[0] == 0 and kept[-1] == n - 1 and len(kept) <= most + 1
    assert len(np.unique(np.diff(kept)[:-1])) <= 1


def test_the_contact_force_is_the_rate_of_the_centroidal_momentum(walk: Motion):
    """Pinocchio derives the linear momentum from joint velocities, not from the CoM."""
    model, data = walk.robot.model, walk.robot.model.createData()
    momentum = np.empty((walk.n_samples, 3))
    for k in range(walk.n_samples):
        pin.computeCentroidalMomentum(model, data, walk.q[k], walk.v[k])
        momentum[k] = data.hg.linear
    rate = np.gradient(momentum, walk.dt, axis=0)
    force = contact_force(walk) - np.array([0.0, 0.0, walk.robot.mass * GRAVITY])
    # the two differences differ by the third derivative of the CoM
    np.testing.assert_allclose(force[5:-5], rate[5:-5], atol=0.08 * np.abs(rate).max())
    assert np.sqrt(np.mean((force - rate)[5:-5] ** 2)) < 0.1 * np.sqrt(np.mean(rate**2))


def test_the_energy_ends_with_the_work_of_the_motion(walk: Motion):
    arrays, energy = motion_arrays(walk, kept_samples(walk.n_samples, 40)), energy_of(walk)
    assert energy is not None
    shown = unpacked(arrays["energy"])[:, 0]
    assert (np.diff(shown) >= 0.0).all()
    assert shown[-1] == pytest.approx(energy.positive_work, rel=1e-6)  # of 32-bit numbers


def test_thinning_out_keeps_every_peak(walk: Motion):
    arrays = motion_arrays(walk, kept_samples(walk.n_samples, 40))
    step = (walk.n_samples + 39) // 40
    assert arrays["t"]["rows"] <= 41
    for name, values in (
        ("torque", walk.torque),
        ("v", walk.v[:, FLOATING_BASE_NV:]),
        ("power", positive_power(walk)[:, None]),
    ):
        shown = unpacked(arrays[name])
        np.testing.assert_allclose(
            np.abs(shown).max(axis=0),
            np.abs(values).max(axis=0),
            rtol=1e-4,
            atol=1e-9,
            err_msg=name,
        )
    assert step > 5


def test_footsteps_and_polygons_are_those_of_the_motion(walk: Motion):
    ground = ground_data(walk)
    assert len(ground["footsteps"]) == len(walk.footsteps)
    starts = [0, *(np.flatnonzero(np.diff(walk.support)) + 1)]
    assert [p["t"] for p in ground["polygons"]] == pytest.approx([k * walk.dt for k in starts])
    soles = walk.robot.sole_spec(walk.footsteps[0].side)
    first = np.array(ground["polygons"][0]["points"])
    assert np.ptp(first[:, 0]) == pytest.approx(soles.length, abs=1e-4)

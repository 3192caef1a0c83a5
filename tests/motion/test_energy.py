"""Energy of motions: against closed forms and against the power that the whole robot receives."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest

from mgs.core.constants import GRAVITY
from mgs.gait import load_gait, parse_gait
from mgs.motion.energy import energy_of, way_of_soles
from mgs.pipeline import run_stages
from mgs.robot import Robot
from tests.support.motions import standing


def test_work_and_squared_torques_of_a_harmonic_joint_are_the_closed_form(melson: Robot):
    """Torque a sin(wt) at speed b sin(wt + phase) over whole periods."""
    n, w, a, b, phase = 4000, 2.0 * np.pi, 0.7, 1.3, 1.1
    motion = standing(melson, 0.1)
    dt = 4.0 / n
    t = dt * np.arange(n)
    torque, v = np.zeros((n, melson.n)), np.zeros((n, 6 + melson.n))
    torque[:, 3], v[:, 6 + 3] = a * np.sin(w * t), b * np.sin(w * t + phase)
    soles = np.repeat(motion.soles[:1], n, axis=0)
    soles[:, 0, 0] += np.linspace(0.0, 0.4, n)  # one sole by 0.4 m, the midpoint by 0.2 m
    made = dataclasses.replace(motion, torque=torque, v=v, soles=soles, dt=dt)
    energy = energy_of(made)
    assert energy is not None
    # the mean of max(sin x sin(x + p), 0) is ((pi - p) cos p + sin p) / (2 pi) for 0 <= p <= pi
    mean = a * b * ((np.pi - phase) * np.cos(phase) + np.sin(phase)) / (2.0 * np.pi)
    assert energy.positive_work == pytest.approx(4.0 * mean, rel=1e-5)
    assert energy.torque_squared == pytest.approx(4.0 * a**2 / 2.0, rel=1e-9)
    expected = 4.0 * mean / (melson.mass * GRAVITY * 0.2)
    assert energy.cost_of_transport == pytest.approx(expected, rel=1e-5)


def test_positive_and_negative_power_together_are_the_change_of_mechanical_energy(melson: Robot):
    """Kinetic energy, of the rotors too, and potential energy are Pinocchio's."""
    motion = run_stages(melson, load_gait("melson/squat")).motion
    power = np.sum(motion.torque * motion.v[:, 6:], axis=1)
    model, data = melson.model, melson.model.createData()
    stored = []
    for q, v in zip(motion.q, motion.v, strict=True):
        kinetic = pin.computeKineticEnergy(model, data, q, v)
        rotors = 0.5 * np.sum(melson.armature * v[6:] ** 2)
        stored.append(kinetic + rotors + pin.computePotentialEnergy(model, data, q))
    done = np.cumsum(0.5 * (power[1:] + power[:-1])) * motion.dt
    change = np.array(stored[1:]) - stored[0]
    assert np.ptp(change) > 1e-3  # [J]: there is something to compare
    assert np.abs(done - change).max() < 0.03 * np.ptp(change)  # central differences at 10 ms


def test_who_stands_still_does_no_work_and_has_no_cost_of_transport(melson: Robot):
    still = standing(melson, 1.0)
    torque = np.full((still.n_samples, melson.n), 0.2)
    energy = energy_of(dataclasses.replace(still, torque=torque))
    assert energy is not None
    assert energy.positive_work == pytest.approx(0.0, abs=1e-12)
    assert energy.torque_squared == pytest.approx(1.01 * melson.n * 0.2**2)
    assert energy.cost_of_transport is None


def test_the_way_is_the_length_of_the_path_of_the_midpoint():
    soles = np.zeros((5, 2, 7))
    soles[:, 0, :2] = [[0, 0], [1, 0], [1, 0], [1, 1], [0, 1]]
    assert way_of_soles(soles) == pytest.approx(1.5)


def test_a_motion_without_balance_has_no_energy(melson: Robot):
    """What bears the robot on the way is not known, and so are its torques."""
    gait = "{mgs: 1, motion: keyframes, keyframes: {balance: off, rest: 0.1, keys: [{time: 0.4}]}}"
    assert energy_of(dataclasses.replace(standing(melson, 0.1), gait=parse_gait(gait, "x"))) is None

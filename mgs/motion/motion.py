"""The motion that the pipeline makes, a motion file holds and checks and physics judge."""

from __future__ import annotations

import importlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Footstep
from mgs.core.scene import EMPTY, Scene
from mgs.gait import Gait
from mgs.motion.provenance import Provenance
from mgs.robot import Robot


@dataclass(frozen=True, eq=False)
class Motion:
    """A joint trajectory with the references it follows; world frame, SI units, first axis time.

    Poses are x, y, z and quaternion xyzw; the side axis is (left, right). Where nothing is asked of
    hand or torso, its reference is what it does.
    """

    robot: Robot
    gait: Gait
    gait_name: str
    dt: float  # [s]
    footsteps: tuple[Footstep, ...]
    support: NDArray[np.int8]  # (N,) values of Support
    q: Array  # (N, 7 + n) base position, base quaternion xyzw, joint angles
    v: Array  # (N, 6 + n) base twist in the base frame, joint velocities; 0 at both ends
    torque: Array  # (N, n) joint torques predicted by inverse dynamics [N m]
    com: Array  # (N, 3) reached by the joints
    com_ref: Array  # (N, 3) asked by stage 3
    zmp: Array  # (N, 2) multibody ZMP, by whole-body inverse dynamics
    zmp_ref: Array  # (N, 2) asked by stage 2
    soles: Array  # (N, 2, 7) reached
    soles_ref: Array  # (N, 2, 7) asked
    hands: Array  # (N, 2, 7) reached
    hands_ref: Array  # (N, 2, 3) asked; hands have no orientation task
    torso: Array  # (N, 7) reached
    torso_ref: Array  # (N, 4) orientation asked, quaternion xyzw
    provenance: Provenance
    scene: Scene = EMPTY

    def __repr__(self) -> str:
        return (
            f"<Motion {self.gait_name} of {self.robot.spec.name}: {self.gait.motion}, "
            f"{self.duration:.2f} s, {self.n_samples} samples of {self.dt:g} s, "
            f"solver {self.provenance.solver.name}>"
        )

    def _repr_png_(self) -> bytes | None:
        """Picture that a notebook shows; None without matplotlib, so that it shows the repr."""
        # Rooms import only from earlier rooms, and drawing is a later one. It is called by its name
        # at the moment when a notebook asks; nothing that uses a motion depends on it.
        try:
            drawing = importlib.import_module("mgs.report.picture")
        except ModuleNotFoundError:
            return None
        return drawing.picture_png(self)

    @property
    def n_samples(self) -> int:
        """Number of samples N."""
        return len(self.q)

    @property
    def duration(self) -> float:
        """From the first to the last sample [s]."""
        return (self.n_samples - 1) * self.dt

    @property
    def times(self) -> Array:
        """Sample times (N,) [s]."""
        return self.dt * np.arange(self.n_samples, dtype=np.float64)

    @property
    def payload(self) -> Array | None:
        """Masses (N, 2) that left and right hand carry [kg]; None: none at any time."""
        return self.gait.payload(self.times)

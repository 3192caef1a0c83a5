"""Levels of tasks exactly as the paper prints them: eqs. (7), (16) and (17), and footnote 3.

M. Mistry, J. Nakanishi, G. Cheng and S. Schaal, "Inverse kinematics with floating base and
constraints for full body humanoid robot control", Humanoids 2008. With task velocities r, or in
eq. (18) accelerations less dJ/dt v, and the right pseudo-inverse J^+ = J^T (J J^T)^-1:

    (7)         v = [J_A; J_B; J_E]^+ [r_A; r_B; r_E]
    (16)        v = J_A^+ r_A + N_A J_B^+ r_B + N_AB J_E^+ r_E
                N_A = I - J_A^+ J_A,   N_AB = I - [J_A; J_B]^+ [J_A; J_B]
    footnote 3  N_A N_AB^lambda in the place of N_AB, with [J_A; J_B]^+ damped by lambda

There is no posture in the directions that no level determines, no bound of conflicting levels and
no correction of the result. `PriorityLevels` is the form with all of these.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import scipy.linalg

from mgs.core.arrays import Array

PrintedForm = Literal["equation_7", "equation_16", "footnote_3"]
PRINTED_FORMS: tuple[PrintedForm, ...] = ("equation_7", "equation_16", "footnote_3")
DAMPING = 0.02  # lambda of footnote 3, for rows in m and rad


def printed_solution(
    form: PrintedForm, J: Array, rates: Array, levels: list[slice], damping: float = DAMPING
) -> Array:
    """Generalised velocity (or acceleration) (6 + n,) of the printed equations.

    Args:
        form: equation_7, equation_16 or footnote_3.
        J: (m, 6 + n) Jacobian in the order of the levels.
        rates: (m,) task velocities (or accelerations).
        levels: rows of the levels A, B and E; empty levels are left out.
        damping: lambda of footnote 3.

    Raises:
        numpy.linalg.LinAlgError: rows of a level depend on each other, so that its right
            pseudo-inverse does not exist.
    """
    if form == "equation_7":
        return _right_inverse(J, rates)
    a, b, e = levels
    v = _right_inverse(J[a], rates[a]) if a.stop > a.start else np.zeros(J.shape[1])
    if b.stop > b.start:
        v = v + _project(J[a], _right_inverse(J[b], rates[b]))
    if e.stop > e.start:
        low = _right_inverse(J[e], rates[e])
        above = J[a.start : b.stop]
        if form == "equation_16":
            v = v + _project(above, low)
        else:
            v = v + _project(J[a], _project(above, low, damping))
    return v


def _right_inverse(J: Array, r: Array) -> Array:
    """J^T (J J^T)^-1 r, of length 6 + n."""
    return np.asarray(J.T @ _solve(J @ J.T, r))


def _project(J: Array, v: Array, damping: float = 0.0) -> Array:
    """Apply (I - J^T (J J^T + lambda^2 I)^-1 J) to v (6 + n,)."""
    if not len(J):
        return v
    M = J @ J.T
    M[np.diag_indices_from(M)] += damping**2
    return np.asarray(v - J.T @ _solve(M, J @ v))


def _solve(M: Array, r: Array) -> Array:
    return np.asarray(scipy.linalg.cho_solve(scipy.linalg.cho_factor(M), r))

"""Crocoddyl's side of benchmarks/whole_body.py, for an interpreter that has Crocoddyl.

    python benchmarks/crocoddyl_side.py PROBLEM.npz SOLUTION.npz [--verbose]

C. Mastalli et al., "Crocoddyl: an efficient and versatile framework for multi-contact optimal
control", ICRA 2020. The problem is that of mgs.search.whole_body: the same semi-implicit Euler
steps, contacts and terms of the objective. FDDP knows no constraints: wrench cones, ranges, the
last posture and the place of a sole that does not bear are penalties.
"""

from __future__ import annotations

import sys
from typing import Any

import crocoddyl
import numpy as np
import pinocchio as pin

GAINS = (0.25, 1.0)  # that keep soles in place, in 1 / h^2 and 1 / h; twice as much oscillates
LEAST_DECREASE = 1e-10


def main() -> None:
    """Solve the problem of the first file and write the second."""
    given = np.load(sys.argv[1])
    model = pin.buildModelFromXML(str(given["urdf"]), pin.JointModelFreeFlyer())
    assert list(model.names)[2:] == list(given["joints"])
    model.armature = np.concatenate([np.zeros(6), given["armature"]])
    frames = []
    for name, parent, place in zip(
        ("left", "right", "trunk"), given["parents"], given["placements"], strict=True
    ):
        joint = int(parent)
        frames.append(
            model.addFrame(
                pin.Frame(f"mgs {name}", joint, 0, pin.XYZQUATToSE3(place), pin.FrameType.OP_FRAME)
            )
        )
    state = crocoddyl.StateMultibody(model)
    actuation = crocoddyl.ActuationModelFloatingBase(state)
    n = len(given["plan"])
    running = [
        crocoddyl.IntegratedActionModelEuler(
            action(given, k, state, actuation, frames), float(given["h"])
        )
        for k in range(n - 1)
    ]
    terminal = crocoddyl.IntegratedActionModelEuler(end(given, state, actuation), 0.0)
    x0 = np.concatenate([given["plan"][0], np.zeros(model.nv)])
    solver = crocoddyl.SolverFDDP(crocoddyl.ShootingProblem(x0, running, terminal))
    solver.th_stop = LEAST_DECREASE
    xs = [x0]
    for before, q in zip(given["plan"][:-1], given["plan"][1:], strict=True):
        xs.append(np.concatenate([q, pin.difference(model, before, q) / given["h"]]))
    us = [k.quasiStatic(k.createData(), x) for k, x in zip(running, xs[:-1], strict=True)]
    if "--verbose" in sys.argv:
        solver.setCallbacks([crocoddyl.CallbackVerbose()])
    converged = solver.solve(xs, us, int(given["iterations"]), False, 1e-6)
    np.savez(
        sys.argv[2],
        q=np.array([x[: model.nq] for x in solver.xs]),
        v=np.array([x[model.nq :] for x in solver.xs]),
        torque=np.array(list(solver.us)),
        iterations=solver.iter,
        converged=converged,
    )


def action(given: Any, k: int, state: Any, actuation: Any, frames: list[int]) -> Any:
    """What happens and what it costs at sample k."""
    nu, penalty = actuation.nu, float(given["penalty"])
    contacts = crocoddyl.ContactModelMultiple(state, nu)
    costs = crocoddyl.CostModelSum(state, nu)
    gains = np.array(GAINS) / float(given["h"]) ** np.array([2.0, 1.0])

    def add(name: str, weight: Any, residual: Any, activation: Any = None) -> None:
        parts = (residual,) if activation is None else (activation, residual)
        costs.addCost(name, crocoddyl.CostModelResidual(state, *parts), float(weight))

    for side in range(2):
        place = pin.XYZQUATToSE3(given["soles"][k, side])
        bears = given["bears"][max(k - 1, 0) : k + 1, side]
        if not bears.all():  # a sole that begins to bear has to be in its place by then
            add(f"place {side}", penalty,
                crocoddyl.ResidualModelFramePlacement(state, frames[side], place, nu))  # fmt: skip
        if not bears[-1]:
            continue
        contacts.addContact(
            f"sole {side}",
            crocoddyl.ContactModel6D(state, frames[side], place, pin.LOCAL, nu, gains),
        )
        cone = crocoddyl.WrenchCone(
            np.eye(3), float(given["friction"]), given["boxes"][side], 4, False, 0.0, 1e6
        )
        add(f"cone {side}", penalty / float(given["weight"]) ** 2,
            crocoddyl.ResidualModelContactWrenchCone(state, frames[side], cone, nu),
            crocoddyl.ActivationModelQuadraticBarrier(
                crocoddyl.ActivationBounds(cone.lb, cone.ub)))  # fmt: skip
    add("torque", given["weight_torque"], crocoddyl.ResidualModelControl(state, nu))
    joints = np.concatenate([np.zeros(6), np.ones(nu), np.zeros(state.nv)])
    x = np.concatenate([given["plan"][k], np.zeros(state.nv)])
    add("distance", given["weight_distance"], crocoddyl.ResidualModelState(state, x, nu),
        crocoddyl.ActivationModelWeightedQuad(joints))  # fmt: skip
    turn = pin.XYZQUATToSE3(given["torso"][k]).rotation
    add("upright", given["weight_upright"],
        crocoddyl.ResidualModelFrameRotation(state, frames[2], turn, nu))  # fmt: skip
    low, high = np.full((2, 2 * state.nv), np.inf)
    low[:] = -np.inf
    low[6 : 6 + nu], high[6 : 6 + nu] = given["lower"], given["upper"]
    middle = np.concatenate([pin.neutral(state.pinocchio), np.zeros(state.nv)])
    add("range", penalty, crocoddyl.ResidualModelState(state, middle, nu),
        crocoddyl.ActivationModelQuadraticBarrier(
            crocoddyl.ActivationBounds(low, high)))  # fmt: skip
    return crocoddyl.DifferentialActionModelContactFwdDynamics(
        state, actuation, contacts, costs, 0.0, True
    )


def end(given: Any, state: Any, actuation: Any) -> Any:
    """The last posture, at rest."""
    costs = crocoddyl.CostModelSum(state, actuation.nu)
    rest = np.concatenate([given["plan"][-1], np.zeros(state.nv)])
    residual = crocoddyl.ResidualModelState(state, rest, actuation.nu)
    weight = float(given["penalty"])
    costs.addCost("rest", crocoddyl.CostModelResidual(state, residual), weight)
    contacts = crocoddyl.ContactModelMultiple(state, actuation.nu)
    return crocoddyl.DifferentialActionModelContactFwdDynamics(
        state, actuation, contacts, costs, 0.0, True
    )


if __name__ == "__main__":
    main()

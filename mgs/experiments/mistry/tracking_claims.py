"""Claims of the evaluation: CoG and hand tracking, MNCS IV and V, also in physics."""

from __future__ import annotations

import numpy as np

from mgs.core.contact import Side
from mgs.experiments.claim import Claim
from mgs.experiments.mistry.measures import hand_error, horizontal_com_error
from mgs.experiments.mistry.physics import lag_and_droop
from mgs.experiments.mistry.runs import EIGHT, EQUATION_16, SWAY, VELOCITY, Key, Study
from mgs.experiments.mistry.thresholds import FASTER, MET

SAMPLE_LAG = 1.0  # [samples] least lag that counts


def tracking_claims(study: Study) -> list[Claim]:
    """Claims on figures 6 to 9, and sentences that cannot be tested."""
    return [*_cog_claims(study), *_hand_claims(study), *_untested_claims()]


def _cog_claims(study: Study) -> list[Claim]:
    plain, low = (study[Key(SWAY, VELOCITY, EQUATION_16, v)] for v in ("", "low feedback"))
    errors = [horizontal_com_error(run) for run in (plain, low)]
    motion, played = plain.motion, study.played[SWAY]
    n = len(played.com)
    lag, _ = lag_and_droop(motion.com_ref[:n, 1], played.com[:, 1], motion.dt)
    ahead = float(np.abs(played.com[:, 0] - motion.com_ref[:n, 0]).max())
    width = float(np.ptp(motion.com_ref[:, 1]))
    droop = float(np.mean((played.com - motion.com_ref[:n])[:, 2]))
    return [
        Claim(
            "cog",
            "The CoG follows a side-to-side sine while its front-back position remains fixed",
            f"{1e6 * errors[0]:.2f} um",
            errors[0] <= MET,
            "largest horizontal error of the plan, within 0.1 mm; in physics see cog_lag",
            {"error": errors[0]},
            "MNCS IV-B, Fig. 6",
            ("eq. (16)",),
        ),
        Claim(
            "cog_lag",
            "On the robot the CoG lags behind its target",
            f"{1e3 * lag:.1f} ms; front-back within {1e3 * ahead:.1f} mm, height "
            f"{1e3 * droop:.2f} mm",
            lag >= SAMPLE_LAG * motion.dt and not played.fell,
            f"MuJoCo, servos of robot.yaml without feed-forward, a sway of {1e3 * width:.0f} mm; "
            "a lag counts from one sample of 10 ms on",
            {"lag": lag, "front": ahead, "droop": droop},
            "MNCS V, Fig. 6",
            ("eq. (16)",),
        ),
        Claim(
            "cog_gains",
            "Moderate to low task-space gains contribute to the tracking lags",
            f"CoG error {1e6 * errors[0]:.2f} um with a feedback of 0.5 per sample, "
            f"{1e6 * errors[1]:.2f} um with 0.02",
            errors[1] >= FASTER * errors[0],
            "of the plan. The reference velocity is fed forward, so that low gains increase errors "
            "of the integration only; the paper closes the loop over the measured CoG",
            {"0.5": errors[0], "0.02": errors[1]},
            "MNCS V",
            ("eq. (16)",),
        ),
    ]


def _hand_claims(study: Study) -> list[Claim]:
    run, rest = (study[Key(EIGHT, VELOCITY, EQUATION_16, v)] for v in ("", "hand at rest"))
    hand, com = hand_error(run), horizontal_com_error(run)
    motion, played = run.motion, study.played[EIGHT]
    n = len(played.com)
    reference = motion.hands_ref[:n, Side.RIGHT]
    hand_played = float(np.linalg.norm(played.hand - reference, axis=1).max())
    com_played = float(np.linalg.norm((played.com - motion.com_ref[:n])[:, :2], axis=1).max())
    return [
        Claim(
            "hand",
            "The hand works in the null space of the CoG controller and is less accurate",
            f"hand {1e3 * hand:.1f} mm, CoG {1e3 * com:.1e} mm",
            hand >= FASTER * com and hand > MET,
            f"largest errors; in physics hand {1e3 * hand_played:.1f} mm, CoG "
            f"{1e3 * com_played:.1f} mm",
            {"hand": hand, "com": com, "hand played": hand_played, "com played": com_played},
            "MNCS IV-C, Fig. 7 to 9",
            ("eq. (16)",),
        ),
        Claim(
            "hand_physics",
            "On the robot the hand is less accurate than the CoG as well",
            f"hand {1e3 * hand_played:.1f} mm, CoG {1e3 * com_played:.1f} mm",
            hand_played >= FASTER * com_played and not played.fell,
            "MuJoCo, servos of robot.yaml without feed-forward",
            {"hand": hand_played, "com": com_played},
            "MNCS IV-C, Fig. 7 to 9",
            ("eq. (16)",),
        ),
        Claim(
            "arm_does_not_interfere",
            "The arm motion theoretically does not interfere with the static balance",
            f"CoG error {1e6 * com:.2f} um, with the hand at rest "
            f"{1e6 * horizontal_com_error(rest):.2f} um",
            com <= MET,
            "largest horizontal error, within 0.1 mm",
            {"moving": com, "rest": horizontal_com_error(rest)},
            "MNCS IV-C",
            ("eq. (16)",),
        ),
    ]


def _untested_claims() -> list[Claim]:
    rows = (
        (
            "robot",
            "The examples demonstrate that the approach is feasible on the humanoid robot CBi",
            "there is no robot CBi; cog_lag and hand_physics replay the motions of COMAN in a "
            "physics engine",
            "MNCS abstract, IV, VI",
        ),
        (
            "raised_gains",
            "Raising task-space gains may improve the tracking, with a higher risk of instability",
            "a conjecture on the closed loop over measured tasks; mgs plans offline and executes "
            "open loop",
            "MNCS V",
        ),
        (
            "fast_motions",
            "Model-free position control cannot cope with the momentum of faster motions",
            "a statement on control without a dynamics model; mgs plans with one (see the checks "
            "of mgs validate)",
            "MNCS V",
        ),
        (
            "force_control",
            "Force control is sensitive to inaccurate dynamics models; acceleration control with "
            "inverse dynamics performs slightly better",
            "the result of another paper, which MNCS cites",
            "MNCS I",
        ),
    )
    return [
        Claim(name, claim, "not measured", "not applicable", reason, source=source)
        for name, claim, reason, source in rows
    ]

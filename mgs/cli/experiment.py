"""The command mgs experiment."""

from __future__ import annotations

from pathlib import Path

import click

from mgs import experiments
from mgs.cli.common import ProgressBar, json_option, print_json, say, with_progress
from mgs.experiments import Claim
from mgs.experiments.sensitivity import Sensitivity, measure


@click.command()
@click.argument("name", type=click.Choice(experiments.NAMES))
@click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path),
    help="Folder for the figures. Default: outputs/experiments/NAME.",
)  # fmt: skip
@click.option("--no-figures", is_flag=True, help="Print the claims without drawing figures.")
@click.option(
    "--sensitivity", is_flag=True,
    help="Repeat the experiment with one setting changed at a time (sampling period, joint stops, "
    "masses, gains, amplitude and others), and print which claims change. Draws no figures.",
)  # fmt: skip
@click.option(
    "--gait", metavar="GAIT",
    help="Only with preview: analyse the generator of the CoM motion of this gait, a file or the "
    "name of a shipped gait: poles of its closed loop and step response.",
)  # fmt: skip
@click.option("--robot", metavar="ROBOT", help="Only with --gait: robot of a gait that names none.")
@json_option
def experiment(
    name: str,
    output: Path | None,
    no_figures: bool,
    sensitivity: bool,
    gait: str | None,
    robot: str | None,
    as_json: bool,
) -> None:
    """Repeat the experiments of a paper and test its claims.

    Prints what the paper says, the measured value of each method that the sentence names, and
    whether the claim holds, and writes figures. Statements that no paper makes are marked "ours".
    The figures of an earlier run are replaced. A claim that does not hold is a result, not an
    error: the exit code is 0.

    melson: scenarios S1 to S3 and the drift study of the article "Inverse kinematics of a humanoid
    robot modelled as a tree-shaped manipulator".

    faraji: tasks A to H with the solvers ik1 to ik5 on the legs of the robot COMAN, after S. Faraji
    and A. J. Ijspeert, "Singularity-tolerant inverse kinematics for bipedal robots", IEEE Robotics
    and Automation Letters, 2017.

    mistry: sway of the centre of gravity and a figure eight of a hand by prioritized inverse
    kinematics with a floating base, after M. Mistry, J. Nakanishi, G. Cheng and S. Schaal, "Inverse
    kinematics with floating base and constraints for full body humanoid robot control", Humanoids,
    2008.

    preview: preview control of the zero-moment point, after S. Kajita et al., "Biped walking
    pattern generation by using preview control of zero-moment point", ICRA, 2003. With --gait the
    generator of any gait is analysed by python-control instead.

    crouch: squared torques and electric power against the knee angle, for standing, swaying and
    walking and with the solvers ik1 to ik5 and clik, after figure 7 of the paper of Faraji and
    Ijspeert.

    \b
    Examples:
      mgs experiment melson -o figures
      mgs experiment melson --sensitivity
      mgs experiment preview --gait coman/walk
    """  # noqa: D301
    if (gait is not None or robot is not None) and (name != "preview" or gait is None):
        raise click.UsageError("--gait needs the experiment preview, and --robot needs --gait")
    if sensitivity:
        if gait is not None:
            raise click.UsageError("--gait and --sensitivity exclude each other; remove one")
        if output is not None:
            raise click.UsageError("--sensitivity draws no figures; remove --output")
        _print_sensitivity(name, as_json)
        return
    folder = None if no_figures else output or Path("outputs/experiments") / name
    if gait is not None:
        _design(gait, robot, folder, as_json)
        return

    def work(bar: ProgressBar) -> list[Claim]:
        return experiments.run(name, folder, bar)

    claims = with_progress(name, work)
    if as_json:
        print_json({"experiment": name, "claims": [claim.to_dict() for claim in claims]})
        return
    _print_claims(claims)
    if folder is not None:
        say(f"figures in {folder}")


def _print_sensitivity(name: str, as_json: bool) -> None:
    def work(bar: ProgressBar) -> Sensitivity:
        return measure(name, bar)

    found = with_progress(f"{name} and its variants", work)
    if as_json:
        print_json({"experiment": name, **found.to_dict()})
        return
    _print_claims(found.claims)
    say(f"variants: {', '.join(found.variants) or 'none'}")
    for variant, reason in found.refused.items():
        say(f"not run: {variant}: {reason}")


def _design(gait: str, robot: str | None, folder: Path | None, as_json: bool) -> None:
    """Analyse the generator of a gait, print the result and write a figure if there is a folder."""
    from mgs.experiments.preview.design import analyse

    found = analyse(gait, robot)
    if folder is not None:
        from mgs.experiments.preview.figures import plot_design
        from mgs.report.canvas import save_figures

        save_figures({"design": plot_design(found)}, folder, force=True)
    if as_json:
        print_json(found.to_dict())
        return
    say(
        f"{found.gait} on {found.robot}: generator {found.generator}, dt {found.dt:g} s, CoM "
        f"height {found.com_height:.4g} m"
    )
    for key, value in found.settings.items():
        say(f"  {key}: {value:g}")
    if found.gain_gap is None:
        say("poles: none, because this generator has no constant gains")
    else:
        say(f"gains: relative difference to python-control {found.gain_gap:.1e}")
    for pole, time in zip(found.poles, found.time_constants, strict=True):
        say(
            f"pole: {pole.real:.6f} {pole.imag:+.6f}i, magnitude {abs(pole):.6f}, time constant "
            f"{time:.4f} s"
        )
    say(
        f"step response of the ZMP: overshoot {100 * found.overshoot:.2f} %, undershoot "
        f"{100 * found.undershoot:.2f} %, settled within 2 % after {found.settling_time:.2f} s"
    )
    if folder is not None:
        say(f"figure in {folder / 'design.png'}")


def _print_claims(claims: list[Claim]) -> None:
    for claim in claims:
        holds = {True: "holds", False: "FAILS", "not applicable": "n/a  "}[claim.holds]
        source = "ours" if claim.kind == "ours" else claim.source
        head = f"{holds} {claim.id:14s} "
        say(f"{head}{f'[{source}] ' if source else ''}{claim.claim}: {claim.figure}")
        for line in (claim.robustness, claim.note):
            if line:
                say(f"      {line}")

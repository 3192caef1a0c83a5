"""The command mgs experiment."""

from __future__ import annotations

from pathlib import Path

import click

from mgs import experiments
from mgs.cli.common import ProgressBar, json_option, print_json, with_progress
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
@json_option
def experiment(
    name: str, output: Path | None, no_figures: bool, sensitivity: bool, as_json: bool
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

    preview: closed-loop analysis of the preview control of the zero-moment point, after S. Kajita
    et al., "Biped walking pattern generation by using preview control of zero-moment point", ICRA,
    2003.

    \b
    Example:
      mgs experiment melson -o figures
    """  # noqa: D301
    if sensitivity:
        if output is not None:
            raise click.UsageError("--sensitivity draws no figures; remove --output")
        _print_sensitivity(name, as_json)
        return
    folder = None if no_figures else output or Path("outputs/experiments") / name

    def work(bar: ProgressBar) -> list[Claim]:
        return experiments.run(name, folder, bar)

    claims = with_progress(name, work)
    if as_json:
        print_json({"experiment": name, "claims": [claim.to_dict() for claim in claims]})
        return
    _print_claims(claims)
    if folder is not None:
        click.echo(f"figures in {folder}")


def _print_sensitivity(name: str, as_json: bool) -> None:
    def work(bar: ProgressBar) -> Sensitivity:
        return measure(name, bar)

    found = with_progress(f"{name} and its variants", work)
    if as_json:
        print_json({"experiment": name, **found.to_dict()})
        return
    _print_claims(found.claims)
    click.echo(f"variants: {', '.join(found.variants) or 'none'}")
    for variant, reason in found.refused.items():
        click.echo(f"not run: {variant}: {reason}")


def _print_claims(claims: list[Claim]) -> None:
    for claim in claims:
        holds = {True: "holds", False: "FAILS", "not applicable": "n/a  "}[claim.holds]
        source = "ours" if claim.kind == "ours" else claim.source
        head = f"{holds} {claim.id:14s} "
        click.echo(f"{head}{f'[{source}] ' if source else ''}{claim.claim}: {claim.figure}")
        for line in (claim.robustness, claim.note):
            if line:
                click.echo(f"      {line}")

"""mgs experiment."""

from __future__ import annotations

from pathlib import Path

import click

from mgs import experiments
from mgs.cli.common import ProgressBar, json_option, print_json, with_progress
from mgs.experiments import Claim


@click.command()
@click.argument("name", type=click.Choice(experiments.NAMES))
@click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path),
    help="Folder for the figures; default outputs/experiments/NAME.",
)  # fmt: skip
@click.option("--no-figures", is_flag=True, help="Print the claims only.")
@json_option
def experiment(name: str, output: Path | None, no_figures: bool, as_json: bool) -> None:
    """Rerun an experiment and print claim, figure found, holds or not.

    melson: scenarios S1 to S3 and the drift study of the Melson paper. faraji: tasks A to H of
    Faraji and Ijspeert, ik1 to ik5 on COMAN's legs. mistry: CoG sway and a hand's figure eight by
    prioritised floating-base IK. preview: closed-loop analysis of the ZMP preview control. Figures
    of an earlier run are replaced. A claim that does not hold is a finding, not a failure: the exit
    code is 0 all the same.

    \b
    Example:
      mgs experiment melson -o figures
    """  # noqa: D301
    folder = None if no_figures else output or Path("outputs/experiments") / name

    def work(bar: ProgressBar) -> list[Claim]:
        return experiments.run(name, folder, bar)

    claims = with_progress(name, work)
    if as_json:
        print_json({"experiment": name, "claims": [claim.to_dict() for claim in claims]})
    else:
        for claim in claims:
            holds = {True: "holds", False: "FAILS"}.get(claim.holds, "n/a  ")
            click.echo(f"{holds} {claim.id:14s} {claim.claim}: {claim.figure}")
            if claim.note:
                click.echo(f"      {claim.note}")
        if folder is not None:
            click.echo(f"figures in {folder}")

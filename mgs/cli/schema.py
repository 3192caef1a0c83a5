"""The command mgs schema."""

from __future__ import annotations

import click

from mgs.cli.common import print_json


@click.command()
@click.argument("kind", type=click.Choice(["gait", "robot", "sweep", "motors", "unit"]))
def schema(kind: str) -> None:
    """Print the JSON schema of gait, robot, sweep, motors or unit files.

    The schema describes every key with its unit and range. Editors use it to complete keys and to
    mark errors.

    \b
    Example:
      mgs schema gait > gait.schema.json
    """  # noqa: D301
    if kind == "gait":
        from mgs.gait import gait_schema

        print_json(gait_schema(), versioned=False)
    elif kind == "motors":
        from mgs.robot.motors import MotorFile

        print_json(MotorFile.model_json_schema(), versioned=False)
    elif kind == "unit":
        from mgs.robot.unit import UnitSpec

        print_json(UnitSpec.model_json_schema(), versioned=False)
    elif kind == "sweep":
        from mgs.library.sweep import Sweep

        print_json(Sweep.model_json_schema(), versioned=False)
    else:
        from mgs.robot import RobotSpec

        print_json(RobotSpec.model_json_schema(), versioned=False)

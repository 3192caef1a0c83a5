"""MuJoCo's compiler, and what it makes of a model: defaults resolved, inertias of shapes computed.

A compiled model is read through plain arrays, one record per body, joint and shape.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mgs.core.errors import ConfigError
from mgs.core.short_text import shown
from mgs.robot.init.mjcf.sources import NOT_READ
from mgs.robot.init.mjcf.text import ModelText


def compiled(text: ModelText, path: Path) -> Any:
    """MuJoCo's `MjModel` of a text.

    Raises:
        ConfigError: MuJoCo is not installed, or refuses the model; with what it says.
    """
    try:
        import mujoco
    except ImportError as error:
        raise ConfigError(
            path, f"MuJoCo is needed to read an MJCF: {error}; pip install mujoco"
        ) from error
    former = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _: None)  # or it writes MUJOCO_LOG.TXT
    try:
        spec = mujoco.MjSpec.from_string(text.xml, assets=text.meshes)
        model = spec.compile()
    except (ValueError, TypeError, RuntimeError, mujoco.FatalError) as error:
        lost = f" ({len(text.missing)} meshes were not found)" if text.missing else ""
        said = shown(" ".join(str(error).split()), 300)
        raise ConfigError(path, f"{NOT_READ}: MuJoCo says: {said}{lost}") from error
    finally:
        mujoco.set_mju_user_warning(former)
    if problems := _weightless(spec, text):
        raise ConfigError(path, problems)
    return model


def _weightless(spec: Any, text: ModelText) -> list[str]:
    """Bodies whose mass is that of a mesh which was not found."""
    problems = []
    for body in spec.bodies:
        if body.explicitinertial and int(spec.compiler.inertiafromgeom) != 1:
            continue
        for geom in body.geoms:
            lost = text.missing.get(geom.meshname)
            if lost is not None and geom.mass != 0.0 and geom.density != 0.0:
                problems.append(
                    f"body {body.name} has no <inertial>, and its mesh {shown(lost)} was not "
                    "found, so that its mass is unknown; give the folder of the meshes with "
                    "--package-path"
                )
    return problems

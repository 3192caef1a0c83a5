"""Names of solvers and generators in a gait file, and parameters of those of other packages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import AfterValidator, ValidationInfo, WithJsonSchema

from mgs.core.config import build
from mgs.core.errors import ConfigError
from mgs.core.plugins import COM_GENERATORS, IK_SOLVERS, Registry, unknown_name

ANY_NAME: dict[str, object] = {"any_name": True}
"""Validation context of a gait that is only read: its solver need not be installed."""


def _takes_any_name(info: ValidationInfo) -> bool:
    return bool(info.context and info.context.get("any_name"))


def _known(registry: Registry) -> Callable[[str, ValidationInfo], str]:
    def refuse_unknown(name: str, info: ValidationInfo) -> str:
        if _takes_any_name(info):
            return name
        if name not in registry.own and name not in (names := registry.names()):
            raise ValueError(unknown_name(name, names))
        return name

    return refuse_unknown


def _schema(registry: Registry) -> WithJsonSchema:
    """JSON schema with which editors complete the names of mgs and accept any other name."""
    return WithJsonSchema({"anyOf": [{"enum": list(registry.own)}, {"type": "string"}]})


SolverName = Annotated[str, AfterValidator(_known(IK_SOLVERS)), _schema(IK_SOLVERS)]
GeneratorName = Annotated[str, AfterValidator(_known(COM_GENERATORS)), _schema(COM_GENERATORS)]


def own_parameters(
    registry: Registry, key: str, given: dict[str, Any], info: ValidationInfo
) -> dict[str, Any]:
    """Parameters of the solver or generator named by `key` of the same block, with defaults.

    The class behind the name, from another package, declares them as a pydantic model `Parameters`.

    Raises:
        ValueError: the class declares none, or a value is not among those it allows.
        MgsError: the package cannot be imported.
    """
    name = info.data.get(key)
    if name is None or _takes_any_name(
        info
    ):  # the name has been refused already, or the gait is only read
        return given
    declared = None if name in registry.own else getattr(registry.load(name), "Parameters", None)
    if declared is None:
        if given:
            raise ValueError(
                f"{name} has no parameters of its own here; remove {', '.join(sorted(given))}"
            )
        return {}
    if unknown := sorted(given.keys() - declared.model_fields.keys()):
        known = ", ".join(declared.model_fields)
        raise ValueError(f"{name} has no parameter {unknown[0]!r}; known: {known}")
    try:
        return dict(build(declared, given, name).model_dump())
    except ConfigError as error:
        raise ValueError("; ".join(error.problems)) from error

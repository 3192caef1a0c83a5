"""Sensitivity of the claims of an experiment: which of them change when one setting changes.

A claim is robust if `holds` is the same in the experiment and in all its variants. A variant with a
run that is refused, for example because a posture is out of reach, says nothing about the claims;
it is reported with the reason of the refusal.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from mgs.core.errors import MgsError
from mgs.core.progress import Progress
from mgs.experiments import Claim, package_of
from mgs.experiments.variant import Variant

NOT_ALONE = "{}; not run at {}"


@dataclass(frozen=True)
class Sensitivity:
    """Claims of an experiment and of its variants.

    Attributes:
        claims: claims of the experiment itself, with their robustness.
        variants: claims by id, for each variant that was run.
        refused: reason of the refusal, for each variant that was not run.
    """

    claims: list[Claim]
    variants: dict[str, dict[str, Claim]] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)

    def to_dict(self) -> dict[str, object]:
        """Convert the result to plain data: claims, variants and refused variants."""
        return {
            "claims": [claim.to_dict() for claim in self.claims],
            "variants": {
                name: {id_: {"figure": c.figure, "holds": c.holds} for id_, c in claims.items()}
                for name, claims in self.variants.items()
            },
            "refused": dict(self.refused),
        }


def measure(name: str, progress: Progress | None = None) -> Sensitivity:
    """Run an experiment and all its variants, one after the other.

    Args:
        name: name of the experiment, one of `mgs.experiments.NAMES`.
        progress: function that is called with the number of finished runs and of all runs.
    """
    package = package_of(name)
    variants: Sequence[Variant] = package.VARIANTS
    n = len(variants) + 1
    base = list(package.all_claims(package.solve(_part(progress, 0, n))))
    found: dict[str, dict[str, Claim]] = {}
    refused: dict[str, str] = {}
    for i, variant in enumerate(variants, start=1):
        try:
            study = package.solve(_part(progress, i, n), variant)
            found[variant.name] = {claim.id: claim for claim in package.all_claims(study)}
        except MgsError as error:
            refused[variant.name] = str(error)
    claims = [dataclasses.replace(c, robustness=robustness(c, found, refused)) for c in base]
    return Sensitivity(claims, found, refused)


def robustness(
    claim: Claim, variants: dict[str, dict[str, Claim]], refused: Sequence[str] | dict[str, str]
) -> str:
    """Robustness of one claim, in words.

    Args:
        claim: the claim with the settings of the experiment.
        variants: claims by id, for each variant.
        refused: names of variants that were not run.
    """
    if claim.kind == "ours":
        return "ours"
    found = {n: c[claim.id] for n, c in variants.items()}
    undefined = [n for n, c in found.items() if not all(map(math.isfinite, c.values.values()))]
    other = {n: c for n, c in found.items() if c.holds != claim.holds and n not in undefined}
    text = "robust" if len(found) > len(undefined) else "not measured"
    if other:
        verb = "holds" if claim.holds is False else "breaks"
        cases = "; ".join(f"{name} ({c.figure})" for name, c in other.items())
        text = f"fragile: {verb} at {cases}"
    if undefined:  # such as the delay of a knee that is never stretched
        text += f"; without a value at {', '.join(undefined)}"
    return NOT_ALONE.format(text, ", ".join(refused)) if refused else text


def _part(progress: Progress | None, i: int, n: int) -> Progress | None:
    """Progress of part `i` of `n` parts of equal work."""
    if progress is None:
        return None
    return lambda done, total: progress(i * total + done, n * total)

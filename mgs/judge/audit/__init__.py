"""The verdict on motions that mgs did not plan: contacts are found from the motion itself."""

from mgs.judge.audit.finding import KINDS, Finding, annotation, sentence
from mgs.judge.audit.given import GivenMotion, StatedLinks, given_by
from mgs.judge.audit.run import Audit, audit

__all__ = [
    "KINDS",
    "Audit",
    "Finding",
    "GivenMotion",
    "StatedLinks",
    "annotation",
    "audit",
    "given_by",
    "sentence",
]

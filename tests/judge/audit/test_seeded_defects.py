"""A few defects of each kind seeded in clean motions; `benchmarks/audit.py` seeds many."""

from __future__ import annotations

import numpy as np
import pytest
from clean_motions import disguise, shipped
from seeded_defects import DEFECTS

from mgs.judge.audit import KINDS, audit

GAITS = ("melson/walk_practical", "coman/walk_arc", "melson/squat", "coman/kick")
NEAR = 0.2  # [s] between a seeded defect and its finding


def test_every_kind_of_finding_is_seeded():
    assert set(DEFECTS) == set(KINDS)


@pytest.mark.parametrize("kind", DEFECTS)
def test_a_seeded_defect_is_found_as_what_it_is(kind: str):
    """On disguised motions, so that rate, heading and rounding differ from case to case."""
    rng, seen = np.random.default_rng(7), 0
    for attempt in range(40):
        seeded = DEFECTS[kind](disguise(shipped(GAITS[attempt % len(GAITS)]), rng), rng)
        if seeded is None:  # such as a clock, which a robot that stands still does not show
            continue
        motion, when = seeded
        hits = [finding for finding in audit(motion).findings if finding.kind == kind]
        assert any(
            when is None or finding.start - NEAR <= when <= finding.end + NEAR for finding in hits
        ), (attempt, when)
        assert all(finding.start <= finding.time <= finding.end for finding in hits)
        seen += 1
        if seen == 3:
            return
    pytest.fail(f"no motion could have the defect {kind}")


@pytest.mark.parametrize("name", [*GAITS, "melson/obstacle", "coman/stairs", "melson/pick_up"])
def test_a_clean_motion_has_no_finding(name: str):
    rng = np.random.default_rng(11)
    for _ in range(3):
        assert audit(disguise(shipped(name), rng)).findings == ()

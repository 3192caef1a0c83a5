"""Tests of gait files with comments: they say the same as the gait, and comments are comments."""

from __future__ import annotations

import pytest

from mgs.gait import SequenceGait, list_gaits, load_gait, parse_gait
from mgs.gait.commented import commented_yaml


@pytest.mark.parametrize("name", list_gaits())
def test_the_text_of_every_shipped_gait_is_read_back_as_the_same_gait(name: str):
    gait = load_gait(name)
    if isinstance(gait, SequenceGait):
        return
    text = commented_yaml(gait, {}, ["A heading: with a colon # and a hash."])
    assert parse_gait(text, name) == gait
    assert text.startswith("# A heading")


def test_comments_stand_behind_their_values_even_where_these_are_defaults():
    gait = load_gait("melson/walk_practical")
    assert not isinstance(gait, SequenceGait)
    comments = {"walk.arm_swing": "before: 1", "com.margin": "before: 0.01", "dt": "a period"}
    text = commented_yaml(gait, comments)
    lines = text.splitlines()
    assert "  arm_swing: 0.0  # before: 1" in lines
    assert "  margin: 0.024  # before: 0.01" in lines
    assert "dt: 0.01  # a period" in lines
    assert parse_gait(text, "text") == gait

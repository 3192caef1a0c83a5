"""The limits that the documentation states are those of the code."""

from __future__ import annotations

import re
from pathlib import Path

from mgs.core import limits

PAGE = (Path(__file__).parents[2] / "docs" / "security.md").read_text()
ROW = re.compile(r"^\| `(MAX_\w+)` \| ([\d.]+)[^|]* \|", re.M)


def test_the_documented_limits_are_those_of_the_code():
    stated = {name: float(value) for name, value in ROW.findall(PAGE)}
    assert stated == {name: getattr(limits, name) for name in vars(limits) if name.isupper()}


def test_every_limit_is_used():
    package = Path(limits.__file__).parents[1]
    code = "\n".join(path.read_text() for path in package.rglob("*.py") if path.name != "limits.py")
    for name in vars(limits):
        if name.isupper():
            assert re.search(rf"\b{name}\b", code), name

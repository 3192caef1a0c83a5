"""Trials with random numbers of their own each, so that a log of them can be continued."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

Result = dict[str, Any]


class Log:
    """Results of trials, one JSON object a line; those of an earlier run are not made again."""

    def __init__(self, path: Path | None, settings: Result) -> None:
        self.path, self.settings = path, settings
        self.known: dict[tuple[str, int], Result] = {}
        if path is not None and path.exists():
            head, *lines = [json.loads(line) for line in path.read_text().splitlines()]
            if head != settings:
                raise SystemExit(f"{path} is the log of a run with {head}, not with {settings}")
            self.known = {(line["series"], line["number"]): line for line in lines}
        elif path is not None:
            path.write_text(json.dumps(settings, allow_nan=False) + "\n")

    def trial(
        self,
        series: str,
        number: int,
        seed: list[int],
        run: Callable[[np.random.Generator], Result],
    ) -> Result:
        """Result of one trial, from the log or from running it."""
        if (series, number) not in self.known:
            result = {"series": series, "number": number, **run(np.random.default_rng(seed))}
            self.known[series, number] = result
            if self.path is not None:
                with self.path.open("a") as file:
                    file.write(json.dumps(result, allow_nan=False) + "\n")
        return self.known[series, number]

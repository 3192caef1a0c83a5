"""The wish to stop: a key on the terminal, Ctrl-C, or a signal from another program."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

SIGNALS = {signal.SIGINT: "Ctrl-C", signal.SIGTERM: "signal SIGTERM"}


@contextlib.contextmanager
def stop_wish() -> Iterator[Callable[[], str | None]]:
    """A function that gives the reason to stop, or None, and never waits.

    Any key of the terminal is a reason, if there is a terminal; Ctrl-C and SIGTERM always are.
    While this lasts they end nothing by themselves, so that servos are told to stop first.
    """
    reasons: list[str] = []

    def note(number: int, frame: FrameType | None) -> None:
        del frame
        reasons.append(SIGNALS[signal.Signals(number)])

    before: dict[signal.Signals, Any] = {s: signal.signal(s, note) for s in SIGNALS}
    try:
        with _single_keys() as pressed:
            yield lambda: reasons[0] if reasons else ("a key was pressed" if pressed() else None)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextlib.contextmanager
def _single_keys() -> Iterator[Callable[[], bool]]:
    """Whether a key was pressed; the terminal gives keys at once and does not show them."""
    try:
        import termios
        import tty
    except ImportError:  # Windows: Ctrl-C alone
        yield lambda: False
        return
    if not sys.stdin.isatty():
        yield lambda: False
        return
    terminal = sys.stdin.fileno()
    before = termios.tcgetattr(terminal)

    def pressed() -> bool:
        ready, _, _ = select.select([terminal], [], [], 0.0)
        return bool(ready) and bool(os.read(terminal, 1))

    try:
        tty.setcbreak(terminal)
        termios.tcflush(terminal, termios.TCIFLUSH)
        yield pressed
    finally:
        termios.tcsetattr(terminal, termios.TCSADRAIN, before)

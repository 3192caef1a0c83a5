"""Ctrl-C at moments that leave everything whole."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType


@contextlib.contextmanager
def deferred_interrupt() -> Iterator[Callable[[], None]]:
    """Defer Ctrl-C to the calls of the function that the context gives.

    An interrupt inside Dask would leave its connections in an undefined state. A second Ctrl-C
    interrupts at once. Threads other than the main thread receive no interrupts anyway.
    """
    pressed = threading.Event()
    before = signal.getsignal(signal.SIGINT)
    in_charge = threading.current_thread() is threading.main_thread() and callable(before)

    def handle(signum: int, frame: FrameType | None) -> None:
        pressed.set()
        signal.signal(signal.SIGINT, before)

    def raise_if_pressed() -> None:
        if pressed.is_set():
            raise KeyboardInterrupt

    if in_charge:
        signal.signal(signal.SIGINT, handle)
    try:
        yield raise_if_pressed
    finally:
        if in_charge:
            signal.signal(signal.SIGINT, before)

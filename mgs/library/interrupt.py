"""Ctrl-C, and what is treated like it, at moments that leave everything whole."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextlib.contextmanager
def interrupts_told_as_such() -> Iterator[None]:
    """Raise KeyboardInterrupt for what fails because of one, such as an assertion inside Dask."""
    try:
        yield
    except Exception as error:
        earlier: BaseException | None = error
        while earlier is not None:
            earlier = earlier.__cause__ or earlier.__context__
            if isinstance(earlier, KeyboardInterrupt):
                raise KeyboardInterrupt from error
        raise


@contextlib.contextmanager
def deferred_interrupt() -> Iterator[Callable[[], None]]:
    """Defer Ctrl-C to the calls of the function that the context gives.

    An interrupt inside Dask would leave its connections in an undefined state. A second Ctrl-C
    interrupts at once. Threads other than the main thread receive no interrupts anyway.
    """
    pressed = threading.Event()
    before = {number: signal.getsignal(number) for number in SIGNALS}
    before = {number: handler for number, handler in before.items() if callable(handler)}
    in_charge = threading.current_thread() is threading.main_thread()

    def handle(signum: int, frame: FrameType | None) -> None:
        pressed.set()
        give_back()

    def give_back() -> None:
        for number, handler in before.items():
            signal.signal(number, handler)

    def raise_if_pressed() -> None:
        if pressed.is_set():
            raise KeyboardInterrupt

    if in_charge:
        for number in before:
            signal.signal(number, handle)
    try:
        yield raise_if_pressed
    finally:
        if in_charge:
            give_back()

"""A serial port for dynamixel-sdk whose time limits fit the adapter that is there."""

from __future__ import annotations

import time
from typing import Any

from mgs.core.errors import ConfigError, HardwareError
from mgs.core.foreign import described

BAUDS = (
    9600, 57600, 115200, 230400, 460800, 500000, 576000, 921600,
    1000000, 2000000, 3000000, 4000000,
)  # fmt: skip
PAUSE = 1e-4  # [s] between two looks at a port without data; the SDK alone would spin
FIRST_WAIT = 0.05  # [s] for an answer beyond its time on the wire, before one was measured


def sdk() -> Any:
    """The module dynamixel_sdk.

    Raises:
        ConfigError: it is not installed.
    """
    try:
        import dynamixel_sdk
    except ImportError as error:
        raise ConfigError(
            "--port",
            'needs the package dynamixel-sdk: pip install "mgs[dynamixel]"; --dry-run works '
            "without it",
        ) from error
    return dynamixel_sdk


def open_port(name: str, baud: int) -> Any:
    """An open port, as the packet handlers of the SDK use it.

    Its attribute `wait` is how long an answer may take beyond its time on the wire [s]. The SDK
    itself waits 34 ms for each answer that does not come, more than three periods at 100 Hz.

    Args:
        name: device, such as /dev/ttyUSB0 or COM3.
        baud: bits per second, one of `BAUDS`.

    Raises:
        ConfigError: the SDK is missing, the device is not there or cannot be used.
    """
    handler: Any = sdk().PortHandler

    class Port(handler):  # type: ignore[misc]
        wait = FIRST_WAIT

        def setPacketTimeout(self, packet_length: int) -> None:
            self.setPacketTimeoutMillis(self.tx_time_per_byte * packet_length + 1e3 * self.wait)

        def getCurrentTime(self) -> float:
            return 1e3 * time.monotonic()  # [ms]; the SDK's own clock may be set back

        def readPort(self, length: int) -> Any:
            data = super().readPort(length)
            if data:
                return data
            time.sleep(PAUSE)  # on a busy computer longer, and the answer is there meanwhile
            return super().readPort(length)

    if baud not in BAUDS:
        allowed = ", ".join(map(str, BAUDS))
        raise ConfigError("--baud", f"{baud} is no speed of Dynamixel servos; use one of {allowed}")
    port = Port(name)
    try:
        is_open = port.setBaudRate(baud)
    except Exception as error:  # pyserial: OSError, ValueError, termios.error
        raise ConfigError(
            "--port",
            f"{name}: cannot be opened: {described(error)}; check the cable, the name (Linux: "
            "ls /dev/serial/by-id) and the rights (Linux: group dialout)",
        ) from error
    if not is_open:
        raise HardwareError(f"{name}: the port refuses {baud} bit/s; choose another --baud")
    return port

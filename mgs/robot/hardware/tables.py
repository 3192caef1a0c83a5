"""Control tables of Dynamixel servos: where a register is, and what its value means.

Facts from the manuals of the maker (emanual.robotis.com): protocol 1.0 (AX, RX, EX and the older
firmware of MX) and protocol 2.0 (X, the newer firmware of MX, XL-320). Registers are little-endian.
"""

from __future__ import annotations

from dataclasses import dataclass

from mgs.core.errors import ConfigError


@dataclass(frozen=True)
class Register:
    """A value in a control table."""

    address: int
    size: int  # [bytes]
    signed: bool = False

    def value(self, data: list[int], start: int) -> int:
        """Value in the bytes of a block that begins at address `start`."""
        first = self.address - start
        return int.from_bytes(bytes(data[first : first + self.size]), "little", signed=self.signed)


@dataclass(frozen=True)
class ControlTable:
    """Registers of one series of servos."""

    name: str
    protocol: int  # 1 or 2
    return_delay: Register  # [2 us]
    lower: Register  # smallest goal [ticks]
    upper: Register  # largest goal [ticks]
    torque_enable: Register
    goal: Register  # [ticks]
    speed_limit: Register  # 0: none
    position: Register  # present [ticks]
    load: Register  # present, see `load_value`
    load_unit: str
    voltage: Register  # present [0.1 V]
    temperature: Register  # present [deg C]
    mode: Register | None = None  # operating mode; None: limits that are both 0 mean a wheel
    position_modes: tuple[int, ...] = ()  # operating modes in which a servo follows a goal position
    error: Register | None = None  # hardware error status; None: it is in every answer

    @property
    def state(self) -> tuple[int, int]:
        """First address and length of the block with present position and load."""
        first = min(self.position.address, self.load.address)
        last = max(r.address + r.size for r in (self.position, self.load))
        return first, last - first

    def load_value(self, raw: int) -> int:
        """Signed load of a register value: bit 10 is the direction where it is not signed."""
        if self.load.signed:
            return raw
        size = raw & 0x3FF
        return -size if raw & 0x400 else size


_FIRST = ControlTable(
    name="1.0",
    protocol=1,
    return_delay=Register(5, 1),
    lower=Register(6, 2),
    upper=Register(8, 2),
    torque_enable=Register(24, 1),
    goal=Register(30, 2),
    speed_limit=Register(32, 2),
    position=Register(36, 2),
    load=Register(40, 2),
    load_unit="1/1023 of the largest torque",
    voltage=Register(42, 1),
    temperature=Register(43, 1),
)
_X = ControlTable(
    name="2.0",
    protocol=2,
    return_delay=Register(9, 1),
    lower=Register(52, 4),
    upper=Register(48, 4),
    torque_enable=Register(64, 1),
    goal=Register(116, 4, signed=True),
    speed_limit=Register(112, 4),
    position=Register(132, 4, signed=True),
    load=Register(126, 2, signed=True),
    load_unit="0.1 % of the largest torque or, of servos that measure their current, 1 to 3.36 mA",
    voltage=Register(144, 2),
    temperature=Register(146, 1),
    mode=Register(11, 1),
    position_modes=(3, 4, 5),
    error=Register(70, 1),
)
_XL320 = ControlTable(
    name="XL-320",
    protocol=2,
    return_delay=Register(5, 1),
    lower=Register(6, 2),
    upper=Register(8, 2),
    torque_enable=Register(24, 1),
    goal=Register(30, 2),
    speed_limit=Register(32, 2),
    position=Register(37, 2),
    load=Register(41, 2),
    load_unit="1/1023 of the largest torque",
    voltage=Register(45, 1),
    temperature=Register(46, 1),
    mode=Register(11, 1),
    position_modes=(2,),
    error=Register(50, 1),
)
XL320_MODEL = 350  # model number

# Bits of the error byte of protocol 1.0, and of the hardware error status of protocol 2.0.
FIRST_ERRORS = {
    0: "input voltage out of range",
    1: "goal outside the angle limits",
    2: "overheating",
    3: "value out of range",
    4: "checksum of an instruction",
    5: "overload",
    6: "unknown instruction",
}
FIRST_OF_PACKETS = 0b1011000  # bits that speak of one packet, not of the servo
SECOND_ERRORS = {
    0: "input voltage out of range",
    1: "motor position sensor",
    2: "overheating",
    3: "motor encoder",
    4: "electrical shock or too little power",
    5: "overload",
}
ALERT = 0x80  # bit of the error byte of protocol 2.0: the hardware error status is not 0


def table_of(protocol: int, model: int) -> ControlTable:
    """Control table of a servo.

    Args:
        protocol: 1 or 2.
        model: number of the model, as the servo answers.

    Raises:
        ConfigError: the protocol is unknown.
    """
    if protocol not in (1, 2):
        raise ConfigError("--protocol", f"{protocol} is unknown; use 1 or 2")
    if protocol == 1:
        return _FIRST
    return _XL320 if model == XL320_MODEL else _X


def error_words(protocol: int, value: int) -> str:
    """Words for the errors of a servo; empty if it reports none."""
    bits = FIRST_ERRORS if protocol == 1 else SECOND_ERRORS
    value &= ~FIRST_OF_PACKETS if protocol == 1 else 0x7F
    return ", ".join(bits.get(bit, f"error bit {bit}") for bit in range(7) if value & (1 << bit))

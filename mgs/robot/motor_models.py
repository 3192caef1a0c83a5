"""Position servos on a bus: how an angle is written into the register of the goal position.

Facts of the control tables of the makers (ROBOTIS e-manual; Feetech memory tables of the series
STS, SMS and SCS): ticks in a whole turn, the tick in the middle, the range, and the register.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Maker = Literal["dynamixel", "feetech"]


@dataclass(frozen=True)
class Register:
    """Where a goal position goes: protocol of the bus, address and width."""

    maker: Maker
    protocol: int  # of Dynamixel: 1 or 2; of Feetech: 1, whose packets have the same form
    address: int
    width: int  # [bytes]
    big_endian: bool = False


@dataclass(frozen=True)
class MotorModel:
    """Scale of the position of a servo, and its register."""

    ticks_per_turn: float
    centre: int  # tick of the middle of the range
    lowest: int
    highest: int
    register: Register


_DXL_1 = Register("dynamixel", 1, 30, 2)
_XL_320 = Register("dynamixel", 2, 30, 2)
_DXL_2 = Register("dynamixel", 2, 116, 4)
_STS = Register("feetech", 1, 42, 2)
_SCS = Register("feetech", 1, 42, 2, big_endian=True)


def _ten_bit(register: Register) -> MotorModel:
    """Scale of a potentiometer: 1024 ticks over 300 deg."""
    return MotorModel(1024 * 360 / 300, 512, 0, 1023, register)


def _twelve_bit(register: Register) -> MotorModel:
    """Scale of an encoder: 4096 ticks over a whole turn."""
    return MotorModel(4096, 2048, 0, 4095, register)


MotorName = Literal[
    "AX-12", "AX-18", "RX-24F", "RX-28", "RX-64", "XL-320", "MX-12W", "MX-28", "MX-64", "MX-106",
    "MX-28-2.0", "MX-64-2.0", "MX-106-2.0", "XL330", "XC330", "XL430", "XC430", "XM430", "XH430",
    "XM540", "XH540", "XW540", "STS3215", "STS3250", "SM8512BL", "SCS0009",
]  # fmt: skip

MODELS: dict[str, MotorModel] = {
    **dict.fromkeys(["AX-12", "AX-18", "RX-24F", "RX-28", "RX-64"], _ten_bit(_DXL_1)),
    "XL-320": _ten_bit(_XL_320),
    **dict.fromkeys(["MX-12W", "MX-28", "MX-64", "MX-106"], _twelve_bit(_DXL_1)),
    **dict.fromkeys(["MX-28-2.0", "MX-64-2.0", "MX-106-2.0"], _twelve_bit(_DXL_2)),
    **dict.fromkeys(["XL330", "XC330", "XL430", "XC430", "XM430", "XH430"], _twelve_bit(_DXL_2)),
    **dict.fromkeys(["XM540", "XH540", "XW540"], _twelve_bit(_DXL_2)),
    **dict.fromkeys(["STS3215", "STS3250", "SM8512BL"], _twelve_bit(_STS)),
    "SCS0009": _ten_bit(_SCS),
}

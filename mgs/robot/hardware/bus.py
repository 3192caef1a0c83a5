"""A line of Dynamixel servos: single registers, states of some servos, goals of all at once.

Packets may be lost or damaged at any time. A method that needs an answer asks again `TRIES` times;
`states` asks once, since its caller comes back in the next period. Goals go out by Sync Write,
which servos do not answer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from mgs.core.errors import HardwareError
from mgs.core.foreign import described
from mgs.robot.hardware.port import FIRST_WAIT, open_port, sdk
from mgs.robot.hardware.tables import ALERT, ControlTable, Register, error_words

TRIES = 8  # of a question that needs an answer
MOST_BYTES = 200  # of the data of one Sync Write; the SDK refuses packets beyond 250 bytes


@dataclass(frozen=True)
class ServoState:
    """What a servo has answered."""

    position: int  # [ticks]
    load: int  # unit: `ControlTable.load_unit`
    has_error: bool  # whether it reports an error of its hardware
    error: int  # protocol 1.0: the error byte


class Bus:
    """An open line of servos of one series; closes with `with`."""

    def __init__(self, port_name: str, baud: int, protocol: int) -> None:
        """Open the port.

        Raises:
            ConfigError: the SDK is missing or the port cannot be used.
        """
        self.protocol = protocol
        self.port_name = port_name
        self._success = sdk().COMM_SUCCESS
        self._handler = sdk().PacketHandler(float(protocol))
        self._port = open_port(port_name, baud)
        self.wait = FIRST_WAIT  # for an answer of `state` and `states` beyond its time [s]

    def __enter__(self) -> Bus:
        return self

    def __exit__(self, *_: object) -> None:
        self._port.closePort()

    def model(self, servo: int) -> int:
        """Number of the model of a servo.

        Raises:
            HardwareError: it does not answer.
        """
        self._port.wait = FIRST_WAIT
        for _ in range(TRIES):
            found = self._tried(lambda: self._handler.ping(self._port, servo))
            if found is not None and found[1] == self._success:
                return int(found[0])
        raise HardwareError(
            f"{self.port_name}: servo {servo} does not answer; check power, cable, id, --baud and "
            f"--protocol (now {self.protocol}.0)"
        )

    def read(self, servo: int, register: Register) -> int:
        """Value of a register.

        Raises:
            HardwareError: the servo does not answer.
        """
        self._port.wait = FIRST_WAIT
        for _ in range(TRIES):
            data = self._block(servo, register.address, register.size)
            if data is not None:
                return register.value(data[0], register.address)
        raise HardwareError(
            f"{self.port_name}: servo {servo} answers a ping but not when a register is read; its "
            "Status Return Level has to be 1 or 2"
        )

    def state(self, servo: int, table: ControlTable) -> ServoState | None:
        """Position and load of a servo; None: no answer, or a damaged one."""
        first, length = table.state
        self._port.wait = self.wait
        found = self._block(servo, first, length)
        return None if found is None else self._state(*found, table)

    def states(self, servos: Sequence[int], table: ControlTable) -> dict[int, ServoState]:
        """Positions and loads of those servos that answer; protocol 2.0: by one Sync Read."""
        if table.protocol == 1 or len(servos) == 1:
            each = {servo: self.state(servo, table) for servo in servos}
            return {servo: state for servo, state in each.items() if state is not None}
        first, length = table.state
        self._port.wait = self.wait
        sent = self._tried(
            lambda: self._handler.syncReadTx(
                self._port, first, length, list(servos), len(servos), False
            )
        )
        found: dict[int, ServoState] = {}
        if sent != self._success:
            return found
        for _ in servos:
            answer = self._tried(lambda: self._handler.rxPacket(self._port, False))
            if answer is None or answer[1] != self._success:
                if self._port.packet_timeout == 0:  # the SDK sets it when time is over
                    break
                continue
            packet = answer[0]
            servo, data = packet[4], packet[9 : 9 + length]
            if servo in servos and len(data) == length:
                found[servo] = self._state(data, packet[8], table)
        return found

    def write_all(self, register: Register, values: dict[int, int]) -> None:
        """Write a register of several servos by Sync Write, which nobody confirms.

        Raises:
            HardwareError: the port does not take the packet.
        """
        most = MOST_BYTES // (1 + register.size)
        servos = list(values)
        for first in range(0, len(servos), most):
            data: list[int] = []
            for servo in servos[first : first + most]:
                value = values[servo].to_bytes(register.size, "little", signed=register.signed)
                data += [servo, *value]
            try:
                result = self._handler.syncWriteTxOnly(
                    self._port, register.address, register.size, data, len(data)
                )
            except Exception as error:  # a cable that was pulled
                raise HardwareError(f"{self.port_name}: {described(error)}") from error
            if result != self._success:
                raise HardwareError(f"{self.port_name}: {self._handler.getTxRxResult(result)}")

    def write_surely(self, register: Register, values: dict[int, int]) -> None:
        """Write a register of several servos, and again until all read back as they should.

        Raises:
            HardwareError: a servo does not take its value.
        """
        left = dict(values)
        for _ in range(TRIES):
            self.write_all(register, left)
            left = {s: value for s, value in left.items() if self.read(s, register) != value}
            if not left:
                return
        raise HardwareError(
            f"{self.port_name}: servo {next(iter(left))} does not take the value "
            f"{next(iter(left.values()))} at address {register.address}"
        )

    def error_of(self, servo: int, table: ControlTable, state: ServoState) -> str:
        """Words for the error that a state reports."""
        value = state.error
        if table.error is not None:
            for _ in range(TRIES):  # a late answer to an older question may be taken for this one
                value = self.read(servo, table.error)
                if value:
                    break
        return error_words(table.protocol, value) or "an error that it does not name"

    def _block(self, servo: int, address: int, length: int) -> tuple[list[int], int] | None:
        """Bytes of the control table and the error byte that came with them."""
        answer = self._tried(lambda: self._handler.readTxRx(self._port, servo, address, length))
        if answer is None or answer[1] != self._success or len(answer[0]) != length:
            return None
        return list(answer[0]), int(answer[2])

    def _state(self, data: list[int], error: int, table: ControlTable) -> ServoState:
        start = table.state[0]
        if table.error is None:
            has_error = bool(error_words(table.protocol, error))
        else:
            has_error = bool(error & ALERT)
        return ServoState(
            position=table.position.value(data, start),
            load=table.load_value(table.load.value(data, start)),
            has_error=has_error,
            error=error,
        )

    def _tried(self, ask: Callable[[], Any]) -> Any:
        """What the SDK answers; None: it cannot make sense of a damaged packet.

        Raises:
            HardwareError: the port is gone.
        """
        try:
            return ask()
        except (IndexError, TypeError, ValueError):  # a damaged length or number of parameters
            self._port.is_using = False
            return None
        except Exception as error:  # a cable that was pulled: OSError, or termios.error of POSIX
            raise HardwareError(f"{self.port_name}: {described(error)}") from error

"""The packets of the simulated bus are those of the maker's manuals."""

from __future__ import annotations

import pytest

from tests.support import dynamixel_packets as wire

# Examples of the manuals of protocol 1.0 and 2.0: id, instruction, parameters, bytes on the line.
EXAMPLES = [
    (1, 1, wire.PING, "", "FF FF 01 02 01 FB"),
    (1, 1, wire.READ, "2B 01", "FF FF 01 04 02 2B 01 CC"),
    (2, 1, wire.PING, "", "FF FF FD 00 01 03 00 01 19 4E"),
    (2, 1, wire.READ, "84 00 04 00", "FF FF FD 00 01 07 00 02 84 00 04 00 1D 15"),
    (2, 1, wire.WRITE, "74 00 00 02 00 00", "FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89"),
    (2, 1, wire.STATUS, "00 06 04 26", "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D"),
    (
        2,
        wire.BROADCAST,
        wire.SYNC_WRITE,
        "74 00 04 00 01 96 00 00 00 02 AA 00 00 00",
        "FF FF FD 00 FE 11 00 83 74 00 04 00 01 96 00 00 00 02 AA 00 00 00 82 87",
    ),
    (
        2,
        wire.BROADCAST,
        wire.SYNC_READ,
        "84 00 04 00 01 02",
        "FF FF FD 00 FE 09 00 82 84 00 04 00 01 02 CE FA",
    ),
]


@pytest.mark.parametrize(("protocol", "servo", "instruction", "parameters", "line"), EXAMPLES)
def test_packets_are_those_of_the_manual(protocol, servo, instruction, parameters, line):
    packet = wire.encode(protocol, servo, instruction, bytes.fromhex(parameters))
    assert packet.hex(" ").upper() == line
    parser = wire.Parser(protocol)
    assert parser.feed(b"\x12" + packet[:5]) == []
    expected = wire.Packet(servo, instruction, bytes.fromhex(parameters))
    assert parser.feed(packet[5:]) == [expected]


def test_a_header_inside_a_packet_is_stuffed():
    content = bytes.fromhex("74 00 04 00 01 FF FF FD 00")
    packet = wire.encode(2, wire.BROADCAST, wire.SYNC_WRITE, content)
    assert packet[7:-2] == bytes.fromhex("83 74 00 04 00 01 FF FF FD FD 00")
    assert wire.Parser(2).feed(packet)[0].parameters == content


@pytest.mark.parametrize("protocol", [1, 2])
def test_a_packet_with_a_wrong_bit_is_dropped_and_the_next_one_is_found(protocol):
    packet = wire.encode(protocol, 1, wire.READ, bytes([36, 0, 2, 0]))
    for at in range(len(packet)):
        for bit in range(8):
            broken = packet[:at] + bytes([packet[at] ^ (1 << bit)]) + packet[at + 1 :]
            parser = wire.Parser(protocol)
            assert parser.feed(broken) == []

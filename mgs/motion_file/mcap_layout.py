"""Binary layouts of the MCAP records that are read and written as arrays (mcap.dev/spec).

any record    opcode:1 length:8 content
Message       05 length:8  channel:2 sequence:4 log_time:8 publish_time:8 data
MessageIndex  07 length:8  channel:2 size:4 (log_time:8 offset:8)*
Chunk         06 length:8  start:8 end:8 size:8 crc:4 len("zstd"):4 "zstd" size:8 data
DataEnd       0f length:8  crc:4
Footer        02 length:8  summary_start:8 summary_offset_start:8 crc:4
"""

from __future__ import annotations

import struct
import zlib
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

Times = NDArray[np.uint64]

MAGIC = b"\x89MCAP0\r\n"
BLOCK = 1 << 20  # [bytes] read at a time
RECORD_HEAD = struct.Struct("<BQ")  # opcode, length of the content
CHUNK_HEAD = struct.Struct("<BQQQQII4sQ")
INDEX_HEAD = struct.Struct("<BQHI")
DATA_END = struct.Struct("<BQI")
FOOTER = struct.Struct("<BQQQI")
MESSAGE_HEAD = struct.Struct("<BQHIQQ")
MESSAGE = np.dtype(  # the same head in arrays
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
)
HEAD = MESSAGE.itemsize  # length of a message's record before its data [bytes]


def crc_of(stream: BinaryIO, start: int, end: int) -> int:
    """CRC-32 of a stream's bytes from start to end; leaves the stream at the end."""
    crc = 0
    stream.seek(start)
    for at in range(start, end, BLOCK):
        crc = zlib.crc32(stream.read(min(BLOCK, end - at)), crc)
    return crc

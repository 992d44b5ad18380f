"""The index at the end of a bag: its connections, and chunk infos with each connection's number of messages."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import numpy as np
from rosbags.rosbag1.reader import Header, RecordType, normalize, read_bytes, read_uint32

from thbridge.files.errors import BadFile
from thbridge.recording.bag.damage import MAGIC, VERSION, unfinished
from thbridge.recording.bag.reading.chunk_reader import ChunkInfo
from thbridge.recording.bag.records import BagConnection

STEP = 64
"""Reading the end of a bag pauses after this number of chunk infos. Reading them takes some milliseconds."""


@dataclass(slots=True)
class FileEnd:
    """The connections of one file, and the chunks that have messages, both in the file's order."""

    connections: list[BagConnection] = field(default_factory=list)
    chunks: list[ChunkInfo] = field(default_factory=list)

    @property
    def start_ns(self) -> int | None:
        """Stamp of the first message; None if there are no messages."""
        return min((chunk.start_ns for chunk in self.chunks), default=None)

    @property
    def end_ns(self) -> int | None:
        """Stamp of the last message; None if there are no messages."""
        return max((chunk.end_ns for chunk in self.chunks), default=None)


def read_end(file: BinaryIO, number: int, part: Path, end: FileEnd) -> Iterator[float]:
    """Read the end of a file in steps of some milliseconds; after each step yield the share of work done.

    Args:
        file: the file.
        number: number of the file among the recording's parts.
        part: path of the file.
        end: object that receives the result.

    Raises:
        BadFile: the bag is encrypted, or has no index.
        ReaderError: the bag is damaged; see `damage_as_bad_file`.
    """
    file.seek(len(MAGIC) + len(VERSION))
    head = Header.read(file, RecordType.BAGHEADER)
    position, count = head.get_uint64("index_pos"), head.get_uint32("chunk_count")
    if head.get("encryptor"):
        raise BadFile(part, "the bag is encrypted", "decrypt it with the program that encrypted it")
    if position == 0:
        raise unfinished(part)
    file.seek(position)
    for _ in range(head.get_uint32("conn_count")):
        end.connections.append(_connection(file))
    for index in range(count):
        info = Header.read(file, RecordType.CHUNK_INFO)
        table = np.frombuffer(read_bytes(file, read_uint32(file)), dtype="<u4").reshape(-1, 2)
        counts = {publisher: messages for publisher, messages in table.tolist() if messages}
        if counts:
            times = info.get_time("start_time"), info.get_time("end_time")
            end.chunks.append(ChunkInfo(number, info.get_uint64("chunk_pos"), *times, counts))
        if index % STEP == STEP - 1:
            yield index / count


def _connection(file: BinaryIO) -> BagConnection:
    outer = Header.read(file, RecordType.CONNECTION)
    inner = Header.read(file)  # The data of this record have the format of a header.
    return BagConnection(
        outer.get_uint32("conn"),
        normalize(outer.get_string("topic")),
        inner.get_string("type"),
        inner.get_string("md5sum") if "md5sum" in inner else "",
        inner.get_string("message_definition") if "message_definition" in inner else "",
        inner.get_string("callerid") if "callerid" in inner else None,
        inner["latching"] == b"1" if "latching" in inner else None,
    )

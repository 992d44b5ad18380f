"""Repair of a bag: writes all messages that can be read into a new one, with an index."""

import contextlib
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.synced import sync_folder
from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reading.scan import ChunkRecord, ConnectionRecord, MessageRecord, UnreadableSpan, scan
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.writing.bag_file import BagFile
from thbridge.recording.recordings import ACTIVE


@dataclass(frozen=True, slots=True)
class RepairResult:
    """The result of a repair.

    Attributes:
        path: the repaired bag.
        backup: the bag as it was.
        messages: number of messages recovered.
        end_ns: stamp of the last of them; None when there are none.
        lost_bytes: number of bytes that could not be read.
    """

    path: Path
    backup: Path
    messages: int
    end_ns: int | None
    lost_bytes: int


def reindex(path: Path) -> RepairResult:
    """Write a bag's readable messages into a new bag of the same name, and keep the old one beside it.

    `NAME.bag` and `NAME.bag.active` give `NAME.bag`, and the old file becomes `NAME.orig.bag`. Every complete message
    is recovered: those of a chunk that is cut off, too, and those behind a chunk that cannot be unpacked. The old file
    stays until the new one is complete.

    Raises:
        BadFile: it is not a ROS 1 bag, a file is in the way, or the disk is full.
    """
    compression = compression_of(path)
    repaired = path.with_name(path.name.removesuffix(ACTIVE))
    backup = repaired.with_name(f"{repaired.stem}.orig{repaired.suffix}")
    fresh = repaired.with_name(repaired.name + ".reindexing")
    for taken in {backup, repaired} - {path}:
        if taken.exists():
            raise BadFile(taken, "this file is in the way of the repair", "move it elsewhere first")
    try:
        fresh.unlink(missing_ok=True)
        messages, end_ns, lost = _copy(path, fresh, compression)
        # BagFile has synced the bytes. At a power cut there is always a file to go on with.
        if repaired == path:
            with contextlib.suppress(OSError):  # Some file systems have no second names.
                backup.hardlink_to(path)
                sync_folder(path.parent)
            if not backup.exists():
                path.replace(backup)
            fresh.replace(repaired)
        else:
            fresh.replace(repaired)
            sync_folder(path.parent)
            path.replace(backup)
        sync_folder(path.parent)
    except OSError as error:
        fresh.unlink(missing_ok=True)
        reason = (error.strerror or str(error)).lower()
        raise BadFile(path, f"it cannot be repaired here: {reason}", "make room beside it") from error
    return RepairResult(repaired, backup, messages, end_ns, lost)


def compression_of(path: Path) -> Compression:
    """The compression of a file's first chunk, where it is one that we write; else none."""
    name = next((record.compression for record in scan(path) if isinstance(record, ChunkRecord)), Compression.NONE)
    return Compression(name) if name in set(Compression) else Compression.NONE


def _copy(path: Path, fresh: Path, compression: Compression) -> tuple[int, int | None, int]:
    """Copy the messages. Return their number, the last stamp, and the number of lost bytes."""
    count, end_ns, lost = 0, None, 0
    connections: dict[int, BagConnection] = {}
    looked_everywhere = False
    target = BagFile(fresh, compression)
    for record in scan(path):
        match record:
            case ConnectionRecord(number):
                connections.setdefault(number, _connection(record))
            case MessageRecord(number, stamp_ns, data):
                if number not in connections and not looked_everywhere:
                    # The chunk with its connection cannot be read; a later chunk or the index may have it again.
                    connections = _all_connections(path) | connections
                    looked_everywhere = True
                if number in connections:
                    target.write(connections[number], stamp_ns, data)
                    count += 1
                    end_ns = stamp_ns if end_ns is None else max(end_ns, stamp_ns)
                else:
                    lost += len(data)
            case UnreadableSpan():
                lost += record.lost
    target.close()
    return count, end_ns, lost


def _all_connections(path: Path) -> dict[int, BagConnection]:
    return {record.number: _connection(record) for record in scan(path) if isinstance(record, ConnectionRecord)}


def _connection(record: ConnectionRecord) -> BagConnection:
    return BagConnection(
        record.number,
        record.topic,
        record.msgtype,
        record.md5,
        record.definition,
        record.caller,
        record.latched if record.latching is not None else None,
    )

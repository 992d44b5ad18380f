"""Repair of a recording: all readable messages are written to a new file with an index."""

import contextlib
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from thbridge.files.disk.synced import sync_folder
from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import MCAP_COMPRESSIONS, ROS1_COMPRESSIONS, Compression
from thbridge.recording.bag.reading.mcap_scan import scan_mcap
from thbridge.recording.bag.reading.scan import (
    BagRecord,
    ChunkRecord,
    ConnectionRecord,
    MessageRecord,
    UnreadableSpan,
    scan,
)
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.rosbag2_metadata import write_metadata
from thbridge.recording.bag.writing.bag_file import BagFile
from thbridge.recording.bag.writing.formats import MCAP_FILE
from thbridge.recording.recordings import ACTIVE, MCAP, METADATA, files_in, part_of
from thbridge.ros.messages.identification import by_name, identified, known_definition, missing_types
from thbridge.ros.messages.types import md5_of

MOST_SPANS = 1000
"""Maximum number of damaged places that are reported separately."""


@dataclass(frozen=True, slots=True)
class RepairResult:
    """The result of a repair.

    Attributes:
        path: the repaired bag.
        backup: the original bag.
        messages: number of recovered messages.
        end_ns: stamp of the last recovered message; None if there are none.
        lost_bytes: number of bytes that could not be read.
        losses: sentences about these bytes, in the order of the file.
    """

    path: Path
    backup: Path
    messages: int
    end_ns: int | None
    lost_bytes: int
    losses: tuple[str, ...] = ()


def reindex(path: Path) -> RepairResult:
    """Write a recording's readable messages into a new file of the same name, and keep the old file next to it.

    Of a folder of rosbag2, all unfinished files are repaired, and `metadata.yaml` is written. For MCAP files, this
    repairs only recordings by thbridge.

    For bags, the result for `NAME.bag` and `NAME.bag.active` is `NAME.bag`, and the old file becomes `NAME.orig.bag`.
    Every complete message is recovered, even in a chunk that is cut off, and after an unreadable record or chunk. A
    connection without a definition gets the known definition with its md5 sum. Otherwise the connection gets the known
    definition for the name of its type, if the first message fits. The old file stays until the new file is complete.

    Raises:
        BadFile: the file is not a recording, another file would be overwritten, or the disk is full.
    """
    if path.is_dir():
        return _reindex_folder(path)
    result = _reindex_file(path)
    folder = result.path.parent
    if result.path == part_of(folder, 0) or ((folder / METADATA).is_file() and result.path.suffix == MCAP):
        _write_metadata(folder)
    return result


def _reindex_folder(folder: Path) -> RepairResult:
    """Repair the unfinished files of a folder of rosbag2."""
    active = [path for _, path in files_in(folder, MCAP + ACTIVE)]
    results, failures = [], []
    for path in active:
        try:
            results.append(_reindex_file(path))
        except BadFile as failure:  # The beginning of a file is lost if the power failed when the file was new.
            failures.append(failure)
    complete = files_in(folder, MCAP)
    if failures and not complete:
        raise failures[0]
    if not complete or (not active and (folder / METADATA).is_file()):
        raise BadFile(folder, "this folder has no unfinished MCAP file", "name a recording that ends abruptly")
    _write_metadata(folder)
    ends = [result.end_ns for result in results if result.end_ns is not None]
    losses = [loss for result in results for loss in result.losses]
    return RepairResult(
        folder,
        results[-1].backup if results else folder,
        sum(result.messages for result in results),
        max(ends, default=None),
        sum(result.lost_bytes for result in results),
        (*losses, *map(str, failures)),
    )


def _write_metadata(folder: Path) -> None:
    try:
        write_metadata(folder)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise BadFile(folder / METADATA, f"cannot be written: {reason}", "free disk space") from error


def _reindex_file(path: Path) -> RepairResult:
    compression = _first_compression(scan_mcap(path), MCAP_COMPRESSIONS) if _is_mcap(path) else compression_of(path)
    repaired = path.with_name(path.name.removesuffix(ACTIVE))
    backup = repaired.with_name(f"{repaired.stem}.orig{repaired.suffix}")
    fresh = repaired.with_name(repaired.name + ".reindexing")
    for taken in {backup, repaired} - {path}:
        if taken.exists():
            remedy = "move this file to another folder first"
            raise BadFile(taken, "this file exists, and the repair would overwrite it", remedy)
    try:
        fresh.unlink(missing_ok=True)
        copy = _copy_mcap if _is_mcap(path) else _copy
        messages, end_ns, losses = copy(path, fresh, compression)
        # BagFile has synced the bytes. A power failure at any step leaves the old or the complete new file.
        if repaired == path:
            with contextlib.suppress(OSError):  # Some file systems have no hard links.
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
        raise BadFile(path, f"the repair failed: {reason}", "free disk space for a second copy of the bag") from error
    return RepairResult(repaired, backup, messages, end_ns, losses.bytes, tuple(losses.sentences()))


def _is_mcap(path: Path) -> bool:
    """Return True if the name of a file, without `.active`, ends in `.mcap`."""
    return path.name.removesuffix(ACTIVE).endswith(MCAP)


def compression_of(path: Path) -> Compression:
    """Return the compression of a file's first chunk if we can write this compression; otherwise `Compression.NONE`."""
    return _first_compression(scan(path), ROS1_COMPRESSIONS)


def _first_compression(records: Iterable[BagRecord], possible: Collection[Compression]) -> Compression:
    name = next((record.compression for record in records if isinstance(record, ChunkRecord)), Compression.NONE)
    return Compression(name) if name in possible else Compression.NONE


SHARED_NUMBERS = 1_000_000
"""First new number for connections that share their number with another connection."""


@dataclass(slots=True)
class _Losses:
    """Losses of a repair: damaged bytes, messages of unknown connections, shared connection numbers."""

    spans: list[UnreadableSpan] = field(default_factory=list)
    messages: Counter[int] = field(default_factory=Counter)
    message_bytes: Counter[int] = field(default_factory=Counter)
    sharing: dict[int, dict[tuple[str, str], int]] = field(default_factory=dict)

    def add(self, span: UnreadableSpan) -> None:
        """Add unreadable bytes as a span. After `MOST_SPANS` spans, bytes are added to the last span."""
        if span.lost and len(self.spans) < MOST_SPANS:
            self.spans.append(span)
        elif span.lost:
            self.spans[-1] = replace(self.spans[-1], lost=self.spans[-1].lost + span.lost)

    def renumbered(self, known: BagConnection, other: BagConnection) -> BagConnection:
        """Record that two connections have the same number; return the second connection with a new number."""
        shared = self.sharing.setdefault(other.number, {(known.topic, known.msgtype): known.number})
        fresh = SHARED_NUMBERS + sum(map(len, self.sharing.values()))  # of integers
        shared.setdefault((other.topic, other.msgtype), fresh)
        return replace(other, number=shared[other.topic, other.msgtype])

    @property
    def bytes(self) -> int:
        return sum(span.lost for span in self.spans) + self.message_bytes.total()

    def sentences(self) -> Iterator[str]:
        for span in self.spans:
            yield f"{span.lost} bytes from byte {span.position} on cannot be read: {span.problem}."
        for number, count in sorted(self.messages.items()):
            what = f"{count} messages of connection {number}, {self.message_bytes[number]} bytes"
            yield f"{what}: no readable record has its topic and type."
        for number, shared in self.sharing.items():
            first, second, *more = (f"{topic} ({msgtype})" for topic, msgtype in shared)
            others = f" and {len(more)} more" if more else ""
            yield (
                f"{first} and {second}{others} have the same connection number {number}. Each message counts as one of "
                "the connection with the last record before it, which may be wrong inside a chunk."
            )


def _copy(path: Path, fresh: Path, compression: Compression) -> tuple[int, int | None, _Losses]:
    """Copy the messages. Return the number of messages, the last stamp, and the losses."""
    count, end_ns, losses = 0, None, _Losses()
    connections: dict[int, BagConnection] = {}
    undefined: set[int] = set()
    looked_everywhere = False
    target = BagFile(fresh, compression)
    for record in scan(path):
        match record:
            case ConnectionRecord(number):
                known = connections.get(number)
                if known is None or (known.topic, known.msgtype) != (record.topic, record.msgtype):
                    made = _connection(record)
                    if known is not None:
                        made = losses.renumbered(known, made)
                    connections[number] = made
                    undefined = (undefined - {number}) | _undefined({number: made})
            case MessageRecord(number, stamp_ns, data):
                if number not in connections and not looked_everywhere:
                    # The chunk with this connection cannot be read; a later chunk or the index may contain the
                    # connection again.
                    connections = _all_connections(path) | connections
                    undefined |= _undefined({number: connections[number]} if number in connections else {})
                    looked_everywhere = True
                if number in connections:
                    if number in undefined:
                        undefined.remove(number)
                        connections[number] = _named(connections[number], data)
                    target.write(connections[number], stamp_ns, data)
                    count += 1
                    end_ns = stamp_ns if end_ns is None else max(end_ns, stamp_ns)
                else:
                    losses.messages[number] += 1
                    losses.message_bytes[number] += len(data)
            case UnreadableSpan():
                losses.add(record)
    target.close()
    return count, end_ns, losses


def _copy_mcap(path: Path, fresh: Path, compression: Compression) -> tuple[int, int | None, _Losses]:
    """Copy the messages of an MCAP file, like `_copy`."""
    count, end_ns, losses = 0, None, _Losses()
    connections: dict[int, BagConnection] = {}
    target = BagFile(fresh, compression, MCAP_FILE)
    for record in scan_mcap(path):
        match record:
            case ConnectionRecord():
                connections.setdefault(
                    record.number,
                    BagConnection(
                        record.number,
                        record.topic,
                        record.msgtype,
                        record.md5,
                        record.definition,
                        record.caller,
                        record.latched,
                    ),
                )
            case MessageRecord(number, stamp_ns, data):
                target.write(connections[number], stamp_ns, data)
                count += 1
                end_ns = stamp_ns if end_ns is None else max(end_ns, stamp_ns)
            case UnreadableSpan():
                losses.add(record)
    target.close()
    return count, end_ns, losses


def _all_connections(path: Path) -> dict[int, BagConnection]:
    return {record.number: _connection(record) for record in scan(path) if isinstance(record, ConnectionRecord)}


def _undefined(connections: Mapping[int, BagConnection]) -> set[int]:
    """Return the numbers of the connections without a complete definition."""
    return {number for number, each in connections.items() if missing_types(each.msgtype, each.md5, each.definition)}


def _named(connection: BagConnection, data: bytes) -> BagConnection:
    """Return the connection, with the known definition of its type's name if a message fits this definition."""
    found, known = by_name(connection.msgtype, data), known_definition(connection.msgtype)
    if found is None or known is None:
        return connection
    return replace(connection, definition=found.definition, md5=connection.md5 or known.md5)


def _connection(record: ConnectionRecord) -> BagConnection:
    found = identified(record.msgtype, record.md5, record.definition)
    md5 = record.md5
    if not md5 and record.definition.strip():
        md5 = md5_of(record.msgtype, record.definition) or ""
    return BagConnection(
        record.number,
        record.topic,
        record.msgtype,
        md5,
        record.definition if found is None else found.definition,
        record.caller,
        record.latched if record.latching is not None else None,
    )

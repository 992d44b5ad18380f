"""A recording into tables, as it is read: memory holds a few thousand messages of each topic, and all poses."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from thbridge.analysis.export import poses
from thbridge.analysis.export.layout import layout_of
from thbridge.analysis.export.tables import Table, TableRows, TopicTables
from thbridge.recording.bag.records import BagConnection
from thbridge.ros.messages import unpack
from thbridge.ros.messages.records import SessionRecord
from thbridge.ros.messages.types import SESSION

EMPTY_MD5 = "d41d8cd98f00b204e9800998ecf8427e"
"""Of types without fields."""
PIECE = 4 << 20
"""Bytes of a topic's messages that are made into rows at once."""


@dataclass(slots=True)
class ExportSummary:
    """What was exported; filled while it is.

    Attributes:
        tables: by name, with their rows.
        frames: by name of table and column: the frame of its values.
        session: of our own recordings.
        notices: what could not be exported, for people.
    """

    tables: dict[str, tuple[Table, int]] = field(default_factory=dict)
    frames: dict[tuple[str, str], str] = field(default_factory=dict)
    session: SessionRecord | None = None
    notices: list[str] = field(default_factory=list)


def export(
    recorded: Iterable[tuple[BagConnection, int, bytes]], start_ns: int, exported: ExportSummary
) -> Iterator[TableRows]:
    """The rows of every topic, piece by piece, those of one table in order.

    Args:
        recorded: messages, oldest first: their publisher, when they were recorded, their bytes.
        start_ns: what `t_s` counts from.
        exported: is told what there was.
    """
    topics: dict[tuple[str, str, str], TopicTables | None] = {}
    names = {poses.NAME}
    together = poses.PosesTable()
    broken: Counter[str] = Counter()
    for publisher, stamp_ns, data in recorded:
        key = (publisher.topic, publisher.msgtype, publisher.md5)
        if key not in topics:
            topics[key] = _begun(publisher, names, start_ns, exported.notices)
        gathered = topics[key]
        if gathered is None:
            continue
        try:
            gathered.add(stamp_ns, data)
        except ValueError as error:
            broken[f"{publisher.topic}: {error}"] += 1
        if publisher.msgtype == SESSION:
            exported.session = exported.session or _session(data)
        if gathered.size > PIECE:
            yield from _counted(gathered.take(), together, exported)
    for gathered in topics.values():
        if gathered is not None:
            yield from _counted(gathered.take(), together, exported)
            exported.frames |= gathered.frames()
    exported.frames |= poses.FRAMES
    yield from _counted(together.pieces(), poses.PosesTable(), exported)
    exported.notices += [f"{count} messages of {what}." for what, count in broken.items()]


def _begun(publisher: BagConnection, names: set[str], start_ns: int, notices: list[str]) -> TopicTables | None:
    if not publisher.definition.strip() and publisher.md5 != EMPTY_MD5:
        notices.append(f"{publisher.topic} is left out: the bag has no definition of {publisher.msgtype}.")
        return None
    try:
        record = layout_of(publisher.msgtype, publisher.definition)
    except ValueError as error:
        notices.append(f"{publisher.topic} is left out: {error}.")
        return None
    return TopicTables(_file_name(publisher.topic, names), publisher.topic, record, start_ns)


def _session(data: bytes) -> SessionRecord | None:
    """The session, if this is the release that recorded it; else its table has what it says."""
    try:
        return unpack.session(data)
    except ValueError:
        return None


def _file_name(topic: str, taken: set[str]) -> str:
    """A table's name: "/robot1/move_base/goal" gives robot1_move_base_goal; unique where case is not told apart."""
    base = re.sub(r"[^A-Za-z0-9_]+", "_", topic).strip("_") or "topic"
    name, number = base, 2
    while name.lower() in taken:
        name, number = f"{base}_{number}", number + 1
    taken.add(name.lower())
    return name


def _counted(pieces: Iterable[TableRows], together: poses.PosesTable, exported: ExportSummary) -> Iterator[TableRows]:
    for piece in pieces:
        together.see(piece)
        _, before = exported.tables.get(piece.table.name, (piece.table, 0))
        exported.tables[piece.table.name] = (piece.table, before + piece.rows)
        yield piece

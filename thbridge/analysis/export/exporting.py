"""Conversion of a recording to tables while it is read; only open row groups stay in memory."""

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from thbridge.analysis.export import dialogues, poses
from thbridge.analysis.export.tables import GAME, ROOM_NAME, SECONDS, Table, TableRows, TopicTables, short_name
from thbridge.analysis.fields.layout import layout_of
from thbridge.analysis.report.game_starts import OF_A_GAME, GameStart
from thbridge.hunt.rooms import RoomNames
from thbridge.recording.bag.records import BagConnection
from thbridge.ros.messages import unpack
from thbridge.ros.messages.identification import EMPTY_MD5, DefinitionSource
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.ros.messages.types import GAME_EVENT, UTTERANCE

PIECE = 4 << 20
"""Maximum number of bytes of a topic's messages that are converted to rows together."""
LONGEST_TOPIC = 100
"""Maximum number of characters of a topic in its table's name; longer topics are cut and get a digest."""
HELD = 48 << 20
"""If all waiting messages have more bytes than this, the messages of one topic are converted."""


@dataclass(slots=True)
class ExportSummary:
    """Summary of an export, filled while it runs.

    Attributes:
        tables: each table by name, with its number of rows.
        frames: frame of a column's values, by table and column.
        session: session record; None if thbridge did not record the bag.
        rooms: names of the map's rooms.
        notices: sentences about data that could not be exported.
    """

    tables: dict[str, tuple[Table, int]] = field(default_factory=dict)
    frames: dict[tuple[str, str], str] = field(default_factory=dict)
    session: SessionRecord | None = None
    rooms: RoomNames = field(default_factory=RoomNames)
    notices: list[str] = field(default_factory=list)


def export(
    recorded: Iterable[tuple[BagConnection, int, bytes]],
    start_ns: int,
    exported: ExportSummary,
    games: Sequence[GameStart] = (),
    tables: Collection[str] | None = None,
) -> Iterator[TableRows]:
    """Yield the rows of every topic in pieces; the rows of one table are in order.

    Args:
        recorded: messages, oldest first: publisher, stamp of recording, bytes.
        start_ns: stamp from which `t_s` counts.
        exported: summary to fill; the names of rooms in it are added next to room numbers.
        games: beginnings of the recording's games. If there are any, each table has a column with the game's number.
        tables: names of the tables to create, including tables of lists. If None, all tables are created.
    """
    numbered = _GameNumbers(games, start_ns)
    topics: dict[tuple[str, str, str], TopicTables | None] = {}
    names = {poses.NAME, *dialogues.NAMES}
    together = (poses.PosesTable(), dialogues.DialogueTables())
    broken: Counter[str] = Counter()
    held = 0
    for publisher, stamp_ns, data in recorded:
        key = (publisher.topic, publisher.msgtype, publisher.md5)
        if key not in topics:
            topics[key] = _begun(publisher, names, start_ns, exported.notices)
        gathered = topics[key]
        if gathered is None:
            continue
        before = gathered.size
        gathered.add(stamp_ns, data)
        held += gathered.size - before
        if gathered.size > PIECE or held > HELD:
            full = gathered
            if gathered.size <= PIECE:
                full = max(filter(None, topics.values()), key=_bytes_of_a_column)
            held -= full.size
            yield from _counted(_taken(full, broken, numbered), together, exported, tables)
    for gathered in topics.values():
        if gathered is not None:
            yield from _counted(_taken(gathered, broken, numbered), together, exported, tables)
            exported.frames |= gathered.frames()
    exported.frames |= poses.FRAMES
    for each in together:
        yield from _counted(map(numbered.of, each.pieces()), (), exported, tables)
    exported.notices += together[0].notices()
    exported.notices += [f"{count} messages of {what}." for what, count in broken.items()]


def _bytes_of_a_column(gathered: TopicTables) -> float:
    """Return the waiting bytes per column. Until a file is closed, it needs a kilobyte for each column and piece."""
    return gathered.size / gathered.columns


def _taken(gathered: TopicTables, broken: Counter[str], numbered: "_GameNumbers") -> Iterator[TableRows]:
    """Yield the rows of a topic with the numbers of games; count messages that cannot be read, by sentence."""
    lost: Counter[str] = Counter()
    yield from map(numbered.of, gathered.take(lost))
    broken.update({f"{gathered.topic}: {problem}": count for problem, count in lost.items()})


def _with_room_names(piece: TableRows, rooms: RoomNames) -> TableRows:
    """Return rows of thbridge's messages about rooms with a column of room names; other rows are unchanged."""
    table = piece.table
    at = next((index for index, column in enumerate(table.columns, start=1) if column.name == "room"), None)
    if at is None or table.msgtype not in {GAME_EVENT, UTTERANCE}:
        return piece
    names = [rooms.name(int(room)) for room in np.asarray(piece.values[at - 1])]
    columns = (*table.columns[:at], ROOM_NAME, *table.columns[at:])
    return TableRows(replace(table, columns=columns), piece.rows, (*piece.values[:at], names, *piece.values[at:]))


class _GameNumbers:
    """Column with the number of the game, added to the rows of tables.

    Args:
        games: beginnings of games, oldest first.
        start_ns: stamp from which `t_s` counts.
    """

    def __init__(self, games: Sequence[GameStart], start_ns: int) -> None:
        self._starts = np.array([(game.stamp_ns - start_ns) / 1e9 for game in games])
        self._numbers = np.array([0, *(game.number for game in games)], dtype=np.int64)

    def of(self, piece: TableRows) -> TableRows:
        """Return the rows with this column before the column of time; unchanged in a recording without games."""
        if not len(self._starts):
            return piece
        table = piece.table
        at = [column.name for column in table.columns].index(SECONDS.name)
        side: Literal["left", "right"] = "right" if table.msgtype in OF_A_GAME else "left"
        numbers = self._numbers[np.searchsorted(self._starts, np.asarray(piece.values[at]), side=side)]
        columns = (*table.columns[:at], GAME, *table.columns[at:])
        return TableRows(replace(table, columns=columns), piece.rows, (*piece.values[:at], numbers, *piece.values[at:]))


def _begun(publisher: BagConnection, names: set[str], start_ns: int, notices: list[str]) -> TopicTables | None:
    if not publisher.definition.strip() and publisher.md5 != EMPTY_MD5:
        notices.append(f"{publisher.topic} is omitted: the bag has no definition of {publisher.msgtype}.")
        return None
    try:
        record = layout_of(publisher.msgtype, publisher.definition)
    except ValueError as error:
        notices.append(f"{publisher.topic} is omitted: {error}.")
        return None
    if publisher.source is not DefinitionSource.BAG:
        why = (
            "because its md5 sum matches" if publisher.source is DefinitionSource.MD5 else "because its messages match"
        )
        taken = f"the definition of {publisher.msgtype} in ROS Noetic is used, {why}"
        notices.append(f"{publisher.topic}: the bag has no complete definition of its type; {taken}.")
    return TopicTables(_file_name(publisher.topic, names), publisher.topic, record, start_ns)


def session_in(data: bytes) -> SessionRecord | None:
    """Return the session record in a message; None if another version with other fields recorded it."""
    try:
        return unpack.session(data)
    except ValueError:
        return None


def rooms_in(data: bytes) -> RoomNames:
    """Return the names of rooms in a message; empty if the message cannot be read."""
    try:
        return RoomNames.of(unpack.room_labels(data).items())
    except ValueError:
        return RoomNames()


def table_name(topic: str) -> str:
    """Return the name of a topic's table: "/robot1/move_base/goal" gives robot1_move_base_goal; long names are cut."""
    return re.sub(r"[^A-Za-z0-9_]+", "_", short_name(topic, LONGEST_TOPIC)).strip("_") or "topic"


def _file_name(topic: str, taken: set[str]) -> str:
    """Return a table's name that is unique even if case is ignored."""
    base = table_name(topic)
    name, number = base, 2
    while name.lower() in taken:
        name, number = f"{base}_{number}", number + 1
    taken.add(name.lower())
    return name


def _counted(
    pieces: Iterable[TableRows],
    together: Collection[poses.PosesTable | dialogues.DialogueTables],
    exported: ExportSummary,
    tables: Collection[str] | None,
) -> Iterator[TableRows]:
    for each in pieces:
        piece = _with_room_names(each, exported.rooms)
        for kept in together:
            kept.add(piece)
        if tables is not None and piece.table.name.partition(".")[0] not in tables:
            continue
        _, before = exported.tables.get(piece.table.name, (piece.table, 0))
        exported.tables[piece.table.name] = (piece.table, before + piece.rows)
        yield piece

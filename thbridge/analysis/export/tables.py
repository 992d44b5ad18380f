"""Tables of a topic: one row per message, and a separate table for each array of messages within them."""

from array import array
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from hashlib import sha256

import numpy as np
from numpy.typing import NDArray

from thbridge.analysis.export import meanings as words
from thbridge.analysis.export.columns import ColumnReader, fields_of
from thbridge.analysis.fields.layout import MessageArray, MessageLayout
from thbridge.analysis.fields.rows import GatheredRows
from thbridge.files.tables.table_files import Column, Values
from thbridge.json_text import json_of
from thbridge.ros.messages.types import GAME_EVENT

SECONDS = Column("t_s", "float64", "s", "time of recording since the beginning of the recording")
GAME = Column("game", "int64", "", "number of the game; 0 before the first game")
ROOM_NAME = Column("room_name", "string", "", "name of the room; empty if it has none")
RECORDED = Column("recorded_ns", "int64", "ns", "time of recording; in thbridge's recordings, simulated time")
INDEX = Column("index", "int64", "", "index in its array, from 0")
EVENT = "event_"
"""Prefix of the names of columns that come from an event's JSON."""
HAS_COLUMNS = frozenset({"v", "event", "robot", "room"})
"""Keys of the JSON that get no column: they describe the format, or other columns have the value in ROS's numbering."""
LONGEST_TABLE = 200
"""Maximum length of a table's name, without the digest of longer names: file names have at most 255 characters."""
MOST_FRAMES = 3
"""Maximum number of frames that the dictionary lists for a column; with more, it names the column with the frames."""


def short_name(name: str, longest: int) -> str:
    """Return a name that files can have: a name that is too long is cut and gets a digest."""
    return name if len(name) <= longest else f"{name[:longest]}_{sha256(name.encode()).hexdigest()[:8]}"


@dataclass(frozen=True, slots=True)
class Table:
    """Description of a table.

    Attributes:
        name: name of the table's file, without suffix.
        source: topic and, for an array within the topic's messages, the field.
        msgtype: message type of a row.
        meaning: meaning for people; "" if unknown.
        columns: columns in order.
    """

    name: str
    source: str
    msgtype: str
    meaning: str
    columns: tuple[Column, ...]


@dataclass(frozen=True, slots=True, eq=False)
class TableRows:
    """Some rows of a table.

    Attributes:
        table: description of the table.
        rows: number of rows.
        values: values of the columns, in order.
    """

    table: Table
    rows: int
    values: tuple[Values, ...]


class TopicTables:
    """Converter of the messages of one topic and type to tables.

    Args:
        name: name of the first table; tables of arrays within it are called NAME.FIELD.
        topic: topic, with its leading slash.
        record: layout of the type.
        start_ns: beginning of the recording.

    Attributes:
        topic: topic, with its leading slash.
        columns: number of columns of all its tables.
        size: bytes of the messages that were added and not taken; 0 for game events, whose columns are only known at
            the end of the recording.
    """

    def __init__(self, name: str, topic: str, record: MessageLayout, start_ns: int) -> None:
        self._rows = GatheredRows(record)
        self._stamps, self._lengths, self._messages = array("q"), array("q"), bytearray()
        self._start_ns = start_ns
        self._open_ended = record.msgtype == GAME_EVENT
        self._top = _TableNode(name, topic, words.topic_meaning(topic), record, top=True)
        self.topic, self.size = topic, 0
        self.columns = self._top.columns

    def add(self, stamp_ns: int, data: bytes) -> None:
        """Append a message."""
        self._stamps.append(stamp_ns)
        self._lengths.append(len(data))
        self._messages += data
        if not self._open_ended:
            self.size += len(data)

    def take(self, broken: Counter[str]) -> Iterator[TableRows]:
        """Yield the rows of the added messages, then drop them; unreadable messages are counted in `broken`."""
        lost = self._rows.add_all(self._messages, np.array(self._lengths))
        broken.update(lost.values())
        stamps = np.delete(np.array(self._stamps), list(lost))
        self._stamps, self._lengths, self._messages, self.size = array("q"), array("q"), bytearray(), 0
        seconds = (stamps - self._start_ns) / 1e9
        for piece in self._top.pieces(self._rows, seconds, (stamps,)):
            yield _with_events(piece) if self._open_ended else piece
        self._rows.clear()

    def frames(self) -> Mapping[tuple[str, str], str]:
        """Return the frame of each column's values, by table and column, for messages that have a frame."""
        return dict(self._top.frames({}))


@dataclass(slots=True, eq=False)
class _TableNode:
    """Tables of a message layout. A message that is only one array has no table; its elements are the rows.

    Attributes:
        name: name of the table.
        source: source of the table.
        meaning: meaning of the table.
        record: layout of a row.
        top: True if a row is a message, or an element of a message that is only one array.
        outer: column of the parent table that contains the frame.
        done: number of rows that were taken before.
    """

    name: str
    source: str
    meaning: str
    record: MessageLayout
    top: bool
    outer: str = ""
    done: int = 0
    fields: tuple[ColumnReader, ...] = field(init=False)
    inner: tuple[tuple[MessageArray, "_TableNode"], ...] = field(init=False)
    seen_frames: dict[str, set[str]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self.fields = fields_of(self.record, {"t_s", "recorded_ns", "game", "row", "index"}, self.outer)
        own_frame = next((f.column.name for f in self.fields if f.column.name == "frame_id"), self.outer)
        self.inner = tuple((items, self._within(items, own_frame)) for items in self.record.items())

    def _within(self, items: MessageArray, own_frame: str) -> "_TableNode":
        path = ".".join(step.field for step in items.path)
        meaning = words.meaning_of(items.path)
        if self._only_array:
            return _TableNode(
                self.name, f"{self.source}: {path}", self.meaning or meaning, items.record, True, own_frame
            )
        name, source = short_name(f"{self.name}.{path}", LONGEST_TABLE), f"{self.source}: {path}"
        return _TableNode(name, source, meaning or self.meaning, items.record, False, own_frame)

    @property
    def columns(self) -> int:
        """Number of columns of this table and the tables within, including times and keys."""
        return len(self.fields) + 4 + sum(within.columns for _, within in self.inner)

    @property
    def _only_array(self) -> bool:
        return not self.fields and len(self.record.items()) == 1

    def pieces(
        self,
        rows: GatheredRows,
        seconds: NDArray[np.float64],
        recorded: tuple[NDArray[np.int64], ...],
        keys: "_Keys | None" = None,
    ) -> Iterator[TableRows]:
        """Yield the tables' rows. `seconds` and `recorded` are the times of each row; `keys` locates array elements."""
        if not self._only_array:
            yield self._own(rows, seconds, recorded, keys)
        for index, items, within in rows.items():
            shape = next(shape for known, shape in self.inner if known is items)
            lengths = rows.lengths(index)
            below = _Keys.of(lengths, self.done)
            stamps = tuple(np.repeat(stamp, lengths) for stamp in recorded if shape.top)
            yield from shape.pieces(within, np.repeat(seconds, lengths), stamps, below)
        self.done += rows.count

    def _own(
        self,
        rows: GatheredRows,
        seconds: NDArray[np.float64],
        recorded: tuple[NDArray[np.int64], ...],
        keys: "_Keys | None",
    ) -> TableRows:
        columns: list[Column] = [SECONDS]
        values: list[Values] = [seconds]
        if recorded:
            columns.append(RECORDED)
            values.append(recorded[0])
        if keys is not None:
            what = "number of the message, from 0" if self.top else f"row of {self.name.rpartition('.')[0]}, from 0"
            columns += [Column("row", "int64", "", what), INDEX]
            values += [keys.row, keys.index]
        own: list[Values] = []
        for each in self.fields:
            taken = each.values(rows)
            if isinstance(taken, list) and each.column.name.endswith("frame_id"):
                self._note_frames(each.column.name, taken)
            own.append(taken)
        table = Table(
            self.name,
            self.source,
            self.record.msgtype,
            self.meaning,
            (*columns, *(each.column for each in self.fields)),
        )
        return TableRows(table, rows.count, (*values, *own))

    def _note_frames(self, column: str, frames: list[str] | list[str | None] | list[bytes]) -> None:
        self.seen_frames.setdefault(column, set()).update(map(str, set(frames)))

    def frames(self, above: Mapping[str, set[str]]) -> Iterator[tuple[tuple[str, str], str]]:
        """Yield the items of `TopicTables.frames`; `above` contains the frames in the parent table, by column."""
        seen_frames = {**above, **self.seen_frames}
        for each in self.fields:
            if (source := each.column.frame_column) and (found := seen_frames.get(source)):
                few = len(found) <= MOST_FRAMES
                yield (self.name, each.column.name), " or ".join(sorted(found)) if few else f"see {source}"
        for _, shape in self.inner:
            yield from shape.frames(seen_frames)


@dataclass(frozen=True, slots=True, eq=False)
class _Keys:
    """Keys of array elements: the row in the parent table, and the index in its array."""

    row: NDArray[np.int64]
    index: NDArray[np.int64]

    @classmethod
    def of(cls, lengths: NDArray[np.int64], done: int) -> "_Keys":
        starts = np.cumsum(lengths) - lengths
        row = np.repeat(np.arange(len(lengths), dtype=np.int64), lengths)
        return cls(row + done, np.arange(int(lengths.sum()), dtype=np.int64) - np.repeat(starts, lengths))


def _with_events(piece: TableRows) -> TableRows:
    """Return rows of events with the simple values of their JSON as further columns, in order of first appearance."""
    table = piece.table
    texts = next(v for column, v in zip(table.columns, piece.values, strict=True) if column.name == "json")
    objects = [_object(text) for text in texts] if isinstance(texts, list) else []
    names = dict.fromkeys(
        name for each in objects for name, value in each.items() if _is_plain(value) and name not in HAS_COLUMNS
    )
    added: list[Column] = []
    found: list[Values] = []
    for name in names:
        plain = [each.get(name) for each in objects]
        kind, converted = _column([value if _is_plain(value) else None for value in plain])
        added.append(Column(f"{EVENT}{name}", kind, "", f"{name.replace('_', ' ')}, for events that have it"))
        found.append(converted)
    wide = Table(table.name, table.source, table.msgtype, table.meaning, (*table.columns, *added))
    return TableRows(wide, piece.rows, (*piece.values, *found))


def _object(text: object) -> dict[str, object]:
    try:
        read = json_of(str(text))
    except ValueError:
        return {}
    return read if isinstance(read, dict) else {}


def _is_plain(value: object) -> bool:
    return isinstance(value, str | int | float)


def _column(values: list[object]) -> tuple[str, Values]:
    """Return the type and values of a column: numbers, or strings if a value is no number. Missing: NaN or None."""
    if all(value is None or (isinstance(value, int | float) and not isinstance(value, bool)) for value in values):
        numbers = [np.nan if value is None else float(str(value)) for value in values]
        return "float64", np.array(numbers, dtype=np.float64)
    return "string", [None if value is None else str(value) for value in values]

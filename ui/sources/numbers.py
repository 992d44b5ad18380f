"""Numbers in the messages of a recording, for all types that the recording defines; read on demand."""

from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sim.numerics.float_array import FloatArray
from thbridge.analysis.export.tables import INDEX, RECORDED, SECONDS, TableRows, TopicTables
from thbridge.analysis.fields.layout import layout_of
from thbridge.files.tables.table_files import ListColumn, OptionalColumn, Values
from thbridge.recording.bag.reading.index import BagIndex, IndexedConnection, MessageLocation

MOST_ELEMENTS = 32
"""A person can choose at most this number of elements of an array of numbers or of messages."""
_KEYS = frozenset({SECONDS.name, RECORDED.name, INDEX.name, "row"})
"""Columns that identify a row."""
_PIECE = 100
"""Number of messages that are read in one piece. Reading a piece takes some milliseconds."""
_TOGETHER = 4000
"""Maximum number of messages that are decoded together."""
_NO_CURVE: tuple[FloatArray, FloatArray] = (np.empty(0), np.empty(0))


@dataclass(frozen=True, slots=True)
class TopicContents:
    """Topic of a recording, with its message types and the number of its messages."""

    name: str
    msgtype: str
    messages: int


@dataclass(frozen=True, slots=True)
class PlottedField:
    """Number in the messages of a topic.

    Attributes:
        topic: name of the topic.
        table: path of the array of messages that contains the number; empty if the message itself contains it.
        column: name of the field with its unit, as in exported tables, without outer fields such as `pose`.
        unit: unit; empty if the number has no unit, or an unknown unit.
        item: index in the array of messages; None if the message itself contains the number.
        element: index in the array of numbers; None for a single number.
    """

    topic: str
    table: str
    column: str
    unit: str
    item: int | None = None
    element: int | None = None

    @property
    def name(self) -> str:
        """Name of the number within the topic, for example "transforms[0].x_m"."""
        item = "" if self.item is None else f"{self.table}[{self.item}]."
        return f"{item}{self.column}" if self.element is None else f"{item}{self.column}[{self.element}]"


@dataclass(slots=True)
class _CurveParts:
    """Curve of a number while it is read: pieces of times and values, which `joined` joins."""

    pieces: list[tuple[FloatArray, FloatArray]] = field(default_factory=list)

    def joined(self) -> tuple[FloatArray, FloatArray]:
        if len(self.pieces) > 1:
            times, values = zip(*self.pieces, strict=True)
            self.pieces = [(np.concatenate(times), np.concatenate(values))]
        return self.pieces[0] if self.pieces else _NO_CURVE


class TopicNumbers:
    """Topics of a recording, and the numbers in their messages; for use in one thread.

    All methods that read the file raise BadFile if the file is damaged or missing.

    Args:
        index: index of the recording.

    Attributes:
        topics: all topics by name, including those without numbers.
        chosen: numbers whose values are read and kept.
    """

    def __init__(self, index: BagIndex) -> None:
        self._index = index
        kinds: dict[str, set[str]] = {}
        for publisher in index.publishers:
            kinds.setdefault(publisher.topic, set()).add(publisher.msgtype)
        self.topics = tuple(
            TopicContents(topic, ", ".join(sorted(kinds[topic])), count) for topic, count in index.counts.items()
        )
        self.chosen: tuple[PlottedField, ...] = ()
        self._fields: dict[str, tuple[PlottedField, ...]] = {}
        self._curves: dict[PlottedField, _CurveParts] = {}
        self._reading: tuple[tuple[PlottedField, ...], Iterator[float]] | None = None
        self.share = 1.0

    def fields(self, topic: str) -> tuple[PlottedField, ...]:
        """Return the numbers in the messages of a topic, found in the topic's first, middle and last message."""
        if topic not in self._fields:
            tables = _Tables(topic, self._index.start_ns)
            for place in self._samples(topic):
                tables.add(place, self._index.read(place).data)
            found = (each for rows in tables.take() for each in _fields_in(topic, rows))
            self._fields[topic] = tuple(sorted(dict.fromkeys(found), key=_is_minor))
        return self._fields[topic]

    def choose(self, chosen: Collection[PlottedField]) -> None:
        """Choose numbers: keep the curves of these numbers, and begin to read missing curves."""
        self.chosen = tuple(chosen)
        unfinished = () if self._reading is None else self._reading[0]
        self._reading = None
        self._curves = {
            each: parts for each, parts in self._curves.items() if each in self.chosen and each not in unfinished
        }

    def work(self) -> bool:
        """Continue reading for some milliseconds; return False if all chosen numbers are read."""
        if self._reading is None:
            missing = [each for each in self.chosen if each not in self._curves]
            if not missing:
                return False
            wanted = tuple(each for each in missing if each.topic == missing[0].topic)
            self._curves.update((each, _CurveParts()) for each in wanted)
            self._reading = wanted, self._read(missing[0].topic, wanted)
        share = next(self._reading[1], None)
        self.share = 1.0 if share is None else share
        if share is None:
            self._reading = None
        return True

    def curve(self, number: PlottedField) -> tuple[FloatArray, FloatArray]:
        """Return (n,) seconds since the beginning and (n,) values of a chosen number, up to the part read so far."""
        parts = self._curves.get(number)
        return _NO_CURVE if parts is None else parts.joined()

    def _samples(self, topic: str) -> set[MessageLocation]:
        start, end = self._index.start_ns, self._index.end_ns
        places = (
            self._index.next(topic, -1),
            self._index.last(topic, (start + end) // 2),
            self._index.last(topic, end),
        )
        return {place for place in places if place is not None}

    def _read(self, topic: str, wanted: Collection[PlottedField]) -> Iterator[float]:
        """Read the messages of a topic; yield the completed share of the work."""
        tables, chunks, waiting = _Tables(topic, self._index.start_ns), max(self._index.chunks, 1), 0
        for done, places in enumerate(self._index.walk([topic])):
            for place in places:
                tables.add(place, self._index.read(place).data)
                waiting += 1
                if waiting % _PIECE == 0:
                    yield done / chunks
                if waiting >= _TOGETHER:
                    self._keep(tables, wanted)
                    waiting = 0
            yield (done + 1) / chunks
        self._keep(tables, wanted)

    def _keep(self, tables: "_Tables", wanted: Collection[PlottedField]) -> None:
        for rows in tables.take():
            for number in wanted:
                if rows.table.name.removeprefix(".") == number.table and (piece := _values_of(rows, number)):
                    self._curves[number].pieces.append(piece)


class _Tables:
    """Tables of a topic, which may have publishers of several types."""

    def __init__(self, topic: str, start_ns: int) -> None:
        self._topic, self._start_ns = topic, start_ns
        self._tables: dict[IndexedConnection, TopicTables | None] = {}

    def add(self, place: MessageLocation, data: bytes) -> None:
        """Add a message, unless its type cannot be read."""
        publisher = place.publisher
        if publisher not in self._tables:
            try:
                layout = layout_of(publisher.msgtype, publisher.definition)
                self._tables[publisher] = TopicTables("", self._topic, layout, self._start_ns)
            except ValueError:
                self._tables[publisher] = None
        if (tables := self._tables[publisher]) is not None:
            tables.add(place.stamp_ns, data)

    def take(self) -> Iterator[TableRows]:
        """Yield the rows of the added messages, then remove them."""
        for tables in self._tables.values():
            if tables is not None:
                yield from tables.take(Counter())


def _is_minor(number: PlottedField) -> bool:
    """Return True for numbers that people rarely plot, and that are therefore listed last."""
    return number.column in {"seq", "stamp_ns"} or "cov_" in number.column or "covariance" in number.column


def _fields_in(topic: str, rows: TableRows) -> Iterator[PlottedField]:
    """Yield the numbers in some rows of a table."""
    table, names = rows.table.name.removeprefix("."), [column.name for column in rows.table.columns]
    items: list[int | None] = [None]
    if INDEX.name in names:
        longest = max(np.asarray(rows.values[names.index(INDEX.name)]), default=-1) + 1
        items = list(range(min(int(longest), MOST_ELEMENTS)))
    for item in items:
        for column, values in zip(rows.table.columns, rows.values, strict=True):
            if column.name in _KEYS:
                continue
            if isinstance(values, ListColumn):
                if _is_numbers(values.elements):
                    longest = max(values.lengths, default=0)
                    for element in range(min(int(longest), MOST_ELEMENTS)):
                        yield PlottedField(topic, table, column.name, column.unit, item, element)
            elif isinstance(values, OptionalColumn) or _is_numbers(values):
                yield PlottedField(topic, table, column.name, column.unit, item)


def _is_numbers(values: object) -> bool:
    return isinstance(values, np.ndarray) and values.dtype.kind in "biuf"


def _values_of(rows: TableRows, number: PlottedField) -> tuple[FloatArray, FloatArray] | None:
    """Return (n,) times and (n,) values of a number in rows of its table; None if the table has no such column."""
    names = [column.name for column in rows.table.columns]
    if number.column not in names:
        return None
    values = _numbers(rows.values[names.index(number.column)], number.element)
    times: FloatArray = np.asarray(rows.values[names.index(SECONDS.name)], dtype=np.float64)
    if number.item is not None:
        own: NDArray[np.bool_] = np.asarray(rows.values[names.index(INDEX.name)]) == number.item
        times, values = times[own], values[own]
    return times, values


def _numbers(values: Values, element: int | None) -> FloatArray:
    """Return (rows,) values of a column, or of one element of an array column; NaN if the element does not exist."""
    match values:
        case ListColumn():
            starts = np.cumsum(values.lengths) - values.lengths
            found = np.full(len(values.lengths), np.nan)
            if element is not None:
                longer = values.lengths > element
                found[longer] = np.asarray(values.elements)[starts[longer] + element]
            return found
        case OptionalColumn():
            return np.where(values.known, np.asarray(values.values, dtype=np.float64), np.nan)
        case _:
            return np.asarray(values, dtype=np.float64)

"""Buffers that collect messages field by field before conversion to columns."""

from collections.abc import Iterator, Sequence
from itertools import chain, pairwise
from struct import Struct
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from thbridge.analysis.fields.layout import (
    DTYPES,
    Array,
    FixedBlock,
    MessageArray,
    MessageLayout,
    NumberArray,
    StringArray,
    StringField,
)

_COUNT = Struct("<I")
_TOO_SHORT = "the message ends too early"
ALIKE = 8
"""Minimum number of successive messages of equal length that are cut into fields together."""

Octets: TypeAlias = "NDArray[np.uint8]"


class _Unlike(Exception):  # noqa: N818 - not an error of the program
    """Messages of one length differ in the lengths of their strings or arrays."""


class GatheredRows:
    """Rows of one message type that were gathered but not yet converted.

    Attributes:
        record: layout of a row.
        count: number of rows gathered.
        inner: rows of its arrays of messages, in the order of the layout.
        only_run: the only block of the row, if the row consists of one block.
    """

    def __init__(self, record: MessageLayout) -> None:
        self.record = record
        self.inner = tuple(GatheredRows(items.record) for items in record.items())
        self._inner_of = dict(zip(map(id, record.items()), self.inner, strict=True))
        self.only_run = record.parts[0] if len(record.parts) == 1 and isinstance(record.parts[0], FixedBlock) else None
        self.clear()

    def clear(self) -> None:
        """Drop all rows."""
        self.count = 0
        self._runs: list[bytearray] = [bytearray() for _ in self.record.parts]
        self._texts: list[list[bytes]] = [[] for _ in self.record.parts]
        self._lengths: list[list[int]] = [[] for _ in self.record.parts]
        for rows in self.inner:
            rows.clear()

    def add_all(self, messages: bytearray, lengths: NDArray[np.int64]) -> dict[int, str]:
        """Append messages in their order.

        In most topics, many successive messages have the same length. These messages are cut into fields together, like
        the rows of a table.

        Args:
            messages: bytes of the messages, one after the other.
            lengths: (n,) bytes of each message.

        Returns:
            Problem of each message that does not match the type, by its index; nothing of such a message is kept.
        """
        broken: dict[int, str] = {}
        octets, ends = np.frombuffer(messages, dtype=np.uint8), np.cumsum(lengths)
        turns = (np.flatnonzero(np.diff(lengths)) + 1).tolist()
        for first, last in pairwise([0, *turns, len(lengths)]) if len(lengths) else ():
            length = int(lengths[first])
            table = octets[int(ends[first]) - length : int(ends[last - 1])].reshape(last - first, length)
            if last - first < ALIKE or not self._add_alike(table):
                for index, row in enumerate(table, first):
                    try:
                        self.add(row.tobytes())
                    except ValueError as error:
                        broken[index] = str(error)
        return broken

    def add(self, data: bytes) -> None:
        """Append one message. Raise ValueError if the bytes do not match the type; then none of these bytes is kept."""
        before = self.count
        try:
            end = self._read(data, 0)
            if end != len(data):
                raise ValueError(f"the message has {len(data) - end} bytes too many")
        except ValueError:
            self._truncate(before)
            raise

    def _add_alike(self, table: Octets) -> bool:
        """Append messages of one length, one per row; return False if they cannot be cut into fields together."""
        cuts = _Cuts(self)
        try:
            if cuts.cut(table, 0) != table.shape[1]:
                return False
        except _Unlike:
            return False
        self._append(cuts, len(table))
        return True

    def _append(self, cuts: "_Cuts", messages: int) -> None:
        for index, part in enumerate(self.record.parts):
            pieces = cuts.pieces[index]
            if isinstance(part, FixedBlock | NumberArray):
                self._runs[index] += (pieces[0] if len(pieces) == 1 else _beside(pieces, messages)).tobytes()
            elif isinstance(part, StringField | StringArray):
                self._texts[index].extend(chain.from_iterable(zip(*map(_texts_of, pieces), strict=True)))
            self._lengths[index].extend(cuts.lengths[index] * messages)
        for rows, inner in zip(self.inner, cuts.inner, strict=True):
            rows._append(inner, messages)
        self.count += cuts.rows * messages

    def _read(self, data: bytes, at: int) -> int:
        """Append the record that begins at a byte. Return the offset after it."""
        for index, part in enumerate(self.record.parts):
            if isinstance(part, FixedBlock):
                end = at + part.dtype.itemsize
                if end > len(data):
                    raise ValueError(_TOO_SHORT)
                self._runs[index] += data[at:end]
                at = end
            elif isinstance(part, StringField):
                text, at = _text(data, at)
                self._texts[index].append(text)
            else:
                count = part.count if not isinstance(part, NumberArray) else None
                if count is None:
                    count, at = _count(data, at)
                if isinstance(part, NumberArray):
                    end = at + count * np.dtype(DTYPES[part.kind]).itemsize
                    if end > len(data):
                        raise ValueError(_TOO_SHORT)
                    self._runs[index] += data[at:end]
                    at = end
                elif isinstance(part, StringArray):
                    for _ in range(_sane(count, data, at, 4)):
                        text, at = _text(data, at)
                        self._texts[index].append(text)
                else:
                    at = self._inner_of[id(part)]._read_many(count, data, at)
                self._lengths[index].append(count)
        self.count += 1
        return at

    def _read_many(self, count: int, data: bytes, at: int) -> int:
        # Elements of one fixed block (points, poses) are copied together: most large arrays are of this kind.
        run = self.only_run
        if run is None:
            for _ in range(_sane(count, data, at, 1 if self.record.parts else 0)):
                at = self._read(data, at)
            return at
        end = at + count * run.dtype.itemsize
        if end > len(data):
            raise ValueError(_TOO_SHORT)
        self._runs[0] += data[at:end]
        self.count += count
        return end

    def _truncate(self, rows: int) -> None:
        """Keep only the first rows, to remove the parts of a broken message."""
        self.count = rows
        for index, part in enumerate(self.record.parts):
            if isinstance(part, FixedBlock):
                del self._runs[index][rows * part.dtype.itemsize :]
                continue
            if isinstance(part, StringField):
                del self._texts[index][rows:]
                continue
            del self._lengths[index][rows:]
            elements = sum(self._lengths[index])
            if isinstance(part, NumberArray):
                del self._runs[index][elements * np.dtype(DTYPES[part.kind]).itemsize :]
            elif isinstance(part, StringArray):
                del self._texts[index][elements:]
            else:
                self._inner_of[id(part)]._truncate(elements)

    def run(self, index: int, run: FixedBlock) -> NDArray[np.void]:
        """Return (count,) structures of the part at an index."""
        return np.frombuffer(self._runs[index], dtype=run.dtype)

    def texts(self, index: int) -> list[str]:
        """Return the strings of the part at an index: one per row or, for an array, the elements of all rows."""
        # Most columns repeat a few words.
        words = {text: text.decode(errors="replace") for text in set(self._texts[index])}
        return [words[text] for text in self._texts[index]]

    def lengths(self, index: int) -> NDArray[np.int64]:
        """Return (count,) lengths of the array at an index, one for each row."""
        return np.array(self._lengths[index], dtype=np.int64)

    def numbers(self, index: int, part: NumberArray) -> Array:
        """Return the numbers of all rows of the array at an index."""
        return np.frombuffer(self._runs[index], dtype=DTYPES[part.kind])

    def blobs(self, index: int) -> list[bytes]:
        """Return the bytes of each row of the array at an index."""
        ends = np.cumsum(self.lengths(index)).tolist()
        whole = bytes(self._runs[index])
        return [whole[start:end] for start, end in pairwise([0, *ends])]

    def items(self) -> Iterator[tuple[int, MessageArray, "GatheredRows"]]:
        """Yield each array of messages: index among the parts, layout, rows."""
        for index, part in enumerate(self.record.parts):
            if isinstance(part, MessageArray):
                yield index, part, self._inner_of[id(part)]


class _Cuts:
    """Fields of messages of equal length; each is a slice of the table that has one message per row.

    Attributes:
        rows: number of rows that each message gives.
        pieces: for each part of the layout, the slices with the bytes of this part. There is one slice for each row
            that a message gives, or for each string of an array.
        lengths: for each part, the lengths of the arrays in a message.
        inner: fields of its arrays of messages, in the order of the layout.
    """

    def __init__(self, gathered: GatheredRows) -> None:
        self.rows = 0
        self.pieces: list[list[Octets]] = [[] for _ in gathered.record.parts]
        self.lengths: list[list[int]] = [[] for _ in gathered.record.parts]
        self.inner = tuple(_Cuts(rows) for rows in gathered.inner)
        self._parts = gathered.record.parts
        self._only_run = gathered.only_run

    def cut(self, table: Octets, at: int) -> int:
        """Cut one row from all messages, starting at a column of the table. Return the column after it."""
        inner = iter(self.inner)
        for index, part in enumerate(self._parts):
            match part:
                case FixedBlock():
                    at = self._piece(index, table, at, part.dtype.itemsize)
                case StringField():
                    at = self._piece(index, table, at + 4, _same_count(table, at))
                case NumberArray():
                    count = _same_count(table, at)
                    at = self._piece(index, table, at + 4, count * np.dtype(DTYPES[part.kind]).itemsize)
                    self.lengths[index].append(count)
                case StringArray() | MessageArray():
                    count, at = (_same_count(table, at), at + 4) if part.count is None else (part.count, at)
                    if count > table.shape[1]:
                        raise _Unlike
                    self.lengths[index].append(count)
                    if isinstance(part, MessageArray):
                        at = next(inner).cut_many(table, at, count)
                        continue
                    for _ in range(count):
                        at = self._piece(index, table, at + 4, _same_count(table, at))
        self.rows += 1
        return at

    def cut_many(self, table: Octets, at: int, count: int) -> int:
        """Cut `count` rows from all messages, like `cut`."""
        if self._only_run is not None:
            self.rows += count
            return self._piece(0, table, at, count * self._only_run.dtype.itemsize)
        for _ in range(count):
            at = self.cut(table, at)
        return at

    def _piece(self, index: int, table: Octets, at: int, size: int) -> int:
        if at + size > table.shape[1]:
            raise _Unlike
        self.pieces[index].append(table[:, at : at + size])
        return at + size


def _same_count(table: Octets, at: int) -> int:
    """Return the length or count at column `at` of the table; it must be the same in all messages."""
    counts = table[:, at : at + _COUNT.size]
    if at + _COUNT.size > table.shape[1] or (counts != counts[0]).any():
        raise _Unlike
    (count,) = _COUNT.unpack(counts[0].tobytes())
    return int(count)


def _beside(pieces: Sequence[Octets], messages: int) -> Octets:
    return np.concatenate(pieces, axis=1) if pieces else np.empty((messages, 0), dtype=np.uint8)


def _texts_of(piece: Octets) -> list[bytes]:
    """Return the rows of a slice as bytes; equal rows are one object."""
    if (piece == piece[0]).all():
        return [piece[0].tobytes()] * len(piece)
    whole, size = piece.tobytes(), piece.shape[1]
    return [whole[at : at + size] for at in range(0, len(whole), size)]


def _count(data: bytes, at: int) -> tuple[int, int]:
    if at + _COUNT.size > len(data):
        raise ValueError(_TOO_SHORT)
    return _COUNT.unpack_from(data, at)[0], at + _COUNT.size


def _text(data: bytes, at: int) -> tuple[bytes, int]:
    length, at = _count(data, at)
    if at + length > len(data):
        raise ValueError(_TOO_SHORT)
    return data[at : at + length], at + length


def _sane(count: int, data: bytes, at: int, smallest: int) -> int:
    """Return the count if the message is long enough to contain it. A broken message may have any count."""
    if count * max(smallest, 1) > len(data) - at:
        raise ValueError(_TOO_SHORT)
    return count

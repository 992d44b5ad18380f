"""Buffers that collect messages field by field, before they are converted to columns."""

from collections.abc import Iterator
from itertools import pairwise
from struct import Struct

import numpy as np
from numpy.typing import NDArray

from thbridge.analysis.export.layout import (
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


class GatheredRows:
    """The rows of one message type that were gathered and are not converted yet.

    Attributes:
        record: the layout of a row.
        count: number of rows gathered.
        inner: the rows of its arrays of messages, in the order of the layout.
    """

    def __init__(self, record: MessageLayout) -> None:
        self.record = record
        self.inner = tuple(GatheredRows(items.record) for items in record.items())
        self._inner_of = dict(zip(map(id, record.items()), self.inner, strict=True))
        self._only_run = record.parts[0] if len(record.parts) == 1 and isinstance(record.parts[0], FixedBlock) else None
        self.clear()

    def clear(self) -> None:
        """Drop all rows."""
        self.count = 0
        self._own_size = 0
        self._runs: list[bytearray] = [bytearray() for _ in self.record.parts]
        self._texts: list[list[bytes]] = [[] for _ in self.record.parts]
        self._lengths: list[list[int]] = [[] for _ in self.record.parts]
        for rows in self.inner:
            rows.clear()

    @property
    def size(self) -> int:
        """Bytes gathered, with those of the inner rows."""
        return self._own_size + sum(rows.size for rows in self.inner)

    def add(self, data: bytes) -> None:
        """Append one message.

        Raises:
            ValueError: the bytes are not a message of the type; nothing of them is kept.
        """
        before = self.count
        try:
            end = self._read(data, 0)
            if end != len(data):
                raise ValueError(f"the message goes on for {len(data) - end} bytes after its end")
        except ValueError:
            self._truncate(before)
            raise

    def _read(self, data: bytes, at: int) -> int:
        """Append the record that begins at a byte. Return the offset behind it."""
        start = at
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
        self._own_size += at - start
        return at

    def _read_many(self, count: int, data: bytes, at: int) -> int:
        # Elements of one fixed block (points, poses) are copied all at once: large arrays are mostly of this kind.
        run = self._only_run
        if run is None:
            for _ in range(_sane(count, data, at, 1 if self.record.parts else 0)):
                at = self._read(data, at)
            return at
        end = at + count * run.dtype.itemsize
        if end > len(data):
            raise ValueError(_TOO_SHORT)
        self._runs[0] += data[at:end]
        self.count += count
        self._own_size += end - at
        return end

    def _truncate(self, rows: int) -> None:
        """Keep only the first rows, without the rest of a broken message."""
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
        """(count,) structures of the part at an index."""
        return np.frombuffer(self._runs[index], dtype=run.dtype)

    def texts(self, index: int) -> list[str]:
        """Strings of the part at an index: one a row, or, of an array, the elements of all rows."""
        return [text.decode(errors="replace") for text in self._texts[index]]

    def lengths(self, index: int) -> NDArray[np.int64]:
        """(count,) length in each row of the array at an index."""
        return np.array(self._lengths[index], dtype=np.int64)

    def numbers(self, index: int, part: NumberArray) -> Array:
        """Numbers of all rows of the array at an index."""
        return np.frombuffer(self._runs[index], dtype=DTYPES[part.kind])

    def blobs(self, index: int) -> list[bytes]:
        """Bytes of each row of the array at an index."""
        ends = np.cumsum(self.lengths(index)).tolist()
        whole = bytes(self._runs[index])
        return [whole[start:end] for start, end in pairwise([0, *ends])]

    def items(self) -> Iterator[tuple[int, MessageArray, "GatheredRows"]]:
        """Yield each array of messages: index among the parts, layout, rows."""
        for index, part in enumerate(self.record.parts):
            if isinstance(part, MessageArray):
                yield index, part, self._inner_of[id(part)]


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
    """The count, if the message is long enough for so many elements: broken messages have counts of billions."""
    if count * max(smallest, 1) > len(data) - at:
        raise ValueError(_TOO_SHORT)
    return count

"""Table files for pandas, R and similar programs: Parquet and CSV, written piece by piece."""

import base64
from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import chain
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import compute, csv, ipc, parquet

from thbridge.files.disk.inside import path_inside
from thbridge.files.disk.spool import SpoolFile
from thbridge.files.progress import Tell
from thbridge.files.tables.csv_cells import text_cells

Array: TypeAlias = "np.ndarray[tuple[int, ...], np.dtype[np.generic[object]]]"


_ELEMENTS = {pa.list_(pa.string()): ".list.element"}
"""Path of the elements in columns of lists of words."""
_PAGE_BYTES = 1 << 18
"""Size of a page in bytes: a quarter of the usual size, because every open file keeps a page of each column in
memory."""
_ELEMENTS_AT_ONCE = 1 << 17
"""Maximum number of list elements in a row group, because every open file needs 10 bytes per element."""


class TableFormat(StrEnum):
    """File format of a table."""

    CSV = "csv"
    PARQUET = "parquet"


@dataclass(frozen=True, slots=True)
class Column:
    """Description of a table's column.

    Attributes:
        name: name, unique in its table.
        kind: type of the values: "float64", "string", "float32[]", "bytes", ...
        unit: unit such as "m", or "" if there is none or it is unknown.
        meaning: a phrase for people, or "" if it is unknown.
        frame_column: name of the column with the frame of the values, in this table or its parent table; or "".
    """

    name: str
    kind: str
    unit: str = ""
    meaning: str = ""
    frame_column: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class ListColumn:
    """Values of a column of arrays: the length of each array, and the elements of all arrays, concatenated."""

    lengths: NDArray[np.int64]
    elements: "Array | list[str]"


@dataclass(frozen=True, slots=True, eq=False)
class OptionalColumn:
    """Values of a column of numbers or booleans with missing values.

    Attributes:
        values: all values. A missing value is replaced by an arbitrary value.
        known: False for missing values.
    """

    values: Array
    known: NDArray[np.bool_]


Values: TypeAlias = "Array | list[str] | list[str | None] | list[bytes] | ListColumn | OptionalColumn"


class TableFiles:
    """Table files NAME.csv and NAME.parquet of a folder; only one is open at a time.

    Until it is finished, a Parquet file needs about a kilobyte of memory for each column of each row group. So pieces
    wait on disk, in the same folder, and files are written one after the other. Equal pieces give equal bytes.

    Args:
        folder: an existing folder.
        formats: the formats to write.
    """

    def __init__(self, folder: Path, formats: Collection[TableFormat]) -> None:
        # Arrow's own allocator keeps memory that files have freed.
        pa.set_memory_pool(pa.system_memory_pool())
        self._folder = folder
        self._formats = formats
        self._begun: set[str] = set()
        self._spool = SpoolFile(folder)
        self._waiting: defaultdict[str, list[tuple[int, int]]] = defaultdict(list)

    def write(self, name: str, columns: Sequence[Column], values: Sequence[Values]) -> None:
        """Append rows.

        Args:
            name: name of the table.
            columns: the same columns in each call; Parquet files have their units as metadata of fields.
            values: values of the columns, in their order.

        Raises:
            BadFile: the name is not a valid name of a file.
            OSError: the disk is full or has another fault.
        """
        table = arrow_table(columns, values)
        if TableFormat.PARQUET in self._formats:
            self._waiting[name].append(self._spool.put(_packed(table)))
        if TableFormat.CSV in self._formats:
            cells = [_cells(column.combine_chunks()) for column in table.columns]
            plain = pa.Table.from_arrays(cells, names=table.column_names)
            options = csv.WriteOptions(
                include_header=name not in self._begun, quoting_style="needed", quoting_header="needed"
            )
            self._begun.add(name)
            with path_inside(self._folder, f"{name}.csv").open("ab") as file:
                csv.write_csv(plain, file, options)

    def finish(self, tell: Tell) -> None:
        """Finish every file.

        Args:
            `tell`: receives the progress.

        Raises:
            OSError: the disk is full or has another fault.
        """
        done, total = 0, sum(map(len, self._waiting.values()))  # of integers
        for name, extents in self._waiting.items():
            pieces = (_unpacked(self._spool.get(*extent)) for extent in extents)
            for _ in _write_parquet(path_inside(self._folder, f"{name}.parquet"), pieces):
                done += 1
                tell("pieces of tables", done, total)


def _write_parquet(path: Path, pieces: Iterator[pa.Table]) -> Iterator[None]:
    """Write a file, yielding after each piece."""
    first = next(pieces)
    # Dictionary encoding of numbers would need most of the time and memory, and make files larger.
    words = [f"{each.name}{_ELEMENTS.get(each.type, '')}" for each in first.schema if _has_words(each.type)]
    with parquet.ParquetWriter(
        path, first.schema, compression="zstd", use_dictionary=words, data_page_size=_PAGE_BYTES
    ) as writer:
        for table in chain((first,), pieces):
            if table.num_rows:
                lists = (column.chunk(0) for column in table.columns if pa.types.is_list(column.type))
                most = max((len(each.values) for each in lists), default=0)
                rows = max(1, table.num_rows * _ELEMENTS_AT_ONCE // max(most, _ELEMENTS_AT_ONCE))
                writer.write_table(table, row_group_size=rows)
            yield


def _packed(table: pa.Table) -> memoryview:
    sink = pa.BufferOutputStream()
    # Arrow's threads would have their own heaps, which do not return memory.
    options = ipc.IpcWriteOptions(compression="lz4", use_threads=False)
    with ipc.new_stream(sink, table.schema, options=options) as stream:
        stream.write_table(table)
    return memoryview(sink.getvalue())


def _unpacked(data: bytes) -> pa.Table:
    return ipc.open_stream(data, options=ipc.IpcReadOptions(use_threads=False)).read_all()


def arrow_table(columns: Sequence[Column], values: Sequence[Values]) -> pa.Table:
    """Return rows as an Arrow table; units are metadata of its fields."""
    arrays = [_array(column.kind, each) for column, each in zip(columns, values, strict=True)]
    fields = [
        pa.field(column.name, array.type, metadata={"unit": column.unit} if column.unit else None)
        for column, array in zip(columns, arrays, strict=True)
    ]
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields))


def _has_words(kind: pa.DataType) -> bool:
    return pa.types.is_string(kind) or kind in _ELEMENTS


def _array(kind: str, values: Values) -> pa.Array:
    if isinstance(values, np.ndarray):
        return _of_numbers(values)
    if isinstance(values, OptionalColumn):
        return _of_numbers(values.values, values.known)
    if isinstance(values, list):
        return _of_words(values, pa.binary() if kind == "bytes" else pa.string())
    offsets = np.concatenate(([0], np.cumsum(values.lengths))).astype(np.int32)
    if isinstance(values.elements, list):
        return pa.ListArray.from_arrays(_of_numbers(offsets), _of_words(values.elements, pa.string()))
    return pa.ListArray.from_arrays(_of_numbers(offsets), _of_numbers(values.elements))


# Arrays are built from buffers in memory, because `pyarrow.array` imports pandas if it is installed, which takes half a
# second and 90 MB.


def _of_numbers(values: Array, known: NDArray[np.bool_] | None = None) -> pa.Array:
    kept: Array = np.ascontiguousarray(values)
    if values.dtype == np.bool_:
        kept = np.packbits(values.astype(np.bool_), bitorder="little")
    valid = None if known is None or known.all() else pa.py_buffer(np.packbits(known, bitorder="little"))
    return pa.Array.from_buffers(pa.from_numpy_dtype(values.dtype), len(values), [valid, pa.py_buffer(kept)])


def _of_words(words: list[str] | list[str | None] | list[bytes], kind: pa.DataType) -> pa.Array:
    # JSON of other programs may contain half of a surrogate pair.
    pieces = [word.encode(errors="replace") if isinstance(word, str) else word or b"" for word in words]
    ends = np.cumsum([0, *map(len, pieces)], dtype=np.int32)
    known = None
    if None in words:
        known = pa.py_buffer(np.packbits([word is not None for word in words], bitorder="little"))
    return pa.Array.from_buffers(kind, len(words), [known, pa.py_buffer(ends), pa.py_buffer(b"".join(pieces))])


def _cells(array: pa.Array) -> pa.Array:
    """Return values that can be written as CSV: arrays as their elements separated by blanks, bytes as base64."""
    if pa.types.is_list(array.type):
        texts = pa.ListArray.from_arrays(array.offsets, compute.cast(array.values, pa.string()))
        joined = compute.binary_join(texts, _of_words([" "], pa.string())[0])
        return text_cells(joined) if pa.types.is_string(array.type.value_type) else joined
    if pa.types.is_binary(array.type):
        return _of_words([base64.b64encode(each).decode() for each in array.to_pylist()], pa.string())
    return text_cells(array) if pa.types.is_string(array.type) else array

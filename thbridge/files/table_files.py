"""Table files for pandas, R and the like: Parquet and CSV, written piece by piece."""

import base64
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import compute, csv, parquet

Array: TypeAlias = "np.ndarray[tuple[int, ...], np.dtype[np.generic[object]]]"


_ELEMENTS = {pa.list_(pa.string()): ".list.element"}
"""Path of the elements in columns of lists of words."""
_PAGE_BYTES = 1 << 18
"""A quarter of the usual size: every open file holds a page of each column."""
_ELEMENTS_AT_ONCE = 1 << 17
"""Elements of a column of lists in a row group: every open file keeps some 10 bytes for each."""


class TableFormat(StrEnum):
    """File format of a table."""

    CSV = "csv"
    PARQUET = "parquet"


@dataclass(frozen=True, slots=True)
class Column:
    """The description of a table's column.

    Attributes:
        name: unique in its table.
        kind: type of its values: "float64", "string", "float32[]", "bytes", ...
        unit: "m", or "" where it has none or it is unknown.
        meaning: a phrase for people; "" where it is unknown.
        frame_column: name of the column, of this table or of its parent table, with the frame of the values; or "".
    """

    name: str
    kind: str
    unit: str = ""
    meaning: str = ""
    frame_column: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class ListColumn:
    """The values of a column of arrays: the length of each, and the elements of all of them, concatenated."""

    lengths: NDArray[np.int64]
    elements: "Array | list[str]"


Values: TypeAlias = "Array | list[str] | list[str | None] | list[bytes] | ListColumn"


class TableFiles:
    """Table files NAME.csv and NAME.parquet of a folder, which stay open until all are closed.

    The same pieces give the same bytes.

    Args:
        folder: an existing folder.
        formats: the formats to write.
    """

    def __init__(self, folder: Path, formats: Collection[TableFormat]) -> None:
        # Arrow's own allocator keeps what files gave back.
        pa.set_memory_pool(pa.system_memory_pool())
        self._folder = folder
        self._formats = formats
        self._csv: dict[str, csv.CSVWriter] = {}
        self._parquet: dict[str, parquet.ParquetWriter] = {}

    def write(self, name: str, columns: Sequence[Column], values: Sequence[Values]) -> None:
        """Append rows.

        Args:
            name: name of the table.
            columns: the same columns in each call; Parquet files have their units as metadata of fields.
            values: values of the columns, in their order.

        Raises:
            OSError: the disk is full, or the like.
        """
        table = arrow_table(columns, values)
        if TableFormat.PARQUET in self._formats:
            if name not in self._parquet:
                # Dictionaries of numbers take most of the time and memory, and make files larger.
                words = [f"{each.name}{_ELEMENTS.get(each.type, '')}" for each in table.schema if _has_words(each.type)]
                self._parquet[name] = parquet.ParquetWriter(
                    self._folder / f"{name}.parquet",
                    table.schema,
                    compression="zstd",
                    use_dictionary=words,
                    data_page_size=_PAGE_BYTES,
                )
            if table.num_rows:
                lists = (column.chunk(0) for column in table.columns if pa.types.is_list(column.type))
                most = max((len(each.values) for each in lists), default=0)
                rows = max(1, table.num_rows * _ELEMENTS_AT_ONCE // max(most, _ELEMENTS_AT_ONCE))
                self._parquet[name].write_table(table, row_group_size=rows)
        if TableFormat.CSV in self._formats:
            cells = [_cells(column.combine_chunks()) for column in table.columns]
            plain = pa.Table.from_arrays(cells, names=table.column_names)
            if name not in self._csv:
                options = csv.WriteOptions(quoting_style="needed", quoting_header="needed")
                self._csv[name] = csv.CSVWriter(self._folder / f"{name}.csv", plain.schema, write_options=options)
            self._csv[name].write_table(plain)

    def close(self) -> None:
        """Finish every file. Raises OSError: the disk is full, or the like."""
        for writer in (*self._csv.values(), *self._parquet.values()):
            writer.close()


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
        return pa.array(values)
    if isinstance(values, list):
        # The type is given explicitly, because an empty list has none.
        return pa.array(values, type=pa.binary() if kind == "bytes" else pa.string())
    offsets = np.concatenate(([0], np.cumsum(values.lengths))).astype(np.int32)
    elements = pa.array(values.elements, type=pa.string() if isinstance(values.elements, list) else None)
    return pa.ListArray.from_arrays(pa.array(offsets), elements)


def _cells(array: pa.Array) -> pa.Array:
    """Values that can be written as CSV: arrays as their elements with blanks between, bytes as base64."""
    if pa.types.is_list(array.type):
        texts = pa.ListArray.from_arrays(array.offsets, compute.cast(array.values, pa.string()))
        return compute.binary_join(texts, " ")
    if pa.types.is_binary(array.type):
        return pa.array([base64.b64encode(each).decode() for each in array.to_pylist()], type=pa.string())
    return array

"""Table of all games of a sweep, for pandas, R, DuckDB and figures."""

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
from pyarrow import compute, csv, parquet

from thbridge.batch.chunks import GameChunk
from thbridge.batch.folder import SweepFolder, read_manifest
from thbridge.batch.results import read_table
from thbridge.files.disk.whole import whole_file
from thbridge.files.errors import BadFile
from thbridge.files.tables.csv_cells import text_cells
from thbridge.files.tables.table_files import TableFormat

VARYING = ("worker", "cpu_seconds")
"""Columns that differ between runs."""


def collect(root: Path) -> pa.Table:
    """Return all played games, sorted by condition and seed.

    The column `verified` is true for a repetition with the same result, false for a repetition with another result,
    and null without a repetition.

    Raises:
        BadFile: the folder has no sweep, no game has been played, or a file cannot be read.
    """
    folder, manifest = read_manifest(root)
    tables = [table for chunk in manifest.chunks if (table := _games(folder, chunk)) is not None]
    if not tables:
        raise BadFile(root, "no games have been played yet", "run `thbridge sweep` first")
    try:
        whole = pa.concat_tables(tables)
    except pa.ArrowException as error:
        remedy = "delete the files of the other design or release, and run the sweep again"
        raise BadFile(root / "games", f"the files here have different columns ({error})", remedy) from None
    return whole.sort_by([("condition", "ascending"), ("seed", "ascending")]).combine_chunks()


def _games(folder: SweepFolder, chunk: GameChunk) -> pa.Table | None:
    path = folder.games(chunk)
    if not path.exists():
        return None
    table = read_table(path).replace_schema_metadata(None)
    equal: dict[int, bool] = {}
    if folder.verified(chunk).exists():
        equal = {row["seed"]: row["equal"] for row in read_table(folder.verified(chunk), ["seed", "equal"]).to_pylist()}
    verified = pa.array([equal.get(seed) for seed in table["seed"].to_pylist()], pa.bool_())
    condition = pa.array([chunk.condition] * table.num_rows, pa.int64())
    return table.add_column(0, "condition", condition).append_column("verified", verified)


def write_collected(table: pa.Table, path: Path, kind: TableFormat) -> None:
    """Write a table. CSV files have blanks between the values of a list, and no measures of single robots or seats.

    Raises:
        BadFile: the file cannot be written.
    """
    with whole_file(path, folders=True) as file:
        if kind is TableFormat.PARQUET:
            parquet.write_table(table, file, compression="zstd")
        else:
            csv.write_csv(_plain(table), file)


def _plain(table: pa.Table) -> pa.Table:
    columns: dict[str, pa.ChunkedArray] = {}
    for name in table.column_names:
        column = table[name]
        if not pa.types.is_list(column.type):
            columns[name] = text_cells(column) if pa.types.is_string(column.type) else column
        elif pa.types.is_string(column.type.value_type):
            columns[name] = text_cells(compute.binary_join(column, " "))
    return pa.table(columns)


def numbers_of(table: pa.Table, names: Sequence[str]) -> Sequence[str]:
    """Return the named columns of a table that contain numbers."""
    return [name for name in names if name in table.column_names and _is_number(table.schema.field(name).type)]


def _is_number(kind: pa.DataType) -> bool:
    return bool(pa.types.is_integer(kind) or pa.types.is_floating(kind))

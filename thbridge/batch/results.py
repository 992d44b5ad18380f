"""Results of games in Parquet files, one file per chunk. DuckDB, pandas and Arrow can read all files as one table."""

import dataclasses
import hashlib
import io
import json
import re
import types
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import cast, get_args, get_origin, get_type_hints

import pyarrow as pa
from pyarrow import parquet

from thbridge.app.compose.machine import versions
from thbridge.batch.measures import MEASURES, GameMeasures
from thbridge.files.disk.regular_files import content_of
from thbridge.files.disk.whole import whole_file
from thbridge.files.errors import BadFile

MOST_GAMES, LARGEST_TABLE = 1_000_000, 1 << 30
"""Limits for reading a chunk: number of games, and number of decompressed bytes. A small file can have many of them."""

VERSIONS = "thbridge.versions"
"""Metadata key for the versions of the programs that played a file's games, as JSON."""
_SUM = "thbridge.sum"
"""Metadata key for the file's SHA-256. It is computed with `_NO_SUM` as the value. Older files do not have this key."""
_NO_SUM = 64 * "-"
_WITH_SUM = re.compile(rb"thbridge\.sum[^0-9a-f]{1,8}([0-9a-f]{64})")


class GameStatus(StrEnum):
    """State of a game in the results."""

    ENDED = "ended"
    OUT_OF_TIME = "out of time"
    FAILED = "failed"
    """An exception ended the game; see `GameResult.fault`."""
    CRASHED = "crashed"
    """Two workers died while they played the game."""


@dataclass(frozen=True, slots=True)
class GameResult:
    """The result of one game.

    Attributes:
        seed: random seed of the game.
        status: state of the game.
        fault: the error that ended the game, or None.
        messages: digest of the session's messages (`thbridge bag info --hash`), or None if no messages were created.
        bag: path of the game's recording, relative to the sweep's folder, or None.
        worker: host and process that played the game.
        cpu_seconds: processor time of the game, s.
        measures: measures of the game, or None if it has no result.
    """

    seed: int
    status: GameStatus
    fault: str | None = None
    messages: str | None = None
    bag: str | None = None
    worker: str = ""
    cpu_seconds: float = 0.0
    measures: GameMeasures | None = None


@dataclass(frozen=True, slots=True)
class Verification:
    """Comparison of a game with its repetition.

    Attributes:
        seed: random seed of the game.
        first: digest of the messages of the first game.
        again: digest of the messages of the repetition.
        first_worker: host and process of the first game.
        again_worker: host and process of the repetition.
    """

    seed: int
    first: str | None
    again: str | None
    first_worker: str
    again_worker: str

    @property
    def equal(self) -> bool:
        """True if the game and its repetition have the same messages."""
        return self.first == self.again


Level = str | float | int | None
"""Level of a factor in the results, or None if a condition does not have the factor."""


@dataclass(frozen=True, slots=True)
class FactorColumns:
    """Columns of the factors.

    Attributes:
        kinds: type of each factor's levels: int64, double or string.
        levels: level of each factor, by condition.
    """

    kinds: Mapping[str, str]
    levels: Mapping[int, Mapping[str, Level]]

    @classmethod
    def of(cls, factors: Sequence[str], written: Mapping[int, Mapping[str, str]]) -> "FactorColumns":
        """Return the columns for levels that are given as texts. A column has numbers if all its levels are numbers."""
        kinds = {factor: _kind([each[factor] for each in written.values() if factor in each]) for factor in factors}
        readers: Mapping[str, Callable[[str], Level]] = {"int64": int, "double": float, "string": str}
        levels: dict[int, Mapping[str, Level]] = {
            number: {factor: readers[kinds[factor]](each[factor]) if factor in each else None for factor in factors}
            for number, each in written.items()
        }
        return cls(kinds, levels)


def _kind(labels: Sequence[str]) -> str:
    if all(_WHOLE.fullmatch(label) for label in labels):
        return "int64"
    return "double" if all(_NUMBER.fullmatch(label) for label in labels) else "string"


_WHOLE = re.compile(r"[-+]?\d{1,18}")
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d{1,3})?")


OWN_COLUMNS = (
    "condition",
    *(field.name for field in dataclasses.fields(GameResult) if field.name != "measures"),
    *MEASURES,
    "verified",
)
"""Columns that are not factors."""


def write_games(
    path: Path,
    games: Sequence[GameResult],
    condition: int,
    factors: FactorColumns,
    measures: Collection[str],
    plugins: Iterable[str] = (),
) -> None:
    """Write the games of a chunk with the named measures.

    Args:
        path: path of the file.
        games: games of the chunk.
        condition: number of the condition.
        factors: columns of the factors.
        measures: names of the measures to write.
        plugins: keys of the plug-ins that the sweep's studies name.

    Raises:
        BadFile: the file cannot be written.
    """
    columns: dict[str, pa.Array] = {"seed": pa.array([game.seed for game in games], pa.int64())}
    for factor, kind in factors.kinds.items():
        columns[factor] = pa.array([factors.levels[condition][factor]] * len(games), pa.type_for_alias(kind))
    columns |= _columns(games, GameResult, {"status", "fault"})
    columns |= _columns([game.measures for game in games], GameMeasures, measures)
    columns |= _columns(games, GameResult, {"messages", "bag", "worker", "cpu_seconds"})
    _write(path, columns, plugins)


def write_verified(path: Path, games: Sequence[Verification], plugins: Iterable[str] = ()) -> None:
    """Write the comparisons of a chunk's repeated games; see `write_games`."""
    named = {field.name for field in dataclasses.fields(Verification)}
    equal = {"equal": pa.array([game.equal for game in games], pa.bool_())}
    _write(path, _columns(games, Verification, named) | equal, plugins)


def _write(path: Path, columns: Mapping[str, pa.Array], plugins: Iterable[str]) -> None:
    table = pa.table(columns).replace_schema_metadata({VERSIONS: json.dumps(versions(plugins)), _SUM: _NO_SUM})
    written = io.BytesIO()
    parquet.write_table(table, written, compression="zstd")
    content = written.getvalue()
    with whole_file(path, "free some space, then run the command again", folders=True) as file:
        file.write(content.replace(_NO_SUM.encode(), hashlib.sha256(content).hexdigest().encode()))


def _columns(rows: Sequence[object], of: type, names: Collection[str]) -> dict[str, pa.Array]:
    """Return the named fields of objects as columns. An object that is None gives missing values."""
    hints = cast(Mapping[str, object], get_type_hints(of))
    return {
        name: pa.array([None if row is None else _plain(getattr(row, name)) for row in rows], _arrow(hint))
        for name, hint in hints.items()
        if name in names
    }


def _plain(value: object) -> object:
    """Return a value in a form that Arrow accepts."""
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return dataclasses.asdict(value) if dataclasses.is_dataclass(value) and not isinstance(value, type) else value


def _arrow(hint: object) -> pa.DataType:
    """Return the column type of a field's type."""
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is types.UnionType:
        return _arrow(next(each for each in arguments if each is not types.NoneType))
    if origin is tuple:
        return pa.list_(_arrow(arguments[0]))
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        inner = cast(Mapping[str, object], get_type_hints(hint))
        return pa.struct([pa.field(name, _arrow(each)) for name, each in inner.items()])
    if isinstance(hint, type) and issubclass(hint, str):
        return pa.string()
    return {int: pa.int64(), float: pa.float64(), bool: pa.bool_()}[cast(type, hint)]


def read_digests(path: Path) -> Mapping[int, tuple[str | None, str]]:
    """Return the message digest and the worker of each game of a chunk, by seed. Raises BadFile."""
    table = read_table(path, ["seed", "messages", "worker"])
    return {row["seed"]: (row["messages"], row["worker"]) for row in table.to_pylist()}


def game_faults(path: Path, condition: int) -> list[str]:
    """Return a sentence for each game without a result in a chunk. Raises BadFile."""
    return [
        f"condition {condition}, seed {row['seed']}: {row['fault']}"
        for row in read_table(path, ["seed", "fault"]).to_pylist()
        if row["fault"] is not None
    ]


def differing_games(path: Path, condition: int) -> list[str]:
    """Return a sentence for each game of a chunk with another result in its repetition. Raises BadFile."""
    return [
        f"condition {condition}, seed {row['seed']}: the repetition gave another result (first played by "
        f"{row['first_worker']}, repeated by {row['again_worker']})"
        for row in read_table(path).to_pylist()
        if not row["equal"]
    ]


def versions_in(path: Path) -> str:
    """Return the versions of the programs that wrote a chunk, as JSON. Raises BadFile."""
    metadata = read_table(path, ["seed"]).schema.metadata or {}
    return str(metadata.get(VERSIONS.encode(), b"{}"), errors="replace")


def read_table(path: Path, columns: Sequence[str] | None = None) -> pa.Table:
    """Read columns of a chunk's file. Raises BadFile for a file that is damaged, too large, or of another program."""
    remedy = "delete this file and run the sweep again: it repeats the games"
    try:
        content = content_of(path, LARGEST_TABLE)
        if _is_damaged(content):
            raise BadFile(path, "the file is damaged: its checksum is wrong", remedy)
        # Read the file itself: for a path, Arrow would add a column from the folder's name.
        file = parquet.ParquetFile(pa.BufferReader(content))
        groups = range(file.num_row_groups)
        unpacked = sum(file.metadata.row_group(number).total_byte_size for number in groups)  # of integers
        if file.metadata.num_rows > MOST_GAMES or unpacked > LARGEST_TABLE:
            problem = f"{file.metadata.num_rows} games with {unpacked} decompressed bytes are too many for a chunk"
            raise BadFile(path, problem, remedy)
        table = file.read(columns)
    except (OSError, pa.ArrowException, UnicodeDecodeError) as error:
        raise BadFile(path, f"the file cannot be read ({error})", remedy) from None
    known, always = _known_columns()
    for field in table.schema:
        if (kind := known.get(field.name)) is not None and field.type != kind:
            raise BadFile(path, f"its column {field.name} has the type {field.type} instead of {kind}", remedy)
        if field.name in always and table[field.name].null_count:
            raise BadFile(path, f"its column {field.name} has missing values", remedy)
    if (missing := next((name for name in columns or () if name not in table.column_names), None)) is not None:
        raise BadFile(path, f"the file has no column {missing}", remedy)
    return table


@cache
def _known_columns() -> tuple[Mapping[str, pa.DataType], frozenset[str]]:
    """Return the required types of columns, and the columns that must have a value in each row."""
    hints = {**get_type_hints(GameResult), **get_type_hints(Verification), "equal": bool}
    hints.pop("measures")
    always = frozenset(name for name, hint in hints.items() if get_origin(hint) is not types.UnionType)
    return {name: _arrow(hint) for name, hint in hints.items()}, always


def _is_damaged(content: bytes) -> bool:
    """Return True if a file was changed after writing. Parquet itself detects only some changes."""
    found = _WITH_SUM.search(content)
    if found is None:
        return False
    begin, end = found.span(1)
    return hashlib.sha256(content[:begin] + _NO_SUM.encode() + content[end:]).hexdigest().encode() != found[1]

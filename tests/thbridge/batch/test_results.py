"""Files of results: what was damaged is refused, since a further run can play it again, and what is too large."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from tests.support.disks.damaged_files import SOME_BITS, cuts, flips
from thbridge.batch.results import MOST_GAMES, VERSIONS, Verification, read_table, write_verified
from thbridge.files.errors import BadFile

GAMES = [Verification(seed, f"{seed:064x}", f"{seed:064x}", "a:1", "b:2") for seed in range(1, 4)]


@pytest.fixture
def written(tmp_path: Path) -> Path:
    write_verified(tmp_path / "chunk-1.parquet", GAMES)
    return tmp_path / "chunk-1.parquet"


@pytest.mark.parametrize("stride", [11, pytest.param(1, marks=pytest.mark.slow)], ids=["quick", "each"])
def test_a_changed_byte_or_a_cut_is_refused_or_changes_nothing(written: Path, stride: int) -> None:
    content, rows = written.read_bytes(), read_table(written).to_pylist()
    assert [row["seed"] for row in rows] == [1, 2, 3]
    refused = 0
    for what, damaged in (*flips(content, SOME_BITS, stride), *cuts(content, stride)):
        written.write_bytes(damaged)
        try:
            assert read_table(written).to_pylist() == rows, what
        except BadFile:
            refused += 1
    assert refused > 100


def test_a_file_of_before_checksums_is_read(written: Path) -> None:
    table = parquet.read_table(written)
    parquet.write_table(table.replace_schema_metadata({VERSIONS: "{}"}), written)
    assert read_table(written).to_pylist() == table.to_pylist()


def test_a_file_of_kilobytes_that_stands_for_millions_of_games_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "chunk-1.parquet"
    rows = np.zeros(5 * MOST_GAMES, dtype=np.int64)
    parquet.write_table(pa.table({"seed": rows}), path, compression="zstd")
    assert path.stat().st_size < 100_000
    with pytest.raises(BadFile, match="5000000 games with"):
        read_table(path)


def test_a_file_whose_texts_unpack_to_more_than_they_may_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "chunk-1.parquet"
    parquet.write_table(pa.table({"fault": ["a" * 10_000] * 3}), path, compression="zstd", use_dictionary=False)
    assert read_table(path).num_rows == 3
    monkeypatch.setattr("thbridge.batch.results.LARGEST_TABLE", 20_000)
    with pytest.raises(BadFile, match="3 games with 300"):
        read_table(path)

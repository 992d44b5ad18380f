"""Results of others are read within bounds."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from thbridge.batch.results import MOST_GAMES, read_table
from thbridge.files.errors import BadFile


def test_a_file_of_kilobytes_that_stands_for_millions_of_games_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "chunk-1.parquet"
    rows = np.zeros(5 * MOST_GAMES, dtype=np.int64)
    parquet.write_table(pa.table({"seed": rows}), path, compression="zstd")
    assert path.stat().st_size < 100_000
    with pytest.raises(BadFile, match="5000000 games that unpack to"):
        read_table(path)


def test_a_file_whose_texts_unpack_to_more_than_they_may_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "chunk-1.parquet"
    parquet.write_table(pa.table({"fault": ["a" * 10_000] * 3}), path, compression="zstd", use_dictionary=False)
    assert read_table(path).num_rows == 3
    monkeypatch.setattr("thbridge.batch.results.LARGEST_TABLE", 20_000)
    with pytest.raises(BadFile, match="3 games that unpack to 300"):
        read_table(path)

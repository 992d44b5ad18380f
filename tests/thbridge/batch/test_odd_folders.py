"""Folders of sweeps with odd contents are refused in words."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path

import pyarrow as pa
import pytest
from pyarrow import parquet

from thbridge.batch.folder import read_manifest
from thbridge.batch.status import status_of
from thbridge.batch.tables import collect
from thbridge.files.errors import BadFile

GOOD: Mapping[str, object] = {
    "layout": 1,
    "versions": {"thbridge": "0.1.0"},
    "design": {
        "factors": ["robots"],
        "levels": {"1": {"robots": "1"}, "2": {"robots": "2"}},
        "seeds": [1, 2, 3],
        "measures": ["score"],
        "one_verified_in": 0,
        "chunk": 2,
    },
}


def of_design(**keys: object) -> str:
    return json.dumps({**GOOD, "design": {**GOOD["design"], **keys}})  # type: ignore[dict-item]


def of_file(**keys: object) -> str:
    return json.dumps({**GOOD, **keys})


ODD = {
    "a list": "[]",
    "no text": "",
    "deep": "[" * 100_000,
    "not a number": of_design(chunk=1).replace('"chunk": 1', '"chunk": NaN'),
    "no design": of_file(design=None),
    "a design that is a list": of_file(design=[]),
    "no versions": json.dumps({"layout": 1, "design": GOOD["design"]}),
    "versions that are numbers": of_file(versions={"thbridge": 1}),
    "levels that are a list": of_design(levels=[]),
    "a condition without a number": of_design(levels={"one": {}}),
    "conditions with a gap": of_design(levels={"1": {}, "3": {}}),
    "a condition before the first": of_design(levels={"-1": {}}),
    "a level that is a number": of_design(levels={"1": {"robots": 1}}),
    "factors that are a word": of_design(factors="robots"),
    "a seed as text": of_design(seeds=["one"]),
    "a seed beyond 64 bits": of_design(seeds=[2**70]),
    "a chunk of no games": of_design(chunk=0),
    "a chunk that is true": of_design(chunk=True),
    "verify before none": of_design(one_verified_in=-1),
    "a lone surrogate": of_design(factors=["robots"]).replace('"robots": "1"', '"robots": "\\ud800"'),
    "measures that are numbers": of_design(measures=[1]),
}


@pytest.mark.parametrize("name", ODD)
@pytest.mark.parametrize("read", [read_manifest, status_of, collect])
def test_an_odd_manifest_is_refused(tmp_path: Path, name: str, read: Callable[[Path], object]) -> None:
    (tmp_path / "sweep.json").write_text(ODD[name])
    with pytest.raises(BadFile, match=r"sweep\.json"):
        read(tmp_path)


def test_a_manifest_as_it_should_be_is_read(tmp_path: Path) -> None:
    (tmp_path / "sweep.json").write_text(json.dumps(GOOD))
    assert read_manifest(tmp_path)[1].games == 6


TABLES: Mapping[str, Mapping[str, pa.Array]] = {
    "no columns that are known": {"a": pa.array([1])},
    "seeds as text": {"seed": pa.array(["1"]), "status": pa.array(["ended"]), "cpu_seconds": pa.array([1.0])},
    "no processor time": {
        "seed": pa.array([1]),
        "status": pa.array(["ended"]),
        "cpu_seconds": pa.array([None], pa.float64()),
        "fault": pa.array([None], pa.string()),
    },
}


@pytest.mark.parametrize("name", TABLES)
def test_an_odd_table_of_games_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / "sweep.json").write_text(json.dumps(GOOD))
    (tmp_path / "games" / "condition=1").mkdir(parents=True)
    parquet.write_table(pa.table(TABLES[name]), tmp_path / "games" / "condition=1" / "chunk-1.parquet")
    with pytest.raises(BadFile, match="chunk-1"):
        status_of(tmp_path)

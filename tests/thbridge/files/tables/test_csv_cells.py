import csv
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.batch.tables import write_collected
from thbridge.files.tables.csv_cells import FORMULA, text_cell, text_cells
from thbridge.files.tables.table_files import Column, ListColumn, TableFiles, TableFormat

FORMULAS = ["=1+1", "+a", "-a", "@sum", '=HYPERLINK("http://x")', "\t=1", "\r=1", "'=1", "-1.5 a", "- no", "-"]
PLAIN = ["", "a", "a=b", "-1.5", "+1", "-.5", "1e-3", "-1e+3", "'a'", "Räume", "' ="]


@pytest.mark.parametrize("text", FORMULAS)
def test_what_a_spreadsheet_takes_for_a_formula_becomes_a_text(text: str) -> None:
    assert text_cell(text) == f"'{text}"


@pytest.mark.parametrize("text", PLAIN)
def test_numbers_and_other_texts_stay(text: str) -> None:
    assert text_cell(text) == text


@given(st.lists(st.none() | st.text(st.sampled_from("=+-@'\t\r1.eEa \n"))))
def test_cells_of_arrays_are_the_same_and_give_their_texts_back(texts: list[str | None]) -> None:
    cells = text_cells(pa.array(texts, pa.string())).to_pylist()
    assert cells == [None if text is None else text_cell(text) for text in texts]
    # The way back, as the documents have it.
    back = [None if cell is None else re.sub(r"^'('*[=+\-@\t\r])", r"\1", cell) for cell in cells]
    assert back == texts
    assert not any(
        cell is not None and re.match(FORMULA, cell) and cell[0] != "'" and not _number(cell) for cell in cells
    )


def _number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def test_tables_have_numbers_as_numbers_and_formulas_as_texts(tmp_path: Path) -> None:
    columns = [Column("text", "string"), Column("x", "float64"), Column("words", "string[]"), Column("xs", "float64[]")]
    words = ListColumn(np.array([1, 0]), ["=1"])
    numbers = ListColumn(np.array([2, 1]), np.array([-1.5, 2.0, -3.0]))
    files = TableFiles(tmp_path, list(TableFormat))
    files.write("t", columns, (["=1+1", "-2"], np.array([-1.5, 2.0]), words, numbers))
    files.finish(lambda *_: None)
    with (tmp_path / "t.csv").open(newline="") as file:
        assert list(csv.reader(file))[1:] == [["'=1+1", "-1.5", "'=1", "-1.5 2"], ["-2", "2", "", "-3"]]
    assert pd.read_csv(tmp_path / "t.csv").x.tolist() == [-1.5, 2.0]
    assert pd.read_parquet(tmp_path / "t.parquet").text.tolist() == ["=1+1", "-2"]


def test_tables_of_sweeps_have_them_so_too(tmp_path: Path) -> None:
    table = pa.table({"name": ["=1"], "x": [-1.5], "words": [["+a", "b"]]})
    write_collected(table, tmp_path / "t.csv", TableFormat.CSV)
    with (tmp_path / "t.csv").open(newline="") as file:
        assert list(csv.reader(file)) == [["name", "x", "words"], ["'=1", "-1.5", "'+a b"]]

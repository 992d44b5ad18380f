"""CSV files of numbers with a header, written by people or other programs."""

import csv
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sim.numerics.float_array import FloatArray
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, BadFiles

LARGEST_TABLE = 1 << 26
"""Largest size of a file, bytes. This is about a million rows."""
MOST_FAULTS = 10
"""Maximum number of faults to report, because a wrong table may have a fault in every row."""


def read_columns(path: Path, columns: Sequence[str]) -> FloatArray:
    """Return the rows of a CSV file with exactly these columns in its header, in any order; empty lines are skipped.

    Spreadsheets separate values by semicolons or tabs if the decimal mark is a comma. In these files, the decimal mark
    may be a comma or a point.

    Returns:
        (rows, columns) finite numbers, with columns in the requested order; at least one row.

    Raises:
        BadFile: the file cannot be read, has another header, or has faults; the first faults are raised as BadFiles.
    """
    wanted = ",".join(columns)
    text = read_text(path, LARGEST_TABLE)
    lines = text.splitlines()
    first = next((line for line in lines if line.strip()), "")
    if first.startswith("sep="):  # a line for Excel, which names the separator
        lines[lines.index(first)] = ""
        first = next((line for line in lines if line.strip()), "")
    mark = next((mark for mark in ";\t" if mark in first), ",")
    reader = csv.reader(lines, delimiter=mark, strict=True)
    header: list[str] = []
    rows: list[list[float]] = []
    faults: list[BadFile] = []
    try:
        for cells in reader:
            if not any(cell.strip() for cell in cells):
                continue
            if not header:
                header = [cell.strip() for cell in cells]
                if sorted(header) != sorted(columns):
                    problem = f"the header is {','.join(header)!r}"
                    raise BadFile(path, problem, f"write {wanted} in the first line", line=reader.line_num)
                continue
            row = _numbers(path, reader.line_num, header, [cell.replace(",", ".") for cell in cells])
            if isinstance(row, BadFile):
                faults.append(row)
            else:
                rows.append(row)
            if len(faults) == MOST_FAULTS:
                break
    except csv.Error as error:
        raise BadFile(path, f"not CSV: {error}", "write numbers separated by commas", line=reader.line_num) from None
    if faults:
        raise BadFiles(tuple(faults))
    if not rows:
        remedy = f"write {wanted} in the first line and a row of numbers in each line after it"
        raise BadFile(path, "the table has no rows of numbers", remedy)
    return np.array(rows)[:, [header.index(column) for column in columns]]


def _numbers(path: Path, line: int, header: Sequence[str], cells: Sequence[str]) -> list[float] | BadFile:
    if len(cells) != len(header):
        problem = f"{len(cells)} values, but the header has {len(header)} names"
        return BadFile(
            path, problem, f"write {len(header)} numbers, with the same separators as in the header", line=line
        )
    numbers = []
    for column, cell in zip(header, cells, strict=True):
        try:
            number = float(cell)
        except ValueError:
            return BadFile(
                path, f"{cell.strip()!r} is not a number", "write a number, such as 1.5", line=line, key=column
            )
        if not math.isfinite(number):
            return BadFile(
                path, f"{cell.strip()} is not a finite number", "write a number, such as 1.5", line=line, key=column
            )
        numbers.append(number)
    return numbers

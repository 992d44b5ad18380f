"""mapTimes files: the travel costs of 2016."""

import math
from collections.abc import Sequence
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.template_lines import count_in, first_line, numbered_lines
from thbridge.hunt.costs import NOT_A_MOVE, CostMatrix

MAP_TIMES = "mapTimes"


def read_map_times(path: Path) -> CostMatrix:
    """Read a travel cost matrix: the number of nodes, then one row of costs per node; 99 means an impossible move.

    Costs are whole or decimal numbers and may be above 99; see `CostMatrix.of_map_times`.

    Raises:
        BadFile: the file cannot be read or has a fault.
    """
    lines = numbered_lines(path)
    number, first = first_line(path, lines, "number of nodes", "the number of nodes, the corridor and the rooms")
    nodes = count_in(path, number, "number of nodes", first, least=2)
    rows = lines[1:]
    if len(rows) != nodes:
        raise BadFile(
            path,
            f"{nodes} nodes need {nodes} rows, but the file has {len(rows)}",
            "add or delete rows, or correct the first line",
            line=rows[nodes][0] if len(rows) > nodes else number,
            key="number of nodes",
        )
    return CostMatrix.of_map_times(tuple(_cost_row(path, number, row, nodes) for number, row in rows))


def map_times(seconds: Sequence[Sequence[float | None]]) -> str:
    """Return the text of a travel cost matrix in whole seconds, because the programs of 2016 read only whole numbers.

    Args:
        seconds: `seconds[start][goal]`, square, the corridor first; None means that a move is impossible. A trip of 99
            s is written as 98, because 99 means that a move is impossible in this format.
    """
    rows = [" ".join(_cost_word(cost) for cost in row) for row in seconds]
    return "\n".join([str(len(rows)), *rows]) + "\n"


def _cost_word(seconds: float | None) -> str:
    if seconds is None:
        return "99"
    whole = round(seconds)
    return str(98 if whole == NOT_A_MOVE else whole)


def _cost_row(path: Path, number: int, line: str, nodes: int) -> tuple[float, ...]:
    words = line.split()
    if len(words) != nodes:
        raise BadFile(
            path,
            f"{len(words)} costs in a row that needs {nodes}",
            "give one cost for every node, and 99 for a move that is impossible",
            line=number,
        )
    return tuple(_cost(path, number, column, word) for column, word in enumerate(words))


def _cost(path: Path, number: int, column: int, word: str) -> float:
    try:
        cost = float(word)
    except ValueError:
        cost = math.nan
    if not (math.isfinite(cost) and cost >= 0.0):
        raise BadFile(
            path,
            f"{word!r} is not a cost",
            "write a number that is not negative, or 99 for a move that is impossible",
            line=number,
            key=f"column {column + 1}",
        )
    return cost

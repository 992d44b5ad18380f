"""Rows of a log."""

from ui.windows.researcher.docks.log import LogRow


def rows(first: int, count: int) -> list[LogRow]:
    return [LogRow(float(n), (f"who {n}", f"sentence {n % 7}"), n % 3) for n in range(first, first + count)]

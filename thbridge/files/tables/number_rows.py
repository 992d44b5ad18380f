"""Rows of numbers over time, of which a temporary file holds all but the latest."""

from array import array
from collections.abc import Iterable

import numpy as np

from sim.numerics.float_array import FloatArray
from thbridge.files.disk.spool import SpoolFile

RECENT = 8192
"""Numbers of one series in memory, at most: more go to the file. Short recordings never need it."""


class NumberRows:
    """One series: rows of numbers, appended one after the other.

    Args:
        spool: where they go; many series share it.
    """

    def __init__(self, spool: SpoolFile) -> None:
        self._spool = spool
        self._extents: list[tuple[int, int]] = []
        self._recent = array("d")
        self._count = 0

    def __len__(self) -> int:
        """Number of numbers."""
        return self._count

    def extend(self, numbers: Iterable[float]) -> None:
        """Append a row, or several."""
        before = len(self._recent)
        self._recent.extend(numbers)
        self._grown(before)

    def frombytes(self, data: bytes) -> None:
        """Append rows that are doubles in memory."""
        before = len(self._recent)
        self._recent.frombytes(data)
        self._grown(before)

    def _grown(self, before: int) -> None:
        self._count += len(self._recent) - before
        if len(self._recent) > RECENT:
            data = self._recent.tobytes()
            self._extents.append(self._spool.put(data))
            self._recent = array("d")

    def table(self, columns: int) -> FloatArray:
        """(n, columns) table of all rows; n may be 0."""
        data = bytearray().join(self._spool.get(*extent) for extent in self._extents)
        data += self._recent.tobytes()
        return np.frombuffer(data, dtype=np.float64).reshape(-1, columns)

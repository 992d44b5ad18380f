"""Rows of numbers over time, kept in a temporary file except for the most recent rows."""

from array import array
from collections.abc import Iterable

import numpy as np

from sim.numerics.float_array import FloatArray
from thbridge.files.disk.spool import SpoolFile

RECENT = 8192
"""Maximum number of values of one series in memory; more go to the file. Short recordings never need the file."""


class NumberRows:
    """One series: rows of numbers, appended one after the other.

    Args:
        spool: file for older rows, which many series share.
    """

    def __init__(self, spool: SpoolFile) -> None:
        self._spool = spool
        self._extents: list[tuple[int, int]] = []
        self._recent = array("d")
        self._count = 0

    def __len__(self) -> int:
        """Return the number of values."""
        return self._count

    def extend(self, numbers: Iterable[float]) -> None:
        """Append one or several rows."""
        before = len(self._recent)
        self._recent.extend(numbers)
        self._grown(before)

    def frombytes(self, data: bytes) -> None:
        """Append rows of doubles from memory."""
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
        """Return all rows as an (n, columns) table; n may be 0."""
        data = bytearray().join(self._spool.get(*extent) for extent in self._extents)
        data += self._recent.tobytes()
        return np.frombuffer(data, dtype=np.float64).reshape(-1, columns)

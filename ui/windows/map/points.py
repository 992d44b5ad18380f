"""Conversion of arrays to Qt's polygons and lines, without a Python object for every point of a polygon."""

import ctypes

import numpy as np
from PySide6.QtCore import QLineF
from PySide6.QtGui import QPolygonF
from shiboken6 import Shiboken

from sim.numerics.float_array import FloatArray


def polygon(points: FloatArray) -> QPolygonF:
    """A Qt polygon of (n, 2) points."""
    made = QPolygonF()
    made.resize(len(points))
    if len(points):
        (address,) = Shiboken.getCppPointer(made.data())
        memory = (ctypes.c_double * (2 * len(points))).from_address(address)
        np.ctypeslib.as_array(memory).reshape(-1, 2)[:] = points
    return made


def pieces(points: FloatArray) -> list[FloatArray]:
    """Parts of a line of (n, 2) points between rows of NaN."""
    gaps = np.flatnonzero(np.isnan(points[:, 0]))
    return [part for part in np.split(points, np.sort(np.concatenate((gaps, gaps + 1)))) if not np.isnan(part).any()]


def lines(starts: FloatArray, ends: FloatArray) -> list[QLineF]:
    """Lines from each of (n, 2) points to the one of the same index in another (n, 2)."""
    return [QLineF(*ends_of) for ends_of in np.concatenate((starts, ends), axis=1).tolist()]

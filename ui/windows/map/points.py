"""Conversion of arrays to Qt's polygons and lines, without a Python object for every point."""

from typing import cast

import numpy as np
from pyqtgraph.functions import arrayToQPolygonF
from PySide6.QtCore import QLineF, QPointF
from PySide6.QtGui import QPainter, QPolygonF, QTransform
from shiboken6 import Shiboken

from sim.numerics.float_array import FloatArray


def mapped(transform: QTransform, points: FloatArray) -> FloatArray:
    """Return (n, 2) points mapped by a transform that only scales and shifts; further columns are ignored."""
    moved: FloatArray = points[:, :2] * (transform.m11(), transform.m22()) + (transform.dx(), transform.dy())
    return moved


def pixel(transform: QTransform, x: float, y: float) -> QPointF:
    """Return the pixel of a map point."""
    return transform.map(QPointF(x, y))


def polygon(points: FloatArray) -> QPolygonF:
    """Return a Qt polygon of (n, 2) points."""
    made: QPolygonF = arrayToQPolygonF(points[:, 0], points[:, 1])
    return made


def pieces(points: FloatArray) -> list[FloatArray]:
    """Return the pieces of a line of (n, 2) points; rows of NaN separate the pieces."""
    gaps = np.flatnonzero(np.isnan(points[:, 0]))
    return [part for part in np.split(points, np.sort(np.concatenate((gaps, gaps + 1)))) if not np.isnan(part).any()]


def steps(points: FloatArray) -> FloatArray:
    """Return (m, 4) lines between neighbors in a sequence of (n, 2) points; no line begins or ends at a row of NaN."""
    lines: FloatArray = np.concatenate((points[:-1], points[1:]), axis=1)
    return lines[~np.isnan(lines).any(axis=1)]


def draw_lines(painter: QPainter, lines: FloatArray) -> None:
    """Draw (n, 4) lines, each given by x and y of its two ends."""
    if len(lines):
        memory = np.ascontiguousarray(lines)
        first = cast(QLineF, Shiboken.wrapInstance(memory.ctypes.data, QLineF))
        painter.drawLines(first, len(memory))

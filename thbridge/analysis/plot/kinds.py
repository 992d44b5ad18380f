"""Kinds of figures, in a separate module for commands that do not import a plotting library."""

from enum import StrEnum


class FigureKind(StrEnum):
    """Kind of a figure."""

    PATHS = "paths"
    ERROR = "error"
    COVARIANCE = "covariance"
    ENERGY = "energy"
    VELOCITY = "velocity"
    TIMELINE = "timeline"

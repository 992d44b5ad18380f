"""Kinds of figures; a module of its own, for commands that offer them and load no plotting library."""

from enum import StrEnum


class FigureKind(StrEnum):
    """Kinds of figures."""

    PATHS = "paths"
    ERROR = "error"
    COVARIANCE = "covariance"
    ENERGY = "energy"
    VELOCITY = "velocity"
    TIMELINE = "timeline"

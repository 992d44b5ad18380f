"""Bands around curves; a module of its own, for commands that offer them and load no plotting library."""

from enum import StrEnum


class BandKind(StrEnum):
    """Ways to a confidence interval of a mean: Student's t, or percentiles of a bootstrap."""

    T = "t"
    BOOTSTRAP = "bootstrap"

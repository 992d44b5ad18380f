"""Bands around curves; a separate module, so that commands can offer them without loading a plotting library."""

from enum import StrEnum


class BandKind(StrEnum):
    """Method for the confidence interval of a mean: Student's t, or percentiles of a bootstrap."""

    T = "t"
    BOOTSTRAP = "bootstrap"

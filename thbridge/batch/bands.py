"""Kinds of confidence bands. In this separate module, commands can use them without loading a plotting library."""

from enum import StrEnum


class BandKind(StrEnum):
    """Method for the confidence interval of a mean: Student's t, or the percentiles of a bootstrap."""

    T = "t"
    BOOTSTRAP = "bootstrap"

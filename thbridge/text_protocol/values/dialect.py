"""Dialects of the text protocol."""

from enum import StrEnum


class Dialect(StrEnum):
    """Meaning of ``%%goto`` that is tried first."""

    LEGACY_2016 = "legacy-2016"
    CANONICAL = "canonical"

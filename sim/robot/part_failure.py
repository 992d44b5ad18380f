"""Failure of an installed part of a robot's software."""


class PartFailed(Exception):  # noqa: N818 - it is a sentence about a part of others, not an error here
    """Failure of an installed part. The text is a clause about the cause."""

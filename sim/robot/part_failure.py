"""Failure of an installed part of a robot's software."""


class PartFailed(Exception):  # noqa: N818 - it is a sentence about a part of others, not an error here
    """A part failed. The text is a clause about the cause."""

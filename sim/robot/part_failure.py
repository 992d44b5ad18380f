"""Failure of a part of a robot's software that does not come with the simulator."""


class PartFailed(Exception):  # noqa: N818 - it is a sentence about a part of others, not an error here
    """A part failed; the text is a clause that says how."""

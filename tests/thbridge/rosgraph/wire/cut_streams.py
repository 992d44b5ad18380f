"""Byte streams as a network might deliver them."""

from itertools import pairwise

from hypothesis import strategies as st

places = st.lists(st.integers(min_value=0), max_size=20)
"""Where a stream is cut."""


def cut(data: bytes, places: list[int]) -> list[bytes]:
    """The data in segments."""
    bounds = sorted({0, len(data), *(place % (len(data) + 1) for place in places)})
    return [data[begin:end] for begin, end in pairwise(bounds)]

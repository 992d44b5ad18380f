"""Bookmarked times in a recording, and loops between two bookmarks."""

from bisect import bisect_right
from collections.abc import Iterable
from itertools import pairwise

NEAR = 0.05
"""Maximum difference in seconds between a time and a bookmark that count as equal."""


class Bookmarks:
    """Bookmarks of a recording.

    Args:
        times: times of the bookmarks, seconds since the beginning of the recording.

    Attributes:
        times: times of the bookmarks in ascending order, seconds.
    """

    def __init__(self, times: Iterable[float] = ()) -> None:
        self.times = tuple(sorted(times))

    def toggle(self, time: float) -> bool:
        """Set a bookmark, or remove the bookmark at this time; return True if there is now a bookmark."""
        others = [each for each in self.times if abs(each - time) > NEAR]
        is_new = len(others) == len(self.times)
        self.times = tuple(sorted([*others, time])) if is_new else tuple(others)
        return is_new

    def around(self, time: float) -> tuple[float, float] | None:
        """Return the bookmarks before and after a time, or else the two nearest bookmarks.

        Return None if there are fewer than two bookmarks.
        """
        spans = list(pairwise(self.times))
        return spans[min(max(bisect_right(self.times, time) - 1, 0), len(spans) - 1)] if spans else None


def clock(seconds: float) -> str:
    """Return minutes and seconds, for example "12:03.40"."""
    minutes, rest = divmod(round(max(0.0, seconds) * 100.0), 6000)
    return f"{minutes}:{rest / 100.0:05.2f}"


def parse_clock(text: str) -> float | None:
    """Return the seconds in a typed time such as "83.4", "1:23.4" or "0:01:23"; None if the text is not a time."""
    parts = text.strip().replace(",", ".").split(":")
    if len(parts) > 3 or not all(part.isdecimal() for part in parts[:-1]):
        return None
    whole, point, fraction = parts[-1].partition(".")
    if not (whole + fraction).isdecimal() or (point and not whole and not fraction):
        return None
    seconds = 0.0
    for part in parts:
        seconds = 60.0 * seconds + float(part)
    return seconds

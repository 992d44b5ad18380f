"""Repetitions that a recording leaves out: costmaps that have not changed."""

from collections.abc import Iterable

from thbridge.ros.messages import types
from thbridge.ros.topics import RosMessage, Topic

REPEAT_NS = 10_000_000_000
"""Time after which an unchanged costmap is recorded again: whoever plays a recording from its middle on waits no longer
for one."""

_STAMP = 12
"""Bytes of a header's seq and stamp."""
_LOAD_TIME = 8


class RepetitionFilter:
    """Leaves out of messages those costmaps that equal the last recorded one of their topic.

    Stamps do not count. What is left out can be told from the one before, or had by a replay.
    """

    def __init__(self) -> None:
        self._recorded: dict[Topic, tuple[int, bytes]] = {}

    def __call__(self, messages: Iterable[RosMessage]) -> list[RosMessage]:
        """Return the messages that are to be recorded; they come in order of time."""
        return [each for each in messages if each.topic.msgtype != types.OCCUPANCY_GRID or self._is_new(each)]

    def _is_new(self, costmap: RosMessage) -> bool:
        topic, stamp_ns, content = costmap.topic, costmap.stamp_ns, _unstamped(costmap.data)
        if topic in self._recorded:
            last_ns, last = self._recorded[topic]
            if content == last and stamp_ns - last_ns < REPEAT_NS:
                return False
        self._recorded[topic] = stamp_ns, content
        return True


def _unstamped(grid: bytes) -> bytes:
    """A nav_msgs/OccupancyGrid without its header's seq and stamp, and without the time when the map was loaded."""
    frame_end = _STAMP + 4 + int.from_bytes(grid[_STAMP : _STAMP + 4], "little")
    return grid[_STAMP:frame_end] + grid[frame_end + _LOAD_TIME :]

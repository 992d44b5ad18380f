"""Repetitions that a recording omits. These are costmaps that have not changed."""

from collections.abc import Iterable

from thbridge.ros.messages import types
from thbridge.ros.topics import RosMessage, Topic

REPEAT_NS = 10_000_000_000
"""An unchanged costmap is recorded again after this time. If a recording is played from its middle, a player gets each
costmap within this time."""

_STAMP = 12
"""Number of bytes of a header's seq and stamp."""
_LOAD_TIME = 8


class RepetitionFilter:
    """Filter that removes a costmap if it is equal to the last recorded costmap of its topic.

    The comparison ignores time stamps. A replay can restore a removed costmap from the equal costmap before it.
    """

    def __init__(self) -> None:
        self._recorded: dict[Topic, tuple[int, bytes]] = {}

    def __call__(self, messages: Iterable[RosMessage]) -> list[RosMessage]:
        """Return the messages that must be recorded. The given messages must be in the order of time."""
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
    """Return a nav_msgs/OccupancyGrid without seq and stamp of its header, and without its map load time."""
    frame_end = _STAMP + 4 + int.from_bytes(grid[_STAMP : _STAMP + 4], "little")
    return grid[_STAMP:frame_end] + grid[frame_end + _LOAD_TIME :]

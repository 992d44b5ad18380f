"""ROS time as a program needs it that drives robots: it goes on, and never back."""

CLOCK_TIMEOUT_NS = 2_000_000_000
"""A simulated clock that stands for longer is not waited for: whoever has died cannot stop the time of the others."""
SET_BACK_NS = 1_000_000_000
"""A clock that goes back by more was set, or its program started anew; by less, it is waited for."""


class RosClock:
    """The time of a graph.

    Args:
        simulated: whether time is what `/clock` says; else it is that of the wall.
    """

    def __init__(self, simulated: bool) -> None:
        self._simulated = simulated
        self._shift_ns = 0
        self._last_ns = 0
        self._said: tuple[int, int] | None = None

    @property
    def runs(self) -> bool:
        """Whether the time is known."""
        return not self._simulated or self._said is not None

    def receive(self, ros_ns: int, wall_ns: int) -> None:
        """Word of `/clock`."""
        self._said = ros_ns, wall_ns

    def now(self, wall_ns: int) -> int:
        """Nanoseconds of ROS time when the wall clock shows this; from 1 ns on, for 0 means no time to ROS."""
        source_ns = wall_ns
        if self._simulated and self._said is not None:
            ros_ns, heard_ns = self._said
            source_ns = ros_ns + max(0, wall_ns - heard_ns - CLOCK_TIMEOUT_NS)
        if self._last_ns - (source_ns + self._shift_ns) > SET_BACK_NS:
            self._shift_ns = self._last_ns - source_ns
        self._last_ns = max(self._last_ns, source_ns + self._shift_ns, 1)
        return self._last_ns

"""ROS time that never stands still and never goes back, for programs that drive robots."""

CLOCK_TIMEOUT_NS = 2_000_000_000
"""After this time without a message on /clock, ROS time goes on with the wall clock: a simulator that died must not
stop the time of the other robots."""
SET_BACK_NS = 1_000_000_000
"""A clock that goes back by more than this was set, or its program restarted; if it goes back by less, time waits."""


class RosClock:
    """The time of a graph.

    Args:
        simulated: True when time comes from `/clock`, False when it is wall time.
    """

    def __init__(self, simulated: bool) -> None:
        self._simulated = simulated
        self._shift_ns = 0
        self._last_ns = 0
        self._last_clock: tuple[int, int] | None = None

    @property
    def runs(self) -> bool:
        """True when the time is known."""
        return not self._simulated or self._last_clock is not None

    def receive(self, ros_ns: int, wall_ns: int) -> None:
        """Take in a message of `/clock` that came at a wall time."""
        self._last_clock = ros_ns, wall_ns

    def stands(self, wall_ns: int) -> bool:
        """Return True when `/clock`, once heard, says nothing any more, so that time goes on with the wall clock."""
        return self._last_clock is not None and wall_ns - self._last_clock[1] > CLOCK_TIMEOUT_NS

    def now(self, wall_ns: int) -> int:
        """Nanoseconds of ROS time at a wall time; at least 1 ns, because 0 means "no time" in ROS."""
        source_ns = wall_ns
        if self._simulated and self._last_clock is not None:
            ros_ns, received_ns = self._last_clock
            source_ns = ros_ns + max(0, wall_ns - received_ns - CLOCK_TIMEOUT_NS)
        # Where the source was set back for good, a shift keeps our time at its last value and lets it go on from there.
        if self._last_ns - (source_ns + self._shift_ns) > SET_BACK_NS:
            self._shift_ns = self._last_ns - source_ns
        self._last_ns = max(self._last_ns, source_ns + self._shift_ns, 1)
        return self._last_ns

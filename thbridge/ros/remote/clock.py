"""ROS time for programs that drive robots. It never stops and never goes back."""

CLOCK_TIMEOUT_NS = 2_000_000_000
"""After this time without a message on /clock, ROS time continues with the wall clock.

A simulator that has crashed must not stop the time of the other robots.
"""
SET_BACK_NS = 1_000_000_000
"""If a clock goes back by more than this, it was set, or its program was restarted. If it goes back by less, our time
stops until the clock reaches it again."""


class RosClock:
    """Time of a ROS graph.

    Args:
        simulated: True if the time comes from `/clock`. False if it is wall time.
    """

    def __init__(self, simulated: bool) -> None:
        self._simulated = simulated
        self._shift_ns = 0
        self._last_ns = 0
        self._last_clock: tuple[int, int] | None = None

    @property
    def runs(self) -> bool:
        """True if the time is known."""
        return not self._simulated or self._last_clock is not None

    def receive(self, ros_ns: int, wall_ns: int) -> None:
        """Process a message of `/clock` with the wall time of its arrival."""
        self._last_clock = ros_ns, wall_ns

    def stands(self, wall_ns: int) -> bool:
        """Return True if `/clock` is silent after earlier messages. Then time continues with the wall clock."""
        return self._last_clock is not None and wall_ns - self._last_clock[1] > CLOCK_TIMEOUT_NS

    def now(self, wall_ns: int) -> int:
        """Return the ROS time at a wall time, in nanoseconds. It is at least 1 ns, because 0 means "no time" in ROS."""
        source_ns = wall_ns
        if self._simulated and self._last_clock is not None:
            ros_ns, received_ns = self._last_clock
            source_ns = ros_ns + max(0, wall_ns - received_ns - CLOCK_TIMEOUT_NS)
        # If the source was set back for good, a shift lets our time continue from its last value.
        if self._last_ns - (source_ns + self._shift_ns) > SET_BACK_NS:
            self._shift_ns = self._last_ns - source_ns
        self._last_ns = max(self._last_ns, source_ns + self._shift_ns, 1)
        return self._last_ns

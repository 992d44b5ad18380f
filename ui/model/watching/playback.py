"""Position in a recording that is played, paused or searched."""


class Playback:
    """Position in a recording, which moves with time.

    The argument `now` of all methods is the present time in seconds; it never decreases.

    Args:
        start_ns: the first position, nanoseconds of ROS time.
        end_ns: the last position, nanoseconds of ROS time; playback stops there.

    Attributes:
        at_ns: the position, nanoseconds of ROS time.
        speed: recorded seconds per second during playback.
        playing: True while the position moves.
        loop: first and last position of a loop. If None, the recording is played to the end.
    """

    def __init__(self, start_ns: int, end_ns: int) -> None:
        self._start_ns, self._end_ns = start_ns, end_ns
        self.at_ns = start_ns
        self.speed = 1.0
        self.loop: tuple[int, int] | None = None
        self._since: float | None = None
        self.playing = False

    def advance(self, now: float) -> int:
        """Move the position to this time, and return it."""
        if self.playing and self._since is not None:
            at_ns = self.at_ns + round((now - self._since) * self.speed * 1e9)
            if self.loop is not None and at_ns >= self.loop[1]:
                start, end = self.loop
                at_ns = start + (at_ns - end) % max(end - start, 1)
            self.at_ns = self._within(at_ns)
            self.playing = self.at_ns < self._end_ns
        self._since = now
        return self.at_ns

    def play(self, now: float, on: bool = True) -> None:
        """Play from the present position, or, at the end, from the beginning. If `on` is False, pause."""
        self.advance(now)
        if on and self.at_ns >= self._end_ns:
            self.at_ns = self._start_ns
        self.playing = on and self._end_ns > self._start_ns

    def set_speed(self, now: float, speed: float) -> None:
        """Continue at another speed, greater than 0."""
        self.advance(now)
        self.speed = speed

    def seek(self, at_ns: int) -> None:
        """Move the position to a moment; a running playback continues from there."""
        self.at_ns = self._within(at_ns)

    def _within(self, at_ns: int) -> int:
        return min(max(at_ns, self._start_ns), self._end_ns)

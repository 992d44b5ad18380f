"""Position in a recording, while it plays, stands or is searched."""


class Playback:
    """A position that moves as time goes on; its methods take the time, in seconds that never go back.

    Args:
        start_ns: the first position.
        end_ns: the last one; playing stops there.

    Attributes:
        playing: True while it moves.
    """

    def __init__(self, start_ns: int, end_ns: int) -> None:
        self._start_ns, self._end_ns = start_ns, end_ns
        self._at_ns = start_ns
        self._since: float | None = None
        self._speed = 1.0
        self.playing = False

    @property
    def at_ns(self) -> int:
        """The position, nanoseconds of ROS time."""
        return self._at_ns

    @property
    def speed(self) -> float:
        """Recorded seconds per second while it plays."""
        return self._speed

    def advance(self, now: float) -> int:
        """Move to the position reached by now, and return it."""
        if self.playing and self._since is not None:
            self._at_ns = self._within(self._at_ns + round((now - self._since) * self._speed * 1e9))
            self.playing = self._at_ns < self._end_ns
        self._since = now
        return self._at_ns

    def play(self, now: float, on: bool = True) -> None:
        """Play from here, from the beginning where the end is reached; or stand still."""
        self.advance(now)
        if on and self._at_ns >= self._end_ns:
            self._at_ns = self._start_ns
        self.playing = on and self._end_ns > self._start_ns

    def set_speed(self, now: float, speed: float) -> None:
        """Go on at another speed, greater than 0."""
        self.advance(now)
        self._speed = speed

    def seek(self, at_ns: int) -> None:
        """Go to a moment; what plays goes on from there."""
        self._at_ns = self._within(at_ns)

    def _within(self, at_ns: int) -> int:
        return min(max(at_ns, self._start_ns), self._end_ns)

"""Recording as a feed. A thread opens the recording; the window reads it in pieces, and plays it at any speed."""

import gc
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from sim.common.grid import OccupancyGrid
from thbridge.analysis.cut import CutRange, cut
from thbridge.files.errors import BadFile
from ui.model.watching.playback import Playback
from ui.model.watching.scene import Scene, ShownLayers
from ui.model.watching.series import Series
from ui.model.watching.session_log import SessionLog
from ui.model.watching.tools import RECORDED
from ui.sources.bag import BagSource, open_bag
from ui.windows.researcher.feeds.feed import FeedData, FeedRequest

READ_SLICE = 0.008
"""Maximum number of seconds of reading before the window handles other events."""


class BagOpener:
    """Thread that opens a recording.

    Attributes:
        share: completed part of the work, 0 to 1.
        source: the recording after it was opened; otherwise None.
        fault: the reason why the recording cannot be opened; None if there is none.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.share = 0.0
        self.source: BagSource | None = None
        self.fault: BadFile | None = None
        self._given_up = False
        self._thread = threading.Thread(target=self._open, name="open bag", daemon=True)
        self._thread.start()

    def wait(self, seconds: float) -> bool:
        """Wait at most this number of seconds. Return True if the attempt to open the recording has ended."""
        self._thread.join(seconds)
        return not self._thread.is_alive()

    def give_up(self) -> None:
        """Stop opening."""
        self._given_up = True

    def _open(self) -> None:
        try:
            self.source = self._opened()
        except BadFile as fault:
            self.fault = fault

    def _opened(self) -> BagSource | None:
        work = open_bag(self.path)
        # Check for `give_up` between the steps, so that the thread ends soon after this call.
        while not self._given_up:
            try:
                self.share = next(work)
            except StopIteration as done:
                source: BagSource = done.value
                # Prepare the first frame in this thread, because this work would block the window's thread.
                source.scene(source.start_ns, ShownLayers())
                return source
        return None


def _keep_for_good() -> None:
    """Exempt all present objects from garbage collection, because it would block the window for 0.1 s or longer."""
    gc.freeze()


class RecordingTransport:
    """Time shown of a recording; see `FeedTransport`."""

    def __init__(self) -> None:
        self.playback = Playback(0, 0)
        self.span = 0.0
        self._source: BagSource | None = None
        self._start_ns = 0
        self._now = 0.0

    def begin(self, source: BagSource) -> None:
        """Go to the beginning of a recording."""
        self.playback = Playback(source.start_ns, source.end_ns)
        self.span = (source.end_ns - source.start_ns) / 1e9
        self._source, self._start_ns = source, source.start_ns

    def advance(self, now: float) -> None:
        """Advance the time shown, if it is playing."""
        self._now = now
        self.playback.advance(now)

    @property
    def time(self) -> float:
        """Time shown."""
        return (self.playback.at_ns - self._start_ns) / 1e9

    @property
    def playing(self) -> bool:
        """True while time advances."""
        return self.playback.playing

    @property
    def speed(self) -> float:
        """Recorded seconds per second."""
        return self.playback.speed

    def play(self, on: bool) -> None:
        """Play if `on` is True, otherwise pause. At the end, play from the beginning."""
        self.playback.play(self._now, on)

    def step(self, steps: int) -> None:
        """Go this number of ticks forward, or back if it is negative, and pause there."""
        if self._source is not None:
            self.playback.playing = False
            self.playback.seek(self._source.step(self.playback.at_ns, steps))

    def set_speed(self, speed: float) -> None:
        """Play at this speed."""
        self.playback.set_speed(self._now, speed)

    def seek(self, time: float) -> None:
        """Go to this time, or to the nearest time in the recording."""
        self.playback.seek(self._start_ns + round(time * 1e9))

    def loop(self, span: tuple[float, float] | None) -> None:
        """Play repeatedly between these two times. If None, play to the end."""
        start, end = (self._start_ns + round(time * 1e9) for time in span or (0.0, 0.0))
        self.playback.loop = None if span is None else (start, end)


class RecordingFeed:
    """Feed of a recording; see `Feed`.

    Args:
        opener: opener of the recording, which may still be running.
    """

    live = False
    refusal = no_seat = RECORDED.sentence
    ended_bag = None

    def __init__(self, opener: BagOpener) -> None:
        self._opener = opener
        self._source: BagSource | None = None
        self._reading: Iterator[float] = iter(())
        self._share = 0.0
        self._whole = False
        self._fault = ""
        self._notices: list[str] = []
        self.data = FeedData(0, 0, SessionLog(), Series(0))
        self.transport = RecordingTransport()

    def seat_command(self, seat: str) -> tuple[str, ...] | str:
        """Return the reason why a recording has no seats to play."""
        return self.no_seat

    def advance(self, now: float) -> None:
        """Begin to use the recording when it is open, and advance the time shown."""
        if self._source is None and self._opener.source is not None:
            self._begin(self._opener.source)
        if self._opener.fault is not None:
            self._fault = str(self._opener.fault)
        self.transport.advance(now)

    def _begin(self, source: BagSource) -> None:
        self._source = source
        foreign = source.session is None
        self.data = FeedData(1, source.start_ns, source.log, source.series, numbers=source.numbers, foreign=foreign)
        self.transport.begin(source)
        self._reading = source.scan()
        self._notices += source.unreadable
        _keep_for_good()

    def work(self) -> bool:
        """Read the recording for some more milliseconds."""
        if self._source is None or self._fault:
            return False
        end = time.perf_counter() + READ_SLICE
        try:
            while time.perf_counter() < end:
                # Read the chosen numbers first, because a person waits for their plots.
                if self._source.numbers.work():
                    continue
                if self._whole:
                    return False
                share = next(self._reading, None)
                if share is None:
                    self._whole = True
                    _keep_for_good()
                    return False
                self._share = share
        except BadFile as fault:
            self._fault = str(fault)
        return True

    def scene(self, shown: ShownLayers) -> Scene | None:
        """Return the scene at the time shown."""
        if self._source is None:
            return None
        try:
            return self._source.scene(self.transport.playback.at_ns, shown)
        except BadFile as fault:
            self._fault = str(fault)
            self.transport.playback.playing = False
            return None

    def state(self, now: float) -> str:
        """Return the state of reading: opening, reading with a percentage, or the whole recording."""
        if self._source is None:
            return f"opening, {self._opener.share:.0%}"
        if self._source.numbers.share < 1.0:
            return f"reading numbers, {self._source.numbers.share:.0%}"
        return "recording" if self._whole else f"reading, {self._share:.0%}"

    def trouble(self) -> str:
        """Return the reason why the recording cannot be shown; empty if it can be shown."""
        if self._fault:
            return self._fault
        return "" if self._source is not None else f"Opening {self._opener.path} ({self._opener.share:.0%})"

    def take_notices(self) -> list[str]:
        """Return new sentences about topics that cannot be read, and about the results of saving."""
        notices, self._notices = self._notices, []
        return notices

    def use_map(self, grid: OccupancyGrid) -> None:
        """Show this map in place of the recorded map."""
        if self._source is not None:
            self._source.map = grid

    def save_section(self, path: Path, start: float, end: float) -> str:
        """Save a section as a bag in a thread. A notice reports the result."""
        if path.absolute() == self._opener.path.absolute():
            return "A section cannot replace the recording that it is taken from. Choose another file name."
        threading.Thread(target=self._cut, args=(path, CutRange(start, end)), daemon=True).start()
        return ""

    def _cut(self, path: Path, piece: CutRange) -> None:
        try:
            done = cut(self._opener.path, piece, path, overwrite=True)
            self._notices.append(f"Saved: {path}, {done.messages} messages")
        except BadFile as fault:
            self._notices.append(str(fault))

    def ask(self, request: FeedRequest) -> str:
        """Refuse, because a recording accepts no requests."""
        return self.refusal

    def close(self) -> None:
        """Close the recording, or stop opening it."""
        gc.unfreeze()
        self._opener.give_up()
        if self._source is not None:
            self._source.close()

"""Interface of all that the researcher's window can show: a running session and a recording are driven alike."""

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from sim.common.grid import OccupancyGrid
from thbridge.roles.shared.robot_requests import PaceRequest, Request
from ui.model.watching.scene import Scene, ShownLayers
from ui.model.watching.series import Series
from ui.model.watching.session_log import SessionLog
from ui.sources.numbers import TopicNumbers

FeedRequest = Request | PaceRequest
"""A request to the robots, or about the session's pace."""


@dataclass(frozen=True, slots=True)
class FeedData:
    """All that is known of a session or recording; its log and series grow.

    Attributes:
        generation: counts up when all earlier data is void.
        start_ns: ROS time of its beginning.
        log: log of what happened, as far as it is known.
        series: numbers over time, as far as they are known.
        known_since: time from which on the series are known.
        numbers: all topics, and the numbers in their messages; None where they are not known, as in a running session.
        foreign: True for a recording that is not one of our sessions.
    """

    generation: int
    start_ns: int
    log: SessionLog
    series: Series
    known_since: float = 0.0
    numbers: TopicNumbers | None = None
    foreign: bool = False


class FeedTransport(Protocol):
    """The time that is shown of a session or recording, and its controls. Times are seconds since its beginning."""

    @property
    def time(self) -> float:
        """Time shown."""

    @property
    def span(self) -> float:
        """Length of the recording, or of the session so far."""

    @property
    def playing(self) -> bool:
        """True while time goes on."""

    @property
    def speed(self) -> float:
        """Simulated seconds per second while it plays; 0: as fast as the machine can."""

    def play(self, on: bool) -> None:
        """Let time go on, or stop it."""

    def step(self, steps: int) -> None:
        """Go so many ticks on, or back when negative, and stop there."""

    def set_speed(self, speed: float) -> None:
        """Play at this speed."""

    def seek(self, time: float) -> None:
        """Go to this time."""

    def loop(self, span: tuple[float, float] | None) -> None:
        """Play from one time to another again and again, or to the end; no effect on a running session."""


class Feed(Protocol):
    """A session or recording that can be watched. Times are seconds since its beginning."""

    @property
    def live(self) -> bool:
        """True for a running session, which goes on by itself and cannot go back in time."""

    @property
    def refusal(self) -> str:
        """Sentence that says why robots can never take requests; empty where they can."""

    @property
    def data(self) -> FeedData:
        """All that is known of it now."""

    @property
    def transport(self) -> FeedTransport:
        """Its time."""

    @property
    def ended_bag(self) -> str | None:
        """Path of the bag of a session that has ended; empty where it has none, None while it goes on."""

    def advance(self, now: float) -> None:
        """Take new data, and let time go on; `now` is in monotonic seconds."""

    def work(self) -> bool:
        """Do some milliseconds of background work; return True when there is more of it."""

    def scene(self, shown: ShownLayers) -> Scene | None:
        """Return the scene at the time shown; None before anything is known."""

    def state(self, now: float) -> str:
        """Return the feed's state, in a few words."""

    def trouble(self) -> str:
        """Return why there is nothing to see, or nothing new; empty where all is well."""

    def take_notices(self) -> list[str]:
        """Return sentences that are to be shown once."""

    def use_map(self, grid: OccupancyGrid) -> None:
        """Show this map in place of the recorded one; no effect on a running session."""

    def save_section(self, path: Path, start: float, end: float) -> str:
        """Save a section of a recording as a bag; return why that cannot be done, or an empty text."""

    def ask(self, request: FeedRequest) -> str:
        """Send a request; return why that cannot be done, or an empty text."""

    def close(self) -> None:
        """Close files, threads and connections."""

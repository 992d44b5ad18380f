"""Interface that sessions and recordings share, so that the researcher's window can show both."""

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
"""Request to the robots, or to change the pace of the session."""


@dataclass(frozen=True, slots=True)
class FeedData:
    """All known data of a session or recording; its log and series grow.

    Attributes:
        generation: counter that increases when all earlier data becomes invalid.
        start_ns: ROS time of the beginning.
        log: log of the events known so far.
        series: numbers over time known so far.
        known_since: time from which the series are known.
        numbers: all topics, and the numbers in their messages. None if they are unknown, as in a running session.
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
    """Time shown of a session or recording, and its controls. Times are seconds since the beginning."""

    @property
    def time(self) -> float:
        """Time shown."""

    @property
    def span(self) -> float:
        """Length of the recording, or of the session so far."""

    @property
    def playing(self) -> bool:
        """True while time advances."""

    @property
    def speed(self) -> float:
        """Simulated seconds per second while playing. If 0, it is as fast as possible."""

    def play(self, on: bool) -> None:
        """Start or stop time."""

    def step(self, steps: int) -> None:
        """Move this number of ticks forward, or back if negative, and stop there."""

    def set_speed(self, speed: float) -> None:
        """Play at this speed."""

    def seek(self, time: float) -> None:
        """Go to this time."""

    def loop(self, span: tuple[float, float] | None) -> None:
        """Play from one time to another repeatedly. If None, play to the end. Has no effect on a running session."""


class Feed(Protocol):
    """Session or recording that can be watched. All times are seconds since the beginning."""

    @property
    def live(self) -> bool:
        """True for a running session, which advances by itself and cannot go back in time."""

    @property
    def refusal(self) -> str:
        """Sentence that says why the robots never accept requests; empty if they do."""

    @property
    def data(self) -> FeedData:
        """All data known at this moment."""

    @property
    def transport(self) -> FeedTransport:
        """Time and its controls."""

    @property
    def ended_bag(self) -> str | None:
        """Path of the bag of an ended session; empty if there is no bag, None while the session runs."""

    def advance(self, now: float) -> None:
        """Fetch new data, and advance time; `now` is in monotonic seconds."""

    def work(self) -> bool:
        """Do some milliseconds of background work; return True if more remains."""

    def scene(self, shown: ShownLayers) -> Scene | None:
        """Return the scene at the time shown; None before anything is known."""

    def state(self, now: float) -> str:
        """Return the feed's state in a few words."""

    def trouble(self) -> str:
        """Return why there is nothing to see, or nothing new; empty if there is no problem."""

    def take_notices(self) -> list[str]:
        """Return sentences that are shown only once."""

    def use_map(self, grid: OccupancyGrid) -> None:
        """Show this map in place of the recorded one; no effect on a running session."""

    def save_section(self, path: Path, start: float, end: float) -> str:
        """Save a section of a recording as a bag. Return why that is not possible, or an empty text."""

    def ask(self, request: FeedRequest) -> str:
        """Send a request. Return why that is not possible, or an empty text."""

    def close(self) -> None:
        """Close files, threads and connections."""

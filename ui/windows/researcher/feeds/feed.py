"""Common interface of sessions and recordings, so that the researcher's window can show both."""

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
"""Request to the robots, or request to change the pace of the session."""


@dataclass(frozen=True, slots=True)
class FeedData:
    """All known data of a session or recording. The log and the series grow.

    Attributes:
        generation: counter that increases when all earlier data become invalid.
        start_ns: ROS time of the beginning.
        log: log of the events known so far.
        series: numbers over time known so far.
        known_since: time from which the series are known.
        numbers: all topics, and the numbers in their messages. None if they are unknown, as in a running session.
        foreign: True for a recording of another program, False for one of our sessions.
    """

    generation: int
    start_ns: int
    log: SessionLog
    series: Series
    known_since: float = 0.0
    numbers: TopicNumbers | None = None
    foreign: bool = False


class FeedTransport(Protocol):
    """Time shown of a session or recording, and its controls. All times are seconds since the beginning."""

    @property
    def time(self) -> float:
        """Time shown."""

    @property
    def span(self) -> float:
        """Length of the recording, or of the session so far, seconds."""

    @property
    def playing(self) -> bool:
        """True while time advances."""

    @property
    def speed(self) -> float:
        """Simulated seconds per second while playing. If 0, time advances as fast as possible."""

    def play(self, on: bool) -> None:
        """Play if `on` is True; otherwise pause."""

    def step(self, steps: int) -> None:
        """Go this number of ticks forward, or back if it is negative, and pause there."""

    def set_speed(self, speed: float) -> None:
        """Play at this speed."""

    def seek(self, time: float) -> None:
        """Go to this time."""

    def loop(self, span: tuple[float, float] | None) -> None:
        """Play repeatedly between these two times. If None, play to the end. It has no effect on a running session."""


class Feed(Protocol):
    """Interface of a session or recording that can be watched. All times are seconds since the beginning."""

    @property
    def live(self) -> bool:
        """True for a running session, whose time advances by itself and cannot go back."""

    @property
    def refusal(self) -> str:
        """Sentence with the reason why the robots never accept requests; empty if they accept requests."""

    @property
    def data(self) -> FeedData:
        """All data known at this moment."""

    @property
    def transport(self) -> FeedTransport:
        """Time shown and its controls."""

    @property
    def ended_bag(self) -> str | None:
        """Path of the bag of an ended session; empty if there is no bag; None while the session runs."""

    @property
    def no_seat(self) -> str:
        """Sentence with the reason why the researcher cannot take any seat of the game; empty if they can."""

    def seat_command(self, seat: str) -> tuple[str, ...] | str:
        """Return the arguments of the command that opens a window for a seat, or the reason why there is none."""

    def advance(self, now: float) -> None:
        """Fetch new data, and advance time; `now` is in monotonic seconds."""

    def work(self) -> bool:
        """Do background work for some milliseconds. Return True if more work remains."""

    def scene(self, shown: ShownLayers) -> Scene | None:
        """Return the scene at the time shown; None before a scene is known."""

    def state(self, now: float) -> str:
        """Return the state of the feed in a few words."""

    def trouble(self) -> str:
        """Return the reason why there are no data or no new data; empty if there is no problem."""

    def take_notices(self) -> list[str]:
        """Return sentences that the window should show once."""

    def use_map(self, grid: OccupancyGrid) -> None:
        """Show this map in place of the recorded map. This has no effect on a running session."""

    def save_section(self, path: Path, start: float, end: float) -> str:
        """Save a section of a recording as a bag. Return the reason if that fails at once, otherwise an empty text."""

    def ask(self, request: FeedRequest) -> str:
        """Send a request. If that is not possible, return the reason, otherwise an empty text."""

    def close(self) -> None:
        """Close files, threads and connections."""

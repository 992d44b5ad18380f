"""What a researcher's window shows, however it is come by: a session under way and a recording are driven alike."""

from typing import Protocol

from thbridge.roles.robot_requests import PaceRequest, Request
from ui.model.watching.scene import Scene, ShownLayers
from ui.model.watching.series import Series
from ui.model.watching.session_log import SessionLog

FeedRequest = Request | PaceRequest
"""What is asked of the robots, or of the session's pace."""


class Feed(Protocol):
    """Whatever can be watched. Times are seconds since its beginning."""

    @property
    def live(self) -> bool:
        """A session under way: it goes on whether or not somebody looks, and there is no way back."""

    @property
    def refusal(self) -> str:
        """Why nothing can ever be asked of the robots; empty where it can."""

    @property
    def generation(self) -> int:
        """Counts up when all that was told before is void."""

    @property
    def start_ns(self) -> int:
        """ROS time of its beginning."""

    @property
    def log(self) -> SessionLog:
        """What happened, as far as it is known."""

    @property
    def series(self) -> Series:
        """Numbers over time, as far as they are known."""

    @property
    def time(self) -> float:
        """The moment shown."""

    @property
    def span(self) -> float:
        """How long it is, or has been so far."""

    @property
    def playing(self) -> bool:
        """Whether time goes on."""

    @property
    def speed(self) -> float:
        """Simulated seconds per second, while it plays; 0: as fast as the machine can."""

    def advance(self, now: float) -> None:
        """Take what has come, and let time go on; `now` is in seconds that never go back."""

    def work(self) -> bool:
        """Do some milliseconds of what there is to do beside; whether there is more of it."""

    def scene(self, shown: ShownLayers) -> Scene | None:
        """How things stand at the moment shown; None before anything is known."""

    def state(self, now: float) -> str:
        """How it is, in a few words."""

    def trouble(self) -> str:
        """Why there is nothing to see, or nothing new; empty where all is well."""

    def take_notices(self) -> list[str]:
        """What is to be told once, in sentences."""

    def play(self, on: bool) -> None:
        """Let time go on, or stop it."""

    def step(self, steps: int) -> None:
        """Go so many ticks on, or back where negative, and stop there."""

    def set_speed(self, speed: float) -> None:
        """Go on at this speed."""

    def seek(self, time: float) -> None:
        """Go to this moment."""

    def ask(self, wish: FeedRequest) -> str:
        """Ask for something; empty, or why that cannot be done."""

    def close(self) -> None:
        """Let go of files, threads and connections."""

"""How a vehicle is put together: its parts hear and say by themselves, and know each other by what stands here."""

from collections.abc import Iterable
from enum import IntEnum
from typing import Protocol

from thbridge.wire.mavlink.dialect import Message, mav
from thbridge.wire.mavlink.outgoing import LinkId, OutgoingMessage
from thbridge.wire.mavlink.vehicle_interface import Denied, RobotReadings, Station


class Microservice(Protocol):
    """A part of a vehicle that speaks for itself: missions, parameters, commands.

    Each part is given every message that is meant for its vehicle, and passes over those that it does not know.
    """

    def hear(self, link: LinkId, sender: Station, message: Message) -> Iterable[OutgoingMessage]:
        """A message has come in; what is answered at once."""

    def step(self, tick: int, readings: RobotReadings) -> Iterable[OutgoingMessage]:
        """A tick has passed; what is said unasked."""

    def forget(self, link: LinkId) -> None:
        """A link is gone, and whoever was spoken to on it."""


class MissionControl(Protocol):
    """A vehicle's mission, as its modes use it: it runs in mode auto and only then."""

    @property
    def running(self) -> bool:
        """Whether it drives the robot just now; it stops by itself at its end, and where an item fails."""

    def start(self, first: int | None = None, last: int | None = None) -> Denied | None:
        """Run it.

        Args:
            first: the item to begin with; None: where it stands, and from the beginning after its end.
            last: the item to end with; None: the last.
        """

    def pause(self) -> None:
        """Stop running it and keep the place. The robot itself is halted by whoever calls this."""

    def select(self, item: int) -> Denied | None:
        """Go on with this item, now if it runs and else when it starts."""

    def current(self) -> Message:
        """MISSION_CURRENT as it is now."""


class TextSeverity(IntEnum):
    """How much a sentence matters."""

    CRITICAL = mav.MAV_SEVERITY_CRITICAL
    WARNING = mav.MAV_SEVERITY_WARNING
    NOTICE = mav.MAV_SEVERITY_NOTICE
    INFO = mav.MAV_SEVERITY_INFO


class Announce(Protocol):
    """How a part tells people something."""

    def __call__(self, severity: TextSeverity, sentence: str) -> None:
        """Say a sentence as STATUSTEXT to all links, soon."""


def tell_why_not(announce: Announce, denied: Denied | None) -> None:
    """Warn people of what the robot does not do; of what it does, they see enough."""
    if denied is not None:
        announce(TextSeverity.WARNING, denied.sentence)

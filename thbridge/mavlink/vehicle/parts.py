"""Protocols of the parts of a vehicle, through which they know each other."""

from collections.abc import Callable, Iterable
from enum import IntEnum
from typing import Protocol, TypeAlias

from thbridge.mavlink.values.vehicle_interface import Denied, RobotReadings, Station
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage


class Microservice(Protocol):
    """Microservice of a vehicle, such as its missions, parameters or commands.

    It is given every message that is addressed to its vehicle, and ignores those that are not its own.
    """

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterable[OutgoingMessage]:
        """Handle a message and return the answers; by default none is its own."""
        return ()

    def step(self, tick: int, readings: RobotReadings) -> Iterable[OutgoingMessage]:
        """Advance by one tick and return the messages that are due; by default none ever is."""
        return ()

    def forget(self, link: LinkId) -> None:
        """Forget a closed link and its stations; by default no state depends on links."""
        return


class MissionControl(Protocol):
    """Mission of a vehicle as its modes use it: it runs in mode AUTO only."""

    @property
    def running(self) -> bool:
        """True while it drives the robot; it stops by itself at its end, and where an item fails."""

    def start(self, first: int | None = None, last: int | None = None) -> Denied | None:
        """Run it.

        Args:
            first: the item to begin with; None: the current one, and item 0 after the mission's end.
            last: the item to end with; None: the last.
        """

    def pause(self) -> None:
        """Stop running it and keep the current item. The caller must stop the robot itself."""

    def select(self, item: int) -> Denied | None:
        """Continue with this item, now if the mission runs and else when it starts."""

    def current(self) -> Message:
        """Return MISSION_CURRENT."""


class TextSeverity(IntEnum):
    """Severity of a text, a code of MAV_SEVERITY."""

    CRITICAL = mav.MAV_SEVERITY_CRITICAL
    WARNING = mav.MAV_SEVERITY_WARNING
    NOTICE = mav.MAV_SEVERITY_NOTICE
    INFO = mav.MAV_SEVERITY_INFO


Announce: TypeAlias = Callable[[TextSeverity, str], None]
"""Function by which a part sends a sentence to people: it is queued as STATUSTEXT for all links."""


def announce_denial(announce: Announce, denied: Denied | None) -> None:
    """Send the sentence of a denial, if there is one, as a warning."""
    if denied is not None:
        announce(TextSeverity.WARNING, denied.sentence)

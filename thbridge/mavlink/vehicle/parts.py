"""Interfaces between the parts of a vehicle."""

from collections.abc import Callable, Iterable
from enum import IntEnum
from typing import Protocol, TypeAlias

from thbridge.mavlink.values.vehicle_interface import Denied, RobotReadings, Station
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage


class Microservice(Protocol):
    """Microservice of a vehicle, such as its missions, parameters or commands.

    It gets every message to its vehicle, and ignores messages of other microservices.
    """

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterable[OutgoingMessage]:
        """Process a message and return the answers. By default, all messages are ignored."""
        return ()

    def step(self, tick: int, readings: RobotReadings) -> Iterable[OutgoingMessage]:
        """Advance by one tick and return the messages that are due. By default, no messages are due."""
        return ()

    def forget(self, link: LinkId) -> None:
        """Forget a closed link and its stations. By default, no state depends on links."""
        return


class MissionControl(Protocol):
    """Mission of a vehicle, as its modes use it. It runs only in mode AUTO."""

    @property
    def running(self) -> bool:
        """True while the mission drives the robot. It becomes False when the mission ends or an item fails."""

    def start(self, first: int | None = None, last: int | None = None) -> Denied | None:
        """Run the mission.

        Args:
            first: number of the first item. If None, start with the current item, or with item 0 if the mission has
                ended.
            last: number of the last item. If None, execute the plan to its end.
        """

    def pause(self) -> None:
        """Stop the mission and keep its current item. The caller must stop the robot."""

    def select(self, item: int) -> Denied | None:
        """Make this item the next item.

        A running mission continues with this item at once. Any other mission continues with it when it starts.
        """

    def current(self) -> Message:
        """Return MISSION_CURRENT."""


class TextSeverity(IntEnum):
    """Severity of a text, a code of MAV_SEVERITY."""

    CRITICAL = mav.MAV_SEVERITY_CRITICAL
    WARNING = mav.MAV_SEVERITY_WARNING
    NOTICE = mav.MAV_SEVERITY_NOTICE
    INFO = mav.MAV_SEVERITY_INFO


Announce: TypeAlias = Callable[[TextSeverity, str], None]
"""Function that sends a sentence to people. It queues the sentence as STATUSTEXT for all links."""


def announce_denial(announce: Announce, denied: Denied | None) -> None:
    """Send the sentence of a denial as a warning. If there is no denial, do nothing."""
    if denied is not None:
        announce(TextSeverity.WARNING, denied.sentence)

"""Protocols through which the parts of a vehicle use each other."""

from collections.abc import Callable, Iterable
from enum import IntEnum
from typing import Protocol, TypeAlias

from thbridge.mavlink.values.vehicle_interface import Denied, RobotReadings, Station
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage


class Microservice(Protocol):
    """Microservice of a vehicle, such as its missions, parameters or commands.

    It gets every message that is addressed to its vehicle, and ignores messages of other microservices.
    """

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterable[OutgoingMessage]:
        """Process a message and return the answers; by default, no message is processed."""
        return ()

    def step(self, tick: int, readings: RobotReadings) -> Iterable[OutgoingMessage]:
        """Advance by one tick and return the messages that are due; by default, there are none."""
        return ()

    def forget(self, link: LinkId) -> None:
        """Forget a closed link and its stations; by default, no state depends on links."""
        return


class MissionControl(Protocol):
    """Mission of a vehicle, as its modes use it; it runs in mode AUTO only."""

    @property
    def running(self) -> bool:
        """True while it drives the robot; this ends with the mission, and when an item fails."""

    def start(self, first: int | None = None, last: int | None = None) -> Denied | None:
        """Run it.

        Args:
            first: the first item. If None, the current one, or item 0 after the end of the mission.
            last: the last item. If None, the last one of the plan.
        """

    def pause(self) -> None:
        """Stop running it and keep the current item. The caller must stop the robot."""

    def select(self, item: int) -> Denied | None:
        """Make this item the next one: at once if the mission is running, otherwise at its start."""

    def current(self) -> Message:
        """Return MISSION_CURRENT."""


class TextSeverity(IntEnum):
    """Severity of a text, a code of MAV_SEVERITY."""

    CRITICAL = mav.MAV_SEVERITY_CRITICAL
    WARNING = mav.MAV_SEVERITY_WARNING
    NOTICE = mav.MAV_SEVERITY_NOTICE
    INFO = mav.MAV_SEVERITY_INFO


Announce: TypeAlias = Callable[[TextSeverity, str], None]
"""Function by which a part sends a sentence to people; the sentence is queued as STATUSTEXT for all links."""


def announce_denial(announce: Announce, denied: Denied | None) -> None:
    """Send the sentence of a denial, if there is one, as a warning."""
    if denied is not None:
        announce(TextSeverity.WARNING, denied.sentence)

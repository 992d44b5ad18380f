"""What a vehicle gives away: messages for links, and how it stands."""

from dataclasses import dataclass
from typing import NewType

from thbridge.wire.mavlink.dialect import Message, mav

LinkId = NewType("LinkId", int)

COMPONENT = mav.MAV_COMP_ID_AUTOPILOT1
"""The one component that a robot has."""


@dataclass(frozen=True, slots=True)
class OutgoingMessage:
    """Something that a vehicle says.

    Attributes:
        message: what.
        link: the only link it goes to; None: to all that are awake.
        besides: links that it does not go to, because they asked for another rate.
        to_sleepers: also to links on which nobody has been heard, as heartbeats are.
    """

    message: Message
    link: LinkId | None = None
    to_sleepers: bool = False
    besides: frozenset[LinkId] = frozenset()


@dataclass(frozen=True, slots=True)
class VehicleStatus:
    """How a vehicle stands, as mavros tells it.

    Attributes:
        connected: its software answers: mavros hears its heartbeat.
        armed: its motors obey.
        guided: it goes where it is told.
        manual_input: it goes as a hand drives it.
        mode: its mode's name.
        system_status: a code of MAV_STATE.
    """

    connected: bool
    armed: bool
    guided: bool
    manual_input: bool
    mode: str
    system_status: int

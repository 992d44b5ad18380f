"""Output of a vehicle: messages for links, and its status."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, NewType

if TYPE_CHECKING:
    from thbridge.mavlink.wire.dialect import Message

LinkId = NewType("LinkId", int)


@dataclass(frozen=True, slots=True)
class OutgoingMessage:
    """Message that a vehicle sends.

    Attributes:
        message: the message.
        link: the only link it goes to. If None, it goes to all active links.
        except_links: links that it does not go to, because they requested another rate.
        to_inactive: True if it also goes to inactive links, as heartbeats do.
    """

    message: "Message"
    link: LinkId | None = None
    to_inactive: bool = False
    except_links: frozenset[LinkId] = frozenset()


@dataclass(frozen=True, slots=True)
class VehicleStatus:
    """Status of a vehicle as in mavros_msgs/State.

    Attributes:
        connected: True if its software responds; mavros: a heartbeat is received.
        armed: True if its motors are enabled.
        guided: True if it drives to given goals.
        manual_input: True if it is driven by hand.
        mode: name of its mode.
        system_status: a code of MAV_STATE.
    """

    connected: bool
    armed: bool
    guided: bool
    manual_input: bool
    mode: str
    system_status: int

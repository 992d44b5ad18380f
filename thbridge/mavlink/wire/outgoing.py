"""Output of a vehicle: messages for links, and the vehicle's status."""

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
        link: only link that gets the message. If None, all active links get it.
        except_links: links that do not get the message, because they requested another rate.
        to_inactive: True if inactive links also get the message, such as a heartbeat.
    """

    message: "Message"
    link: LinkId | None = None
    to_inactive: bool = False
    except_links: frozenset[LinkId] = frozenset()


@dataclass(frozen=True, slots=True)
class VehicleStatus:
    """Status of a vehicle as in mavros_msgs/State.

    Attributes:
        connected: True if its software responds. In mavros, it means that heartbeats arrive.
        armed: True if its motors are enabled.
        guided: True if it drives to given goals.
        manual_input: True if a person drives it by hand.
        mode: name of its mode.
        system_status: a code of MAV_STATE.
    """

    connected: bool
    armed: bool
    guided: bool
    manual_input: bool
    mode: str
    system_status: int

"""One robot as a MAVLink 2 ground rover, without sockets and clocks: messages in, messages out.

Source: the MAVLink developer guide, "Microservices".
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import NewType

from sim.observations import TICKS_PER_SECOND
from thbridge.wire.mavlink.dialect import Message, mav
from thbridge.wire.mavlink.helm import Helm, Readings, Station

LinkId = NewType("LinkId", int)

COMPONENT = mav.MAV_COMP_ID_AUTOPILOT1
"""The one component that a robot has."""


class Identity(StrEnum):
    """Whose autopilot a vehicle says it has; ground stations offer more to those that they know."""

    GENERIC = "generic"
    ARDUPILOT = "ardupilot"


class Failsafe(StrEnum):
    """What a robot does when the ground station that commands it is not heard any more."""

    STOP = "stop"
    HOME = "home"
    CONTINUE = "continue"


@dataclass(frozen=True, slots=True)
class Origin:
    """Where on earth the map's origin lies, WGS84: degrees north and east, metres above sea level; north is map y."""

    latitude: float
    longitude: float
    altitude: float


@dataclass(frozen=True, slots=True)
class VehicleOptions:
    """What a study decides about vehicles.

    Attributes:
        identity: whose autopilot they say they have.
        origin: where the map lies on earth.
        lost_after: seconds without a heartbeat after which a ground station counts as lost.
        failsafe: what is done then.
        position_rate: of position, attitude and speed, Hz, as long as nobody asks for another rate.
    """

    identity: Identity
    origin: Origin
    lost_after: float
    failsafe: Failsafe
    position_rate: float


@dataclass(frozen=True, slots=True)
class Said:
    """Something that a vehicle says.

    Attributes:
        message: what.
        link: the only link it goes to; None: to all that are awake.
        to_sleepers: also to links on which nobody has been heard, as heartbeats are.
    """

    message: Message
    link: LinkId | None = None
    to_sleepers: bool = False


@dataclass(frozen=True, slots=True)
class Status:
    """How a vehicle stands, as mavros tells it.

    Attributes:
        connected: a ground station is heard.
        armed: its motors obey.
        guided: it goes where it is told.
        manual_input: it is driven by hand.
        mode: its mode's name.
        system_status: a code of MAV_STATE.
    """

    connected: bool
    armed: bool
    guided: bool
    manual_input: bool
    mode: str
    system_status: int


class Vehicle:
    """One robot's voice in MAVLink.

    Args:
        system: its system id, 1 to 250.
        helm: the robot.
        options: what the study says.
    """

    def __init__(self, system: int, helm: Helm, options: VehicleOptions) -> None:
        self.system = system
        self._helm = helm
        self._options = options

    @property
    def status(self) -> Status:
        """How it stands."""
        return Status(False, False, False, False, "HOLD", mav.MAV_STATE_ACTIVE)

    def hear(self, link: LinkId, sender: Station, message: Message) -> Iterator[Said]:
        """Somebody said something to this vehicle, or to everybody; what it answers at once."""
        yield from ()

    def step(self, tick: int, readings: Readings) -> Iterator[Said]:
        """A tick has passed; what it says by itself."""
        if tick % TICKS_PER_SECOND == self.system % TICKS_PER_SECOND:
            flags = mav.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
            autopilot = mav.MAV_AUTOPILOT_GENERIC
            rover, active = mav.MAV_TYPE_GROUND_ROVER, mav.MAV_STATE_ACTIVE
            yield Said(mav.MAVLink_heartbeat_message(rover, autopilot, flags, 0, active, 3), to_sleepers=True)

    def forget(self, link: LinkId) -> None:
        """A link is gone, with the rates that were asked for on it."""

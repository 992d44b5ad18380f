"""One robot as a MAVLink 2 ground rover, without sockets and clocks: messages in, messages out.

Source: the MAVLink developer guide, "Microservices".
"""

from collections.abc import Iterator

from sim.observations import TICKS_PER_SECOND
from thbridge.wire.mavlink.dialect import Message, mav
from thbridge.wire.mavlink.earth import Earth
from thbridge.wire.mavlink.helm import Helm, Readings, Station
from thbridge.wire.mavlink.options import Failsafe, Identity, Origin, VehicleOptions
from thbridge.wire.mavlink.parts import Part
from thbridge.wire.mavlink.said import COMPONENT, LinkId, Said, Status
from thbridge.wire.mavlink.texts import Texts

__all__ = ["COMPONENT", "Failsafe", "Identity", "LinkId", "Origin", "Said", "Status", "Vehicle", "VehicleOptions"]


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
        self._earth = Earth(options.origin)
        self._texts = Texts()
        self._parts: tuple[Part, ...] = ()

    @property
    def status(self) -> Status:
        """How it stands."""
        return Status(False, False, False, False, "HOLD", mav.MAV_STATE_ACTIVE)

    def hear(self, link: LinkId, sender: Station, message: Message) -> Iterator[Said]:
        """Somebody said something to this vehicle, or to everybody; what it answers at once."""
        for part in self._parts:
            yield from part.hear(link, sender, message)

    def step(self, tick: int, readings: Readings) -> Iterator[Said]:
        """A tick has passed; what it says by itself."""
        if tick % TICKS_PER_SECOND == self.system % TICKS_PER_SECOND:
            flags = mav.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
            autopilot = mav.MAV_AUTOPILOT_GENERIC
            rover, active = mav.MAV_TYPE_GROUND_ROVER, mav.MAV_STATE_ACTIVE
            yield Said(mav.MAVLink_heartbeat_message(rover, autopilot, flags, 0, active, 3), to_sleepers=True)
        for part in self._parts:
            yield from part.step(tick, readings)
        yield from self._texts.step(tick)

    def forget(self, link: LinkId) -> None:
        """A link is gone, with the rates that were asked for on it."""
        for part in self._parts:
            part.forget(link)

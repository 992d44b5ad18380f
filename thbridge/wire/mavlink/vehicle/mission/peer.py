"""Whoever transfers a mission to or from a vehicle, and what both ways say to them."""

from typing import NamedTuple

from thbridge.wire.mavlink.dialect import mav
from thbridge.wire.mavlink.outgoing import LinkId, OutgoingMessage
from thbridge.wire.mavlink.vehicle.mission.ids import MissionAck
from thbridge.wire.mavlink.vehicle_interface import Station

MISSION = mav.MAV_MISSION_TYPE_MISSION

EMPTY_TYPES = frozenset((mav.MAV_MISSION_TYPE_FENCE, mav.MAV_MISSION_TYPE_RALLY))
"""Of these a robot has none, and takes none."""


class MissionPeer(NamedTuple):
    """Whoever takes part in a transfer; stations on different links may well have the same ids."""

    link: LinkId
    station: Station

    @property
    def target(self) -> tuple[int, int]:
        """The system and component that messages to it name."""
        return self.station.system, self.station.component

    def ack(self, result: int, mission_type: int = MISSION, plan: int = 0) -> OutgoingMessage:
        """How a transfer ended, or why there is none: a code of MAV_MISSION_RESULT, and the number of the plan."""
        return OutgoingMessage(MissionAck(*self.target, result, mission_type, plan), self.link)

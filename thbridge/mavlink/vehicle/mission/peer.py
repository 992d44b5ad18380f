"""Station that uploads or downloads a mission, and acknowledgements to this station."""

from typing import NamedTuple

from thbridge.mavlink.values.vehicle_interface import Station
from thbridge.mavlink.vehicle.mission.ids import MissionAck
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

MISSION = mav.MAV_MISSION_TYPE_MISSION

EMPTY_TYPES = frozenset((mav.MAV_MISSION_TYPE_FENCE, mav.MAV_MISSION_TYPE_RALLY))
"""Types of plans that robots do not support. A robot's plans of these types are always empty."""


class MissionPeer(NamedTuple):
    """Station of a transfer, with its link. The link is included, because stations on different links may have the same
    ids.
    """

    link: LinkId
    station: Station

    @property
    def target(self) -> tuple[int, int]:
        """Target system and component of messages to this station."""
        return self.station.system, self.station.component

    def ack(self, result: int, mission_type: int = MISSION, plan: int = 0) -> OutgoingMessage:
        """Return a MISSION_ACK. It contains a code of MAV_MISSION_RESULT and the plan's id."""
        return OutgoingMessage(MissionAck(*self.target, result, mission_type, plan), self.link)

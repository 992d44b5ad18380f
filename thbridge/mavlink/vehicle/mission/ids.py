"""Plan ids, and messages that contain them. A station compares its plan with the robot's plan by these ids.

Source: the MAVLink developer guide, "Mission Protocol", "Detecting Mission/Plan Changes". The fields are newer than
pymavlink's dialect, so this module extends its messages. Receivers that do not support the fields ignore them.
"""

import struct
import zlib
from collections.abc import Iterable

from thbridge.mavlink.vehicle.mission.items import MissionItem
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.extra_messages import extended

_ITEM = struct.Struct("<HB4f2if?")


def plan_id(items: Iterable[MissionItem]) -> int:
    """Return a checksum of a plan. The checksum of an empty plan is 0."""
    crc = 0
    for item in items:
        crc = zlib.crc32(
            _ITEM.pack(item.command, item.frame, *item.params, item.x, item.y, item.z, item.autocontinue), crc
        )
    return crc


@extended("uint32_t opaque_id")
class MissionAck(mav.MAVLink_mission_ack_message):
    """MISSION_ACK with the id of the robot's new plan."""

    def __init__(self, target_system: int, target_component: int, result: int, mission_type: int, plan: int) -> None:
        super().__init__(target_system, target_component, result, mission_type)
        self.opaque_id = plan


@extended("uint32_t opaque_id")
class MissionCount(mav.MAVLink_mission_count_message):
    """MISSION_COUNT with the id of the plan."""

    def __init__(self, target_system: int, target_component: int, count: int, mission_type: int, plan: int) -> None:
        super().__init__(target_system, target_component, count, mission_type)
        self.opaque_id = plan


# In the standard, ids of fences and rally points follow. Robots have neither, so these ids are omitted.
@extended("uint32_t mission_id")
class MissionCurrent(mav.MAVLink_mission_current_message):
    """MISSION_CURRENT with the id of the robot's plan."""

    def __init__(self, seq: int, total: int, mission_state: int, mission_mode: int, plan: int) -> None:
        super().__init__(seq, total, mission_state, mission_mode)
        self.mission_id = plan

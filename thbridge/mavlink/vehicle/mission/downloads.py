"""Mission downloads from a robot. Any number of stations may download at the same time.

Source: the MAVLink developer guide, "Mission Protocol".
"""

from dataclasses import dataclass
from typing import TypeAlias

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.vehicle.mission.ids import MissionCount
from thbridge.mavlink.vehicle.mission.items import MissionItem, message_of, old_message_of
from thbridge.mavlink.vehicle.mission.peer import EMPTY_TYPES, MISSION, MissionPeer
from thbridge.mavlink.vehicle.mission.run import MissionRun
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

DOWNLOAD_TIMEOUT = 6 * 3 * TICKS_PER_SECOND // 2
"""A download has ended after this number of ticks without a request. This is the time of six attempts of 1500 ms."""

_Request: TypeAlias = mav.MAVLink_mission_request_message | mav.MAVLink_mission_request_int_message


@dataclass(slots=True)
class _Download:
    """Download of the plan that the robot had at the start of the download."""

    plan: tuple[MissionItem, ...]
    asked: int


class MissionDownloads:
    """Downloads of one robot's plan.

    Args:
        run: mission that contains the plan.
    """

    def __init__(self, run: MissionRun) -> None:
        self._run = run
        self._downloads: dict[MissionPeer, _Download] = {}
        self._tick = 0

    def begin(self, peer: MissionPeer, mission_type: int) -> OutgoingMessage:
        """Start a download. The answer contains the number of items."""
        if mission_type in EMPTY_TYPES:
            return _count(peer, 0, mission_type)
        if mission_type != MISSION:
            return peer.ack(mav.MAV_MISSION_UNSUPPORTED, mission_type)
        self._downloads[peer] = _Download(self._run.readable, self._tick)
        return _count(peer, len(self._run.plan), mission_type, self._run.plan_id)

    def item(self, peer: MissionPeer, message: _Request) -> OutgoingMessage:
        """Return a requested item. The request also determines the form of the answer."""
        if message.mission_type not in (MISSION, *EMPTY_TYPES):
            return peer.ack(mav.MAV_MISSION_UNSUPPORTED, message.mission_type)
        download = self._downloads.get(peer)
        if download is not None:
            download.asked = self._tick
        # The plan may change during a download. The station must not get items of two plans.
        plan = self._run.readable if download is None else download.plan
        seq = message.seq
        if message.mission_type in EMPTY_TYPES or seq >= len(plan):
            return peer.ack(mav.MAV_MISSION_INVALID_SEQUENCE, message.mission_type)
        item_of = message_of if isinstance(message, mav.MAVLink_mission_request_int_message) else old_message_of
        return OutgoingMessage(item_of(plan[seq], seq, seq == self._run.current_item, peer.station), peer.link)

    def end(self, peer: MissionPeer) -> None:
        """End a download. The station has all items, or it has changed the plan."""
        self._downloads.pop(peer, None)

    def step(self, tick: int) -> None:
        """Forget downloads without a recent request."""
        self._tick = tick
        self._downloads = {
            peer: there for peer, there in self._downloads.items() if tick - there.asked <= DOWNLOAD_TIMEOUT
        }

    def forget(self, link: LinkId) -> None:
        """Forget a closed link and its downloads."""
        self._downloads = {peer: there for peer, there in self._downloads.items() if peer.link != link}


def _count(peer: MissionPeer, count: int, mission_type: int, plan: int = 0) -> OutgoingMessage:
    return OutgoingMessage(MissionCount(*peer.target, count, mission_type, plan), peer.link)

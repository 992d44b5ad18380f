"""Mission protocol without sockets and clocks: uploads to a robot. The module `downloads` handles downloads.

Source: the MAVLink developer guide, "Mission Protocol".
Differences from the source: a station may send a part of the list, as in ArduPilot, but the plan changes only after the
complete part has arrived.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.values.vehicle_interface import DenialKind, Denied, RobotReadings, Station
from thbridge.mavlink.vehicle.mission.downloads import MissionDownloads
from thbridge.mavlink.vehicle.mission.items import InvalidItem, MissionItem, item_of, misplaced, unfit
from thbridge.mavlink.vehicle.mission.peer import EMPTY_TYPES, MISSION, MissionPeer
from thbridge.mavlink.vehicle.mission.run import MissionRun
from thbridge.mavlink.vehicle.parts import Announce, Microservice, TextSeverity
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

LONGEST = 700
"""Maximum number of items in a mission."""

ITEM_TIMEOUT = -(-TICKS_PER_SECOND // 4)
"""Ticks until the next request for a missing item: 250 ms."""

RETRIES = 5
"""The transfer is aborted after this number of repeated requests for an item."""

TRIES_OF_NEW_FORM = 4
"""Number of requests for the first item as MISSION_ITEM_INT. Later requests are for MISSION_ITEM."""

_ItemMessage = mav.MAVLink_mission_item_message | mav.MAVLink_mission_item_int_message

_GUIDED = (2, 3)
"""Values of `current` in an item outside missions: a place to which the robot drives at once, or an altitude."""


@dataclass(slots=True)
class _Upload:
    """Upload in progress.

    Attributes:
        peer: station that sends the mission.
        kept_before: items of the current plan before the first sent item.
        kept_after: items of the current plan after the last sent item.
        count: number of sent items.
        asked: tick of the last request for the next item.
        retries: number of repeated requests for the next item.
        old_form: True if the next item is requested as MISSION_ITEM.
        items: received items, in order.
    """

    peer: MissionPeer
    kept_before: tuple[MissionItem, ...]
    kept_after: tuple[MissionItem, ...]
    count: int
    asked: int
    retries: int = 0
    old_form: bool = False
    items: list[MissionItem] = field(default_factory=list)

    @property
    def next(self) -> int:
        """Number of the next item."""
        return len(self.kept_before) + len(self.items)

    @property
    def size(self) -> int:
        """Number of items of the new plan."""
        return len(self.kept_before) + self.count + len(self.kept_after)


class _Completed(NamedTuple):
    """Last completed upload. If its acknowledgement was lost, its last item arrives again."""

    peer: MissionPeer
    last: int


class MissionProtocol(Microservice):
    """Transfers of one robot's plan: one upload at a time, and any number of downloads.

    Args:
        run: stores the plan and executes it.
        announce: sends texts to people.
    """

    def __init__(self, run: MissionRun, announce: Announce) -> None:
        self._run = run
        self._announce = announce
        self._upload: _Upload | None = None
        self._downloads = MissionDownloads(run)
        self._completed: _Completed | None = None
        self._tick = 0

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterator[OutgoingMessage]:
        """Answer a message of this protocol."""
        peer = MissionPeer(link, sender)
        match message:
            case mav.MAVLink_mission_count_message():
                yield from self._handle_count(peer, message.count, message.mission_type)
            case mav.MAVLink_mission_write_partial_list_message():
                first, last = message.start_index, message.end_index
                yield from self._handle_partial(peer, first, last, message.mission_type)
            case mav.MAVLink_mission_item_int_message() | mav.MAVLink_mission_item_message():
                if message.current not in _GUIDED:
                    yield from self._handle_item(peer, message)
            case mav.MAVLink_mission_request_list_message():
                self._completed = None
                yield self._downloads.begin(peer, message.mission_type)
            case mav.MAVLink_mission_request_int_message() | mav.MAVLink_mission_request_message():
                yield self._downloads.item(peer, message)
            case mav.MAVLink_mission_request_partial_list_message():
                yield peer.ack(mav.MAV_MISSION_UNSUPPORTED, message.mission_type)
            case mav.MAVLink_mission_clear_all_message():
                yield from self._handle_clear(peer, message.mission_type)
            case mav.MAVLink_mission_set_current_message():
                yield from self._handle_set_current(peer, message.seq)
            case mav.MAVLink_mission_ack_message(mission_type=mav.MAV_MISSION_TYPE_MISSION):
                yield from self._handle_ack(peer, message.type)

    def step(self, tick: int, readings: RobotReadings) -> Iterator[OutgoingMessage]:
        """Request a missing item again, and advance the mission."""
        self._tick = tick
        self._downloads.step(tick)
        yield from self._uploaded(tick)
        yield from self._run.step(tick, readings)

    def forget(self, link: LinkId) -> None:
        """Forget a closed link and its transfers."""
        if self._upload is not None and self._upload.peer.link == link:
            self._upload = None
        if self._completed is not None and self._completed.peer.link == link:
            self._completed = None
        self._downloads.forget(link)

    def _uploaded(self, tick: int) -> Iterator[OutgoingMessage]:
        upload = self._upload
        if upload is None or tick - upload.asked < ITEM_TIMEOUT:
            return
        if upload.retries == RETRIES:
            self._upload = None
            yield upload.peer.ack(mav.MAV_MISSION_OPERATION_CANCELLED)
            return
        upload.retries += 1
        if not upload.items:
            # Before the first item arrives, it is unknown which form of items the station supports.
            upload.old_form = upload.retries >= TRIES_OF_NEW_FORM
        yield self._next_request(upload)

    def _handle_count(self, peer: MissionPeer, count: int, mission_type: int) -> Iterator[OutgoingMessage]:
        if mission_type in EMPTY_TYPES and count == 0:
            yield peer.ack(mav.MAV_MISSION_ACCEPTED, mission_type)
        elif mission_type != MISSION:
            yield peer.ack(mav.MAV_MISSION_UNSUPPORTED, mission_type)
        elif (denied := self._objection(peer)) is not None:
            yield from self._refused(peer, denied)
        elif count > LONGEST:
            self._upload = None
            yield peer.ack(mav.MAV_MISSION_NO_SPACE)
        elif count == 0:
            yield from self._complete(peer, ())
        else:
            yield self._begin(_Upload(peer, (), (), count, self._tick))

    def _handle_partial(self, peer: MissionPeer, first: int, last: int, mission_type: int) -> Iterator[OutgoingMessage]:
        plan = self._run.plan
        # -1 means the end of the list. Some stations send an index behind the end of the list.
        last = len(plan) - 1 if last == -1 else min(last, len(plan) - 1)
        if mission_type != MISSION:
            yield peer.ack(mav.MAV_MISSION_UNSUPPORTED, mission_type)
        elif (denied := self._objection(peer)) is not None:
            yield from self._refused(peer, denied)
        elif not 0 <= first <= last:
            yield peer.ack(mav.MAV_MISSION_INVALID_SEQUENCE)
        else:
            count = last - first + 1
            yield self._begin(_Upload(peer, plan[:first], plan[last + 1 :], count, self._tick))

    def _handle_item(self, peer: MissionPeer, message: _ItemMessage) -> Iterator[OutgoingMessage]:
        upload = self._upload
        if message.mission_type != MISSION:
            yield peer.ack(mav.MAV_MISSION_UNSUPPORTED, message.mission_type)
        elif upload is None:
            yield from self._late_item(peer, message.seq)
        elif upload.peer != peer:
            yield peer.ack(mav.MAV_MISSION_DENIED)
        elif message.seq > upload.next:
            yield self._next_request(upload)
        elif message.seq == upload.next:
            yield from self._next_item(upload, message)
        else:
            # This is a repeated item. The station has missed the last request, but it is still connected.
            upload.retries = 0

    def _late_item(self, peer: MissionPeer, seq: int) -> Iterator[OutgoingMessage]:
        """Answer an item that arrives outside an upload."""
        if self._completed is None or self._completed.peer != peer:
            yield peer.ack(mav.MAV_MISSION_ERROR)
        # The acknowledgement of the completed upload was lost.
        elif self._completed.last == seq:
            yield peer.ack(mav.MAV_MISSION_ACCEPTED, plan=self._run.plan_id)

    def _next_item(self, upload: _Upload, message: _ItemMessage) -> Iterator[OutgoingMessage]:
        item = self._admitted(message, upload.size)
        if isinstance(item, InvalidItem):
            self._upload = None
            yield upload.peer.ack(item.result)
            self._announce(TextSeverity.WARNING, f"Mission refused: in item {message.seq}, {item.sentence}.")
            return
        upload.items.append(item)
        upload.retries = 0
        if len(upload.items) < upload.count:
            yield self._next_request(upload)
        # Another station may have started the mission during the upload.
        elif (denied := self._run.objection(upload.peer.station)) is not None:
            yield from self._refused(upload.peer, denied)
        else:
            yield from self._complete(upload.peer, (*upload.kept_before, *upload.items, *upload.kept_after))
            self._completed = _Completed(upload.peer, message.seq)

    def _admitted(self, message: _ItemMessage, size: int) -> MissionItem | InvalidItem:
        item = item_of(message)
        # ArduPilot's home item is only a placeholder, so its content is not checked.
        if isinstance(item, InvalidItem) or self._run.is_home(message.seq):
            return item
        if (invalid := unfit(item, size)) is not None:
            return invalid
        denied = self._run.execution.misplaced(item)
        return item if denied is None else misplaced(denied)

    def _handle_clear(self, peer: MissionPeer, mission_type: int) -> Iterator[OutgoingMessage]:
        if mission_type in EMPTY_TYPES:
            yield peer.ack(mav.MAV_MISSION_ACCEPTED, mission_type)
        elif mission_type not in (MISSION, mav.MAV_MISSION_TYPE_ALL):
            yield peer.ack(mav.MAV_MISSION_UNSUPPORTED, mission_type)
        elif (denied := self._objection(peer)) is not None:
            yield from self._refused(peer, denied, mission_type)
        else:
            yield from self._complete(peer, (), mission_type)

    def _handle_set_current(self, peer: MissionPeer, seq: int) -> Iterator[OutgoingMessage]:
        denied = self._run.objection(peer.station) or self._run.select(seq)
        if denied is None:
            yield OutgoingMessage(self._run.current())
        else:
            self._announce(TextSeverity.WARNING, f"Mission item not set. {denied.sentence}")

    def _handle_ack(self, peer: MissionPeer, result: int) -> Iterator[OutgoingMessage]:
        """Process the end of a transfer by the station, successful or not."""
        self._downloads.end(peer)
        upload = self._upload
        if upload is None or upload.peer != peer or result == mav.MAV_MISSION_ACCEPTED:
            return
        if upload.old_form and not upload.items and result == mav.MAV_MISSION_UNSUPPORTED:
            # The station does not support MISSION_ITEM. This form was requested because it had not answered.
            upload.old_form, upload.retries = False, 0
            yield self._next_request(upload)
        else:
            self._upload = None

    def _objection(self, peer: MissionPeer) -> Denied | None:
        """Return the reason why this station may not change the plan now, or None."""
        if self._upload is not None and self._upload.peer != peer:
            return Denied(f"A mission of {self._upload.peer.station} is coming in.", DenialKind.NOT_NOW)
        return self._run.objection(peer.station)

    def _refused(self, peer: MissionPeer, denied: Denied, mission_type: int = MISSION) -> Iterator[OutgoingMessage]:
        """Refuse to change the plan. If the station has an upload in progress, abort it."""
        if self._upload is not None and self._upload.peer == peer:
            self._upload = None
        self._announce(TextSeverity.WARNING, f"Mission refused. {denied.sentence}")
        yield peer.ack(mav.MAV_MISSION_DENIED, mission_type)

    def _begin(self, upload: _Upload) -> OutgoingMessage:
        """Start an upload. An earlier upload of the same station is aborted."""
        self._upload, self._completed = upload, None
        return self._next_request(upload)

    def _next_request(self, upload: _Upload) -> OutgoingMessage:
        """Return the request for the next item."""
        upload.asked = self._tick
        request = mav.MAVLink_mission_request_message if upload.old_form else mav.MAVLink_mission_request_int_message
        return OutgoingMessage(request(*upload.peer.target, upload.next, MISSION), upload.peer.link)

    def _complete(
        self, peer: MissionPeer, plan: tuple[MissionItem, ...], mission_type: int = MISSION
    ) -> Iterator[OutgoingMessage]:
        """Replace the robot's plan and acknowledge the upload."""
        self._upload, self._completed = None, None
        self._downloads.end(peer)
        self._run.replace(plan)
        yield peer.ack(mav.MAV_MISSION_ACCEPTED, mission_type, self._run.plan_id)
        yield OutgoingMessage(self._run.current())

"""Links of stations that send more than the session has time for, without sockets; time is the test's."""

import asyncio
from collections.abc import Sequence

import pytest

from sim.common.observations import TICK
from thbridge.mavlink.sockets.links import LINK_FRAMES, MOST_WAITING, TICK_ANSWERS, WORK_SECONDS, MavlinkLinks
from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.framer import FrameParser
from thbridge.mavlink.wire.links import HubLink
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.mavlink.wire.traffic import FrameOutcome, OutgoingFrame

MEGABIT = 125_000
"""Bytes of a second."""


class Watch:
    """A stopwatch that stands still, but for what work takes."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


class Exchange:
    """Takes some time for each frame."""

    def __init__(self, watch: Watch, cost: float) -> None:
        self.received: list[tuple[LinkId, Frame]] = []
        self._watch, self._cost = watch, cost
        self._opened = 0
        self.answers = 0

    def open_link(self, name: str, robot: int | None = None) -> LinkId:
        self._opened += 1
        return LinkId(self._opened)

    def close_link(self, link: LinkId) -> None:
        """As sessions do."""

    def link(self, link: LinkId) -> HubLink | None:
        return HubLink("link", 250, robot=2)

    def receive_frame(self, link: LinkId, frame: Frame) -> FrameOutcome:
        self.received.append((link, frame))
        self._watch.now += self._cost
        return FrameOutcome(replies=[OutgoingFrame(link, frame)] * self.answers)


class Rig:
    """Links with a session, to be told what comes in."""

    def __init__(self, cost: float = 0.0) -> None:
        self.watch = Watch()
        self.exchange = Exchange(self.watch, cost)
        self.links = MavlinkLinks(None, stopwatch=self.watch)
        self.links.serve(self.exchange)
        self.sent: list[bytes] = []

    def open(self) -> LinkId:
        link = self.links.open("udp 127.0.0.1:14550", self.links.channel(datagrams=True), self)
        assert link is not None
        return link

    def send_frames(self, frames: Sequence[bytes]) -> int:
        self.sent += frames
        return 0

    def next_tick(self) -> None:
        self.watch.now = (int(self.watch.now / TICK) + 1.5) * TICK


def frame(message: mav.MAVLink_message, sequence: int = 0) -> Frame:
    number = message.get_msgId()
    return Frame(255, 190, sequence % 256, number, payload_of(message), crc_extra(number) or 0)


HEARTBEAT = frame(mav.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
BUSY_STATION = [
    HEARTBEAT,
    frame(mav.MAVLink_mission_item_int_message(1, 1, 7, 3, 16, 0, 1, 0.0, 0.0, 0.0, 0.0, 515000000, -1000000, 1.0, 0)),
    frame(mav.MAVLink_param_set_message(1, 1, b"SIM_SPEED", 1.0, 9)),
    frame(mav.MAVLink_file_transfer_protocol_message(0, 1, 1, [1] * 251)),
    frame(mav.MAVLink_manual_control_message(1, 1, 1, 1, 1, 1)),
    frame(mav.MAVLink_command_long_message(1, 1, 512, 0, 148, 1, 1, 1, 1, 1, 1)),
]


@pytest.mark.parametrize("mix", [BUSY_STATION, [HEARTBEAT]])
def test_a_megabit_of_a_station_is_handled_tick_by_tick(mix: list[Frame]) -> None:
    rig = Rig()
    link = rig.open()
    number = carried = 0
    while carried < MEGABIT:
        due, given = carried + MEGABIT * TICK, []
        while carried < due:
            given.append(mix[number % len(mix)])
            carried += len(given[-1].to_bytes())
            number += 1
        rig.links.receive(link, given)
        assert len(rig.exchange.received) == number
        rig.next_tick()
    assert rig.links.totals.dropped == 0


def test_what_came_while_the_session_was_busy_is_handled_later_and_not_lost() -> None:
    async def whole() -> None:
        rig = Rig()
        link = rig.open()
        behind = [frame(mav.MAVLink_ping_message(1, number, 0, 0)) for number in range(1000)]  # of a fifth of a second
        rig.links.receive(link, behind)
        assert len(rig.exchange.received) == LINK_FRAMES
        while len(rig.exchange.received) < 1000:
            rig.next_tick()
            await asyncio.sleep(0)
            rig.links.receive(link, [])
        assert [each for _, each in rig.exchange.received] == behind
        assert rig.links.totals.dropped == 0

    asyncio.run(whole())


def test_a_flood_takes_its_share_of_a_tick_and_is_told_once_to_log_and_link(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def whole() -> None:
        rig = Rig(cost=100e-6)
        link = rig.open()
        for _ in range(100):
            before, begun = len(rig.exchange.received), rig.watch.now
            rig.links.receive(link, [HEARTBEAT] * 300)  # 15,000 a second
            assert len(rig.exchange.received) - before <= LINK_FRAMES
            assert rig.watch.now - begun <= WORK_SECONDS + 200e-6
            rig.next_tick()
        assert len(rig.exchange.received) >= 100 * 35
        lost = 100 * 300 - len(rig.exchange.received) - MOST_WAITING
        assert lost <= rig.links.totals.dropped <= lost + LINK_FRAMES
        assert len([line for line in caplog.messages if "sends too many frames; some frames are dropped" in line]) == 1
        (told,) = [found for sent in rig.sent for found in FrameParser().receive_data(sent)]
        assert isinstance(told, Frame)
        assert (told.system, told.component, told.message_id) == (3, mav.MAV_COMP_ID_UDP_BRIDGE, 253)

    asyncio.run(whole())


def test_answers_have_a_share_of_a_tick_too() -> None:
    async def whole() -> None:
        rig = Rig()
        rig.exchange.answers = 8
        link = rig.open()
        rig.links.receive(link, [HEARTBEAT] * 100)
        assert len(rig.exchange.received) == -(-TICK_ANSWERS // 8)
        rig.next_tick()
        rig.links.receive(link, [])
        assert len(rig.exchange.received) == 2 * -(-TICK_ANSWERS // 8)

    asyncio.run(whole())


def test_others_are_heard_at_once_beside_a_flood() -> None:
    async def whole() -> None:
        rig = Rig(cost=10e-6)
        loud, quiet = rig.open(), rig.open()
        for _ in range(5):
            rig.links.receive(loud, [HEARTBEAT] * 3000)
            rig.links.receive(quiet, [HEARTBEAT])
            assert rig.exchange.received[-1] == (quiet, HEARTBEAT)
            rig.next_tick()

    asyncio.run(whole())

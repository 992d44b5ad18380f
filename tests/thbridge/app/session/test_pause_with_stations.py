"""A researcher pauses a session while a ground station listens: it goes on hearing that the robots are there."""

import asyncio
import socket
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from thbridge.app.compose.setting import read_setting
from thbridge.app.listeners import StartupCallbacks, WatchAddress
from thbridge.app.play import HuntUnfinished, PlayOptions, play
from thbridge.app.replay.replay import ReplayOptions, replay, ticks_of
from thbridge.app.session.inputs import HeartbeatsSent
from thbridge.app.session.session import TickRecord
from thbridge.app.session.watch_requests import request_line
from thbridge.mavlink.sockets.server import MavlinkPorts
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.framer import parse_datagram
from thbridge.roles.shared.robot_requests import PaceRequest, Pause, Resume
from thbridge.sockets.addresses import Address, ListeningAddress, UdpTarget
from thbridge.sockets.errors import CannotListen
from thbridge.study.mavlink import MavlinkSection
from thbridge.study.study_file import Study
from thbridge.watching.sockets.client import WatchClient

BEATS = 2
PATIENCE = 300
STUDY = replace(Study(), server=replace(Study().server, port=0), mavlink=MavlinkSection(on=True))
OUTSIDE = frozenset({"TabUI"})


class Afternoon:
    """A hunt that nobody plays, a station that says nothing, and a researcher who pauses while it listens."""

    def __init__(self, bag: Path) -> None:
        self.bag = bag
        self.tick = 0
        self._station = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._station.bind(("127.0.0.1", 0))
        self._station.setblocking(False)
        self._client: WatchClient | None = None
        self._tasks: list[asyncio.Task[None]] = []

    async def pass_by(self) -> None:
        ports = MavlinkPorts((UdpTarget(Address("127.0.0.1", self._station.getsockname()[1])),), None, None)
        watch = WatchAddress("127.0.0.1", 0, None)
        options = PlayOptions(1.0, self.bag, OUTSIDE, "", 2.0, watch=watch, mavlink=ports)
        told = StartupCallbacks(lambda master: None, self._come)
        with self._station, pytest.raises(HuntUnfinished):
            async with asyncio.timeout(PATIENCE):
                await play(read_setting(STUDY, Path()), (), options, lambda where: None, self._passed, told)
        for task in self._tasks:
            task.cancel()

    def _passed(self, tick_record: TickRecord) -> None:
        self.tick = tick_record.tick

    def _come(self, where: ListeningAddress | CannotListen) -> None:
        assert isinstance(where, ListeningAddress)
        self._client = WatchClient(where.host, where.port)
        self._tasks += [asyncio.ensure_future(self._client.run()), asyncio.ensure_future(self._pause())]

    async def _pause(self) -> None:
        await self._heard_in_one_tick(0)
        await self._wish(Pause())
        await self._heard_in_one_tick(BEATS)
        await self._wish(Resume())

    async def _wish(self, request: PaceRequest) -> None:
        while self._client is None or not self._client.send(request_line("researcher", request)):
            await asyncio.sleep(0)

    async def _heard_in_one_tick(self, beats: int) -> None:
        """Listen until every robot has said so many heartbeats in a row without a tick between them."""
        heard, tick = Counter[int](), self.tick
        while min(heard[1], heard[2]) < beats or not heard:
            data = await asyncio.get_running_loop().sock_recv(self._station, 65535)
            if tick != self.tick:
                heard, tick = Counter(), self.tick
            for frame in parse_datagram(data):
                if isinstance(frame, Frame) and frame.message_id == mav.MAVLINK_MSG_ID_HEARTBEAT:
                    heard[frame.system] += 1


def test_heartbeats_go_on_in_a_pause_and_are_said_again_in_a_replay(tmp_path: Path) -> None:
    afternoon = Afternoon(tmp_path / "hunt.bag")
    asyncio.run(afternoon.pass_by())
    recorded = [item for tick in ticks_of(afternoon.bag) for item in tick.inputs]
    assert recorded.count(HeartbeatsSent()) >= BEATS
    done = asyncio.run(
        replay(
            afternoon.bag, read_setting(STUDY, Path()), ReplayOptions(0.0, 0.0, None, False), lambda tick_record: None
        )
    )
    assert (done.difference, done.ticks) == (None, 100)

"""Companions of a session: a participant, a watcher, a ROS node and a MAVLink station, each in a separate program."""

import argparse
import asyncio
import dataclasses
import json
import time
from collections import Counter
from collections.abc import Callable, Coroutine, Mapping, Sequence
from pathlib import Path

from sim.common.geometry import Pose2
from sim.common.observations import TICK
from sim.inputs import ClearCostmaps
from thbridge.app.compose.game import build_bot
from thbridge.app.programs import exchange
from thbridge.app.session.watch_requests import request_line
from thbridge.dialogue.games.strategies import Attitude
from thbridge.files.resources import shipped
from thbridge.files.template_files import read_template_set
from thbridge.mavlink.sockets.client import open_station
from thbridge.mavlink.station.ground_station import GroundStation
from thbridge.mavlink.station.trip import StationTrip
from thbridge.mavlink.values.vehicle_interface import Target
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import ParticipantRequest, PlayAgain, View
from thbridge.rosgraph.sockets.node import RosNode
from thbridge.sockets.addresses import Address
from thbridge.sockets.reconnecting import ConnectionLost
from thbridge.text_protocol.sockets.client import TextClient
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import is_notice
from thbridge.watching.sockets.client import WatchClient, WatchConnected
from thbridge.watching.wire import SessionMessage, parse_status

HOST = "127.0.0.1"
PASSES = 10.0
"""Seconds between two requests of the watcher, and between the starts of two short-lived nodes."""
TOLD = 2.0
"""Seconds between two reports of a companion."""
CORRIDOR = (Pose2(0.0, 1.0, 0.0), Pose2(4.0, 1.0, 0.0), Pose2(6.0, 1.0, 0.0))
"""Places in arena8 to which the station drives robots."""

Counts = Counter[str]


class PlaysAgain:
    """Player that starts another game after each game."""

    def __init__(self, counts: Counts) -> None:
        self._counts = counts
        self._templates = read_template_set(shipped().find("templates", "original-2016", Path()))
        self._game = -1

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """See `Player`."""
        if view.over is not None:
            self._counts["over"] = view.game
            return (PlayAgain(view.game),)
        if view.game != self._game:
            self._game = view.game
            self._bot = build_bot(self._templates, BotStrategy.SUGGESTION, view.game, Attitude.CREDULOUS)
        return self._bot.requests(view)


class SecondSeat:
    """Role TabUI with another name, so that it can play in addition to a participant's window."""

    def __init__(self, role: TabUI, name: str) -> None:
        self._role = role
        self._name = name
        self._began = time.monotonic()
        self._messages: list[TextMessage] = []

    def connected(self) -> None:
        """See `RoleRunner`, also for the next two methods."""
        self._role.connected()

    def receive(self, message: TextMessage) -> None:
        """Keep a message for the next step."""
        self._messages.append(message)

    def step(self) -> Sequence[TextMessage]:
        """Return the role's messages. The server accepts a notice only if its sender has the name of the connection."""
        messages, self._messages = self._messages, []
        said = self._role.step(int((time.monotonic() - self._began) / TICK), messages)
        return [dataclasses.replace(each, sender=self._name) if is_notice(each) else each for each in said]


async def participate(counts: Counts, given: argparse.Namespace) -> None:
    """Play games, one after the other."""
    client = TextClient(given.name, "1", HOST, given.text)

    def lost(loss: ConnectionLost) -> None:
        counts["lost"] += 1

    runner = SecondSeat(TabUI(PlaysAgain(counts)), given.name)
    async with client.running():
        while True:
            exchange(runner, client, lost)
            await asyncio.sleep(0.005)


async def watch(counts: Counts, given: argparse.Namespace) -> None:
    """Watch the session like a researcher's window, and send a request every `PASSES` seconds."""
    client = WatchClient(HOST, given.watch)
    running = asyncio.create_task(client.run())
    asked = time.monotonic()
    while not running.done():
        for event in client.take():
            match event:
                case WatchConnected():
                    counts["connected"] += 1
                case ConnectionLost():
                    counts["lost"] += 1
                case SessionMessage():
                    status = parse_status(event)
                    if status is None:
                        counts["stamp_ms"] = event.stamp_ns // 1_000_000
                    else:
                        counts["dropped"] = status.dropped
        if time.monotonic() - asked > PASSES:
            asked = time.monotonic()
            counts["asked"] += 1
            client.send(request_line("long run", ClearCostmaps(counts["asked"] % given.robots)))
        await asyncio.sleep(0.02)


async def subscribe(counts: Counts, given: argparse.Namespace) -> None:
    """Subscribe to the poses of all robots; also start and stop short-lived nodes."""
    topics = ["/tf", *(f"/robot{each + 1}/amcl_pose" for each in range(given.robots))]

    def count(_data: bytes, _publisher: str) -> None:
        counts["messages"] += 1

    async def node(name: str, heard: Sequence[str]) -> RosNode:
        made = RosNode(name, f"http://{HOST}:{given.ros}")
        for topic in heard:
            made.subscribe(topic, "*", "*", count)
        await made.start()
        return made

    await node("/long_run", topics)
    while True:
        await asyncio.sleep(PASSES)
        passing = await node(f"/passing{counts['passed']}", topics[:2])
        await passing.registered()
        await asyncio.sleep(1.0)
        await passing.stop()
        counts["passed"] += 1


async def command(counts: Counts, given: argparse.Namespace) -> None:
    """Send heartbeats. After pauses of 30 s, take command of a robot, drive it to a place, and release it."""
    async with open_station(Address(HOST, given.mavlink), True, None) as link:
        link.station = station = GroundStation()
        began, trips = time.monotonic(), 0
        trip: StationTrip | None = None
        while True:
            events, now = await link.poll(), time.monotonic()
            counts["frames"] = sum(each.frames for each in station.robots.values())  # sum of integers
            if trip is not None:
                trip.advance(events, now)
                if trip.outcome is not None:
                    counts["trips"] += 1
                    trip, began = None, now
            elif len(station.robots) == given.robots and now - began > 3 * PASSES:
                place = CORRIDOR[trips % len(CORRIDOR)]
                trip = StationTrip(station, 1 + trips % given.robots, Target(place.x, place.y), False, now)
                trips += 1


COMPANIONS: Mapping[str, Callable[[Counts, argparse.Namespace], Coroutine[None, None, None]]] = {
    "participant": participate,
    "watcher": watch,
    "node": subscribe,
    "station": command,
}


async def accompany(given: argparse.Namespace) -> None:
    """Run a companion until the process ends, and write its counts to a file that the sampler reads."""
    counts: Counts = Counter()

    async def report() -> None:
        path = given.folder / f"{given.companion}.json"
        while True:
            beside = path.with_suffix(".new")
            beside.write_text(json.dumps(counts))
            beside.replace(path)
            await asyncio.sleep(TOLD)

    async with asyncio.TaskGroup() as group:
        group.create_task(report())
        group.create_task(COMPANIONS[given.companion](counts, given))

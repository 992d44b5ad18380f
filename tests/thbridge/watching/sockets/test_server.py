"""The watch door over real TCP, and the client that goes through it."""

import asyncio
import contextlib
import json
import socket
import struct
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from tests.support.hunts.granting_house import GrantingHouse
from tests.support.programs.event_loops import in_event_loop
from thbridge.files.keys.key_file import ClientKey
from thbridge.files.ros.definitions import Definitions
from thbridge.ros.messages import pack, types, unpack
from thbridge.ros.messages.records import Record, SendRobots, Success
from thbridge.ros.messages.session_records import DialogueStateRecord, GameEvent
from thbridge.ros.publisher import messages_of
from thbridge.ros.topics import GAME_EVENTS, SEND_ROBOTS, SUCCESS, RosMessage, Topic
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.keys import SingleKey
from thbridge.sockets.reconnecting import Backoff, ConnectionLost, LossReason
from thbridge.watching.sockets import server as watch_server
from thbridge.watching.sockets.client import WatchClient, WatchConnected, WatchEvent
from thbridge.watching.sockets.history import MAX_BYTES, MAX_MESSAGES, MessageHistory
from thbridge.watching.sockets.server import MAX_CONNECTIONS, MAX_WATCHERS, WatchServer
from thbridge.watching.wire import MISTAKES, STATUS, BagStreamReader, SessionMessage, WatchStatus, parse_status

PATIENCE = 120
SECOND = 1_000_000_000
LEVEL = Topic("/level", types.STRING, latched=True)
OTHER = Topic("/other", types.STRING, latched=True)
EVENT = Topic("/event", types.STRING)
HEAVY = Topic("/heavy", types.STRING)
SOON = Backoff(initial=0.01, maximum=0.05, timeout=10.0)


def event(kind: str, room: int | None = None) -> GameEvent:
    return GameEvent(kind, None, room, "{}")


class Door:
    """A door, and those who go through it in one test."""

    def __init__(self, key: str | None) -> None:
        self.house = GrantingHouse()
        keys = None if key is None else SingleKey(key)
        self.server = WatchServer(self.house, keys, Definitions(()), Path("hunt.bag"))
        self.where = ListeningAddress("", 0)
        self.tick = 0
        self.clients: list[asyncio.Task[None]] = []

    def say(self, *said: tuple[Topic, str]) -> None:
        self.tick += 1
        self.server.take(self.tick, [RosMessage(topic, self.tick * SECOND, pack.string(text)) for topic, text in said])

    def tell(self, *records: Record) -> None:
        self.tick += 1
        stamp = self.tick * SECOND
        self.server.take(self.tick, [said for record in records for said in messages_of(stamp, self.tick, record)])

    def enter(self, key: str | None = None) -> "Visitor":
        visitor = Visitor(WatchClient(self.where.host, self.where.port, None if key is None else ClientKey(key), SOON))
        self.clients.append(asyncio.ensure_future(visitor.client.run()))
        return visitor


class Visitor:
    """A client, and what it has heard."""

    def __init__(self, client: WatchClient) -> None:
        self.client = client
        self.events: list[WatchEvent] = []

    async def until(self, true: Callable[[], bool]) -> None:
        async with asyncio.timeout(PATIENCE):
            while not true():
                self.events += self.client.take()
                await asyncio.sleep(0.005)

    async def until_heard(self, kind: type) -> None:
        await self.until(lambda: any(isinstance(event, kind) for event in self.events))

    async def until_text(self, text: str) -> None:
        await self.until(lambda: text in [said for _, said in self.texts])

    async def until_status(self, true: Callable[[WatchStatus], bool]) -> None:
        await self.until(lambda: any(true(status) for status in self.statuses))

    @property
    def texts(self) -> list[tuple[str, str]]:
        said = [event for event in self.events if isinstance(event, SessionMessage) and event.topic != STATUS]
        return [(event.topic, event.data[4:].decode()) for event in said]

    @property
    def statuses(self) -> list[WatchStatus]:
        found = [parse_status(event) for event in self.events if isinstance(event, SessionMessage)]
        return [status for status in found if status is not None]

    @property
    def losses(self) -> list[ConnectionLost]:
        return [event for event in self.events if isinstance(event, ConnectionLost)]

    def ask(self, **wish: object) -> None:
        assert self.client.send(json.dumps(wish).encode() + b"\n")


@asynccontextmanager
async def serving(key: str | None = None) -> AsyncIterator[Door]:
    door = Door(key)
    where = await door.server.start("127.0.0.1", 0)
    assert isinstance(where, ListeningAddress)
    door.where = where
    try:
        yield door
    finally:
        for client in door.clients:
            client.cancel()
        async with asyncio.timeout(PATIENCE):
            await door.server.stop()


@in_event_loop
async def test_who_comes_late_hears_what_is_in_force_then_the_latest_tick_then_all() -> None:
    async with serving() as door:
        door.say((LEVEL, "old"), (OTHER, "other"))
        door.say((EVENT, "missed"), (LEVEL, "level"))
        door.say((OTHER, "newer"), (EVENT, "just now"))
        visitor = door.enter()
        await visitor.until_text("just now")
        door.say((LEVEL, "next"), (EVENT, "event"))
        await visitor.until_text("event")
        assert visitor.texts == [
            ("/level", "level"), ("/other", "newer"), ("/event", "just now"), ("/level", "next"), ("/event", "event"),
        ]  # fmt: skip
        stamps = [event.stamp_ns for event in visitor.events if isinstance(event, SessionMessage)]
        assert stamps == sorted(stamps)
        assert isinstance(visitor.events[0], WatchConnected)


@in_event_loop
async def test_who_comes_late_hears_the_game_so_far_and_how_things_are() -> None:
    async with serving() as door:
        door.say((LEVEL, "level"), (EVENT, "how it is"))
        door.tell(event("started"), event("arrived", 5), SendRobots("of the game before"))
        door.tell(event("ended"))
        door.tell(event("started"), SendRobots("go to 3"), event("departed", 3))
        door.tell(Success("there"), event("arrived", 3))
        door.tell(event("departed", 1))
        visitor = door.enter()
        await visitor.until_status(lambda status: True)
        heard = [message for message in visitor.events if isinstance(message, SessionMessage)]
        events = [unpack.game_event(each.data) for each in heard if each.topic == GAME_EVENTS.name]
        assert [(each.kind, each.room) for each in events] == [
            ("started", None), ("departed", 3), ("arrived", 3), ("departed", 1)
        ]  # fmt: skip
        lines = [unpack.string(each.data) for each in heard if each.topic in {SEND_ROBOTS.name, SUCCESS.name}]
        assert lines == ["of the game before", "go to 3", "there"]
        levels = [unpack.string(each.data) for each in heard if each.topic in {LEVEL.name, EVENT.name}]
        assert levels == ["level", "how it is"]
        stamps = [each.stamp_ns for each in heard if each.topic != STATUS]
        assert stamps == sorted(stamps)


def test_what_is_kept_for_latecomers_is_bounded_and_what_is_frequent_pushes_out_nothing_else() -> None:
    history = MessageHistory()
    for record in (event("started"), event("arrived", 3), *[event("collision")] * (2 * MAX_MESSAGES)):
        for message in messages_of(0, 0, record):
            history.take(message)
    for _ in range(40):
        for message in messages_of(0, 0, SendRobots("x" * (MAX_BYTES // 10))):
            history.take(message)
    kept = history.before(())
    events = [unpack.game_event(each.data).kind for each in kept if each.topic == GAME_EVENTS]
    assert events == ["started", "arrived", *["collision"] * MAX_MESSAGES]
    assert sum(each.topic == SEND_ROBOTS for each in kept) == 9


def test_who_comes_late_hears_what_every_robot_has_argued_and_makes_of_it() -> None:
    history = MessageHistory()
    said = [DialogueStateRecord(talk, talk % 2, "{}") for talk in range(1, 5)]
    for record in said:
        for message in messages_of(0, 0, record):
            history.take(message)
    assert [unpack.dialogue_state(each.data) for each in history.before(())] == said


@in_event_loop
async def test_wishes_are_passed_on_and_what_is_refused_is_told_to_who_asked() -> None:
    async with serving() as door:
        door.say((LEVEL, "level"))
        one, other = door.enter(), door.enter()
        await one.until_status(lambda status: status.watchers == 2)
        await other.until_heard(WatchConnected)
        one.ask(request="Nonsense")
        one.client.send(b"nonsense\n")
        await one.until_status(lambda status: status.refusals == 2)
        other.ask(request="Pause")
        door.house.paused = True
        await other.until_status(lambda status: status.paused)
        assert sorted(wish["request"] for _, wish in door.house.asked) == ["Nonsense", "Pause"]
        refused = [status.refused for status in one.statuses if status.refused is not None]
        assert (refused[0].request, refused[0].reason) == ('{"request": "Nonsense"}', "no")
        assert (refused[-1].request, refused[-1].reason) == ("nonsense", "the line is not a JSON object")
        assert {status.refused for status in other.statuses} == {None}
        assert {status.lag for status in other.statuses} == {0.25}


@in_event_loop
async def test_who_goes_on_asking_for_what_cannot_be_is_cut_off() -> None:
    async with serving() as door:
        door.say((LEVEL, "level"))
        visitor = door.enter()
        await visitor.until_heard(WatchConnected)
        for _ in range(MISTAKES + 5):
            visitor.ask(request="No")
        await visitor.until_heard(ConnectionLost)
        assert visitor.losses[0] == ConnectionLost(LossReason.BROKEN, "the session closed the connection")
        assert len(door.house.asked) == MISTAKES
        assert door.house.left_alone == 1


@in_event_loop
async def test_only_who_knows_the_key_gets_in() -> None:
    async with serving("sesame") as door:
        door.say((LEVEL, "level"))
        right, wrong = door.enter("sesame"), door.enter("open")
        await right.until_text("level")
        await wrong.until_heard(ConnectionLost)
        assert wrong.losses == [ConnectionLost(LossReason.REFUSED, "the key is wrong")]
        assert wrong.texts == []
        reader, writer = await asyncio.open_connection(door.where.host, door.where.port)
        writer.write(b'{"request":"Pause"}\n')
        async with asyncio.timeout(PATIENCE):
            told = await reader.read()
        writer.close()
        assert b"a key is required" in told
        assert b"level" not in told
        assert door.house.asked == []


@in_event_loop
async def test_a_ninth_is_turned_away_until_somebody_leaves() -> None:
    async with serving() as door:
        door.say((LEVEL, "level"))
        visitors = [door.enter() for _ in range(MAX_WATCHERS)]
        await visitors[-1].until_status(lambda status: status.watchers == MAX_WATCHERS)
        ninth = door.enter()
        await ninth.until_heard(ConnectionLost)
        assert ninth.losses[0].reason is LossReason.REFUSED
        assert ninth.texts == []
        door.clients[0].cancel()
        await ninth.until_text("level")


@in_event_loop
async def test_a_crowd_without_the_key_keeps_nobody_out() -> None:
    async with serving("sesame") as door:
        door.say((LEVEL, "level"))
        first = door.enter("sesame")
        await first.until_text("level")
        crowd = [await asyncio.open_connection(door.where.host, door.where.port) for _ in range(MAX_CONNECTIONS + 5)]
        async with asyncio.timeout(PATIENCE):
            for reader, _ in crowd[:6]:
                with contextlib.suppress(ConnectionError):
                    assert await reader.read() == b""
        visitor = door.enter("sesame")
        await visitor.until_text("level")
        assert len(door.server._open) == MAX_CONNECTIONS
        door.say((LEVEL, "still there"))
        await first.until_text("still there")
        for _, writer in crowd:
            writer.close()


@in_event_loop
async def test_who_shows_wrong_keys_waits_and_may_not_try_others_meanwhile() -> None:
    async with serving("sesame") as door:
        reader, writer = await asyncio.open_connection(door.where.host, door.where.port)
        writer.write(b'{"key":"open"}\n{"key":"sesame"}\n')
        began = asyncio.get_running_loop().time()
        async with asyncio.timeout(PATIENCE):
            told = await reader.read()
        writer.close()
        assert b"the key is wrong" in told
        assert asyncio.get_running_loop().time() - began >= watch_server._WRONG_KEY_SECONDS
        assert door.house.asked == []


@in_event_loop
async def test_who_does_not_read_loses_of_the_heaviest_topic_and_nobody_else_does() -> None:
    async with serving() as door:
        door.say((LEVEL, "level"))
        quick = door.enter()
        reader, writer = await asyncio.open_connection(door.where.host, door.where.port, limit=1024)
        await quick.until_status(lambda status: status.watchers == 2)
        for number in range(40):
            door.say((EVENT, f"event {number}"), (HEAVY, "x" * 2**20))
            if number % 5 == 0:  # as the loop of ticks does, which sleeps between them
                await quick.until_text(f"event {number}")
        await quick.until_text("event 39")
        door.say((LEVEL, "end"))
        slow = Visitor(WatchClient("", 0))
        stream = BagStreamReader()
        async with asyncio.timeout(PATIENCE):
            while ("/level", "end") not in slow.texts:
                heard = stream.feed(await reader.read(2**20))
                slow.events += [event for event in heard if isinstance(event, SessionMessage)]
        await asyncio.sleep(0)
        writer.close()
        assert [text for topic, text in slow.texts if topic == "/event"] == [f"event {n}" for n in range(40)]
        heavy = [text for topic, text in slow.texts if topic == "/heavy"]
        assert len(heavy) < 40
        assert set(heavy) == {"x" * 2**20}
        assert sum(topic == "/heavy" for topic, _ in quick.texts) == 40
        assert {status.dropped for status in quick.statuses} == {0}


def test_to_a_connection_that_has_failed_nothing_more_is_written(caplog: pytest.LogCaptureFixture) -> None:
    async def whole() -> None:
        async with serving() as door:
            door.say((LEVEL, "level"))
            reader, writer = await asyncio.open_connection(door.where.host, door.where.port)
            async with asyncio.timeout(PATIENCE):
                await reader.readuntil(b"level")
            writer.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            writer.transport.abort()
            await asyncio.sleep(0)  # the client's connection is reset, and the server has not heard of it yet
            for _ in range(20):
                door.say((EVENT, "x"))

    asyncio.run(whole())
    assert [record.getMessage() for record in caplog.records if record.name == "asyncio"] == []


@in_event_loop
async def test_a_client_comes_back_by_itself() -> None:
    async with serving() as door:
        door.say((LEVEL, "level"))
        visitor = door.enter()
        await visitor.until_heard(WatchConnected)
        await door.server.stop()
        await visitor.until_heard(ConnectionLost)
        assert not visitor.client.send(b"{}\n")
        assert isinstance(await door.server.start(door.where.host, door.where.port), ListeningAddress)
        await visitor.until(lambda: sum(isinstance(event, WatchConnected) for event in visitor.events) == 2)


@in_event_loop
async def test_the_end_of_a_session_is_told_with_its_bag() -> None:
    async with serving() as door:
        visitor = door.enter()
        await visitor.until_status(lambda status: status.bag == str(Path("hunt.bag").absolute()) and not status.ended)
        await door.server.stop()
        await visitor.until_heard(ConnectionLost)
        assert visitor.statuses[-1].ended


@in_event_loop
async def test_who_has_nothing_to_ask_may_still_listen() -> None:
    async with serving() as door:
        door.say((LEVEL, "level"))
        reader, writer = await asyncio.open_connection(door.where.host, door.where.port)
        writer.write_eof()
        async with asyncio.timeout(PATIENCE):
            told = await reader.readuntil(b"level")
            door.say((EVENT, "later"))
            told += await reader.readuntil(b"later")
        writer.close()
        assert told.startswith(b"#ROSBAG V2.0\n")


@in_event_loop
async def test_a_port_that_is_taken_is_told() -> None:
    async with serving() as door:
        other = await WatchServer(GrantingHouse()).start("127.0.0.1", door.where.port)
        assert isinstance(other, CannotListen)


@pytest.mark.parametrize("garbage", [b"GET / HTTP/1.1\r\n\r\n", b"\0" * 100 + b"\n"])
def test_who_speaks_another_protocol_is_sent_away(garbage) -> None:
    async def whole() -> None:
        async with serving() as door:
            reader, writer = await asyncio.open_connection(door.where.host, door.where.port)
            writer.write(garbage)
            async with asyncio.timeout(PATIENCE):
                await reader.read()
            writer.close()
            assert door.house.asked == []

    asyncio.run(whole())

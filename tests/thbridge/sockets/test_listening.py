"""Doors that keep descriptors for what is recorded: with real sockets, files and limits of the system."""

import asyncio
import itertools
import os
import resource
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from tests.support.hunts.granting_house import GrantingHouse
from tests.support.mavlink.answering_exchange import AnsweringExchange
from thbridge.files.ros.definitions import Definitions
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import GameStarted
from thbridge.mavlink.sockets.server import MavlinkPorts, MavlinkServer
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.recording.journal_folder import JournalStore
from thbridge.rosgraph.sockets.http_client import CallFailed, XmlRpcClient
from thbridge.rosgraph.sockets.http_server import XmlRpcServer
from thbridge.rosgraph.sockets.tcpros_server import TcprosServer
from thbridge.sockets.addresses import Address, ListeningAddress
from thbridge.sockets.keys import SingleKey
from thbridge.sockets.listening import DESCRIPTORS, RESERVED, ServerDoor, check_room, fair_shares, mark
from thbridge.text_protocol.sockets.server import TextServer
from thbridge.text_protocol.wire.router import MessageRouter
from thbridge.watching.sockets.server import WatchServer

PATIENCE = 120
LOCALHOST = "127.0.0.1"
STARTED = GameStarted(7, 1, 2, 100.0, 5.0, 2.0, 1.0, CostMatrix.of_map_times(((99.0, 5.0), (99.0, 99.0))))


def lowest_free() -> int:
    probe = os.open(os.devnull, os.O_RDONLY)
    os.close(probe)
    return probe


@contextmanager
def descriptors(count: int) -> Iterator[None]:
    """Let this process have so many descriptors."""
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (count, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


def with_mark_at(descriptor: int) -> int:
    """So many descriptors that this is the least which no connection may have."""
    return next(count for count in itertools.count() if count - min(RESERVED, count // 4) == descriptor)


class Crowd:
    """Clients that connect to a door, all of them before it accepts one, and hold what they have."""

    def __init__(self, port: int, count: int) -> None:
        self.clients = [socket.socket() for _ in range(count)]
        for client in self.clients:
            client.setblocking(False)
            with suppress(BlockingIOError):
                client.connect((LOCALHOST, port))

    async def one_is_cut_off(self) -> None:
        """Wait until the door has ended a connection; nobody is told anything before."""
        ends = [asyncio.ensure_future(self._end(client)) for client in self.clients]
        async with asyncio.timeout(PATIENCE):
            await asyncio.wait(ends, return_when=asyncio.FIRST_COMPLETED)
        for end in ends:
            end.cancel()
        await asyncio.gather(*ends, return_exceptions=True)

    async def _end(self, client: socket.socket) -> None:
        with suppress(ConnectionError):
            while await asyncio.get_running_loop().sock_recv(client, 4096):
                pass

    def leave(self) -> None:
        for client in self.clients:
            client.close()


def port_of(where: object) -> int:
    assert isinstance(where, ListeningAddress), where
    return where.port


def test_what_is_recorded_can_be_opened_while_all_doors_are_full(tmp_path: Path) -> None:
    async def whole() -> None:
        text = TextServer()
        watch = WatchServer(GrantingHouse(), SingleKey("0123456789abcdef"), Definitions(()))
        mavlink = MavlinkServer(MavlinkPorts((), Address(LOCALHOST, 0), None))
        master = XmlRpcServer(("getPid",), lambda call, peer: 1)
        tcpros = TcprosServer("/us", itertools.count())
        names = await mavlink.open()
        assert isinstance(names, list), names
        await mavlink.serve(AnsweringExchange())
        ports = [
            port_of(await text.start(MessageRouter(), LOCALHOST, 0)),
            port_of(await watch.start(LOCALHOST, 0)),
            port_of(await master.start()),
            port_of(await tcpros.start(LOCALHOST)),
            int(names[0].rpartition(":")[2]),
        ]
        crowds = [Crowd(port, 80) for port in ports]
        try:
            # Each door alone would have room for all of its crowd, but for the last.
            with descriptors(with_mark_at(lowest_free() + 100)):
                await asyncio.gather(*(crowd.one_is_cut_off() for crowd in crowds))
                journals = JournalStore(tmp_path / "hunt.journal")
                journals.append([STARTED])
                journals.close()
                for number in range(5):
                    BagWriter(tmp_path / f"{number}.bag", Definitions(())).close()
        finally:
            for crowd in crowds:
                crowd.leave()
            for server in (text, watch, master, tcpros):
                await server.stop()
            await mavlink.close()

    asyncio.run(whole())


async def hear_one(door: ServerDoor) -> tuple[int, asyncio.Queue[asyncio.BaseTransport]]:
    """Open a door at a free port; its connections come into the queue."""
    came: asyncio.Queue[asyncio.BaseTransport] = asyncio.Queue()

    class Connection(asyncio.Protocol):
        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            came.put_nowait(transport)

    return (await door.listen(Connection, LOCALHOST, 0)).port, came


def test_a_connection_at_the_mark_is_closed_before_anybody_hears_of_it_and_one_below_is_heard_again() -> None:
    async def whole() -> None:
        door = ServerDoor(10)
        port, came = await hear_one(door)
        with descriptors(with_mark_at(lowest_free() + 1)):  # one is left below the mark, which the client takes
            early = Crowd(port, 1)
            assert lowest_free() >= mark()  # above, where a thread of an earlier test has opened something
            await early.one_is_cut_off()
            assert came.empty()
            early.leave()
        late = Crowd(port, 1)
        async with asyncio.timeout(PATIENCE):
            (await came.get()).close()
        late.leave()
        door.close()
        await door.wait_closed()

    asyncio.run(whole())


def test_only_those_who_have_not_left_are_heard_and_one_who_spoke_before_leaving_is() -> None:
    async def whole() -> None:
        door = ServerDoor(10)
        port, came = await hear_one(door)
        gone = Crowd(port, 200)  # more than a door closes in a row
        gone.leave()
        with socket.create_connection((LOCALHOST, port)) as speaking, socket.create_connection((LOCALHOST, port)):
            speaking.sendall(b"%%setid A\n")
            speaking.shutdown(socket.SHUT_WR)
            async with asyncio.timeout(PATIENCE):
                for _ in range(2):
                    (await came.get()).close()
            assert came.empty()
        door.close()
        await door.wait_closed()

    asyncio.run(whole())


def test_nobody_is_called_where_the_connection_would_take_a_descriptor_of_those_kept(tmp_path: Path) -> None:
    async def whole() -> None:
        server, client = XmlRpcServer(("getPid",), lambda call, peer: 1), XmlRpcClient()
        uri = f"http://{LOCALHOST}:{port_of(await server.start())}/"
        with descriptors(with_mark_at(lowest_free())):
            with pytest.raises(OSError, match="Too many open files"):
                check_room()
            failed = await client.call(uri, "getPid", "/us")
            assert isinstance(failed, CallFailed)
            assert failed.reason == "Too many open files"
        assert not isinstance(await client.call(uri, "getPid", "/us"), CallFailed)
        await client.close()
        await server.stop()

    asyncio.run(whole())


@pytest.mark.parametrize(
    ("wishes", "room", "shares"),
    [
        ([(10, 1), (20, 1)], 30, [10, 20]),
        ([(10, 1), (20, 1)], 100, [10, 20]),
        ([(10, 1), (100, 1), (100, 1)], 90, [10, 40, 40]),
        ([(100, 1), (1000, 4)], 100, [20, 80]),
        ([(10, 1), (10, 1)], -5, [0, 0]),
        ([], 10, []),
    ],
)
def test_room_is_shared_by_wishes_and_weights(wishes: list[tuple[int, int]], room: int, shares: list[int]) -> None:
    assert fair_shares(wishes, room) == shares


def test_a_door_has_less_where_others_are_open_and_all_it_wants_where_there_is_enough() -> None:
    async def whole() -> None:
        one, other = ServerDoor(500), ServerDoor(500)
        await hear_one(one)
        with descriptors(600):
            alone = one.most
            await hear_one(other)
            assert one.most == other.most < alone < 500
            other.close()
            assert one.most == alone
        if resource.getrlimit(resource.RLIMIT_NOFILE)[0] >= 1024:
            assert one.most == 500
        one.close()
        await one.wait_closed()
        await other.wait_closed()

    asyncio.run(whole())


def test_a_process_may_have_the_descriptors_that_the_system_would_let_it_have() -> None:
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    with descriptors(512):
        ServerDoor(10)
        soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        assert soft == (DESCRIPTORS if hard == resource.RLIM_INFINITY else min(DESCRIPTORS, hard))

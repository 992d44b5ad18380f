"""The DDS carrier on real sockets, without programs of ROS 2."""

import asyncio
import socket
from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack

import pytest

from tests.support.programs.ports import free_domain
from thbridge.ros2.qos import DEFAULT, LATCHED
from thbridge.ros2.supports import MessageSupport, ServiceSupport
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.values.graph import EndpointRole, NodeName
from thbridge.ros2graph.wire.rtps import guids
from thbridge.ros2graph.wire.rtps.discovery import LEASE_NS, ParticipantData
from thbridge.ros2graph.wire.rtps.parameters import UdpAddress
from thbridge.ros2graph.wire.rtps.ports import LARGEST_DOMAIN, metatraffic_port
from thbridge.ros2graph.wire.rtps.submessages import VENDOR, encode_data, encode_header, encode_heartbeat
from thbridge.sockets.errors import CannotListen

DOMAIN = free_domain()
"""Domain of this process's tests, so that tests of other processes do not take part."""
TIMEOUT = 30.0
TEXT = MessageSupport("std_msgs/msg/String", "RIHS01_" + "1" * 64)
ASK = ServiceSupport("a/srv/Ask", "", MessageSupport("a/srv/Ask_Request", ""), MessageSupport("a/srv/Ask_Response", ""))
FIRST, SECOND = NodeName("/robot1", "first"), NodeName("/", "second")
CDR = b"\x00\x01\x00\x00"


async def until(happens: Callable[[], object]) -> None:
    async with asyncio.timeout(TIMEOUT):
        while not happens():
            await asyncio.sleep(0.005)


def run_with(test: Callable[[DdsCarrier, DdsCarrier], Awaitable[None]]) -> None:
    """Run a coroutine with two carriers of one domain. It starts them."""

    async def run() -> None:
        first, second = DdsCarrier(DOMAIN), DdsCarrier(DOMAIN)
        async with AsyncExitStack() as stack:
            stack.push_async_callback(first.stop)
            stack.push_async_callback(second.stop)
            await test(first, second)

    asyncio.run(run())


def test_messages_of_all_sizes_arrive() -> None:
    async def test(first: DdsCarrier, second: DdsCarrier) -> None:
        got: list[tuple[bytes, str]] = []
        writer = first.publish(FIRST, "/text", TEXT, DEFAULT)
        second.subscribe(SECOND, "/text", TEXT, DEFAULT, lambda data, gid: got.append((data, second.node_of(gid))))
        assert await first.start() is await second.start() is None
        await until(lambda: writer.readers == 1 and second.nodes())
        sent = [CDR + bytes(size) for size in (4, 16_000, 1_000_000)]
        for message in sent:
            writer.write(message)
        await until(lambda: len(got) == len(sent))
        assert got == [(message, "/robot1/first") for message in sent]

    run_with(test)


def test_endpoints_are_added_and_seen_at_any_time() -> None:
    async def test(first: DdsCarrier, second: DdsCarrier) -> None:
        assert await first.start() is await second.start() is None
        first.publish(FIRST, "/text", TEXT, LATCHED).write(CDR + b"late")
        await until(lambda: second.nodes() == [FIRST])
        await until(lambda: second.endpoints() and second.endpoints()[0].node == FIRST)
        (seen,) = second.endpoints()
        assert (seen.role, seen.name, seen.type, seen.hash) == (
            (EndpointRole.PUBLISHER, "/text", TEXT.name, TEXT.hash)
        )  # fmt: skip
        assert seen.qos == LATCHED
        got: list[bytes] = []
        second.subscribe(SECOND, "/text", TEXT, LATCHED, lambda data, gid: got.append(data))
        await until(lambda: got)
        assert got == [CDR + b"late"]
        await first.stop()
        await until(lambda: not second.nodes())

    run_with(test)


def test_calls_get_their_own_responses() -> None:
    async def test(first: DdsCarrier, second: DdsCarrier) -> None:
        held: list[tuple[bytes, Callable[[bytes], None]]] = []
        first.serve(FIRST, "/ask", ASK, lambda data, gid, reply: held.append((data, reply)))
        clients = [second.client(SECOND, "/ask", ASK) for _ in range(2)]
        assert await first.start() is await second.start() is None
        await until(lambda: all(client.has_server for client in clients))
        got: list[tuple[int, bytes]] = []
        for number in range(3):
            for at, client in enumerate(clients):
                client.call(CDR + bytes([at, number, 0, 0]), lambda data, at=at: got.append((at, data[4:6])))
        await until(lambda: len(held) == 6)
        for data, reply in reversed(held):
            reply(data)
        await until(lambda: len(got) == 6)
        assert sorted(got) == [(at, bytes([at, number])) for at in range(2) for number in range(3)]

    run_with(test)


@pytest.mark.parametrize(
    ("domain", "interface", "reason"),
    [
        (0, "203.0.113.9", "does not have this address. Write an address of this machine."),
        (LARGEST_DOMAIN + 1, "127.0.0.1", "range"),
        (0, "localhost", "IPv4"),
    ],
)
def test_a_carrier_that_cannot_join_says_why(domain: int, interface: str, reason: str) -> None:
    failure = asyncio.run(DdsCarrier(domain, interface).start())
    assert isinstance(failure, CannotListen)
    assert reason in str(failure)


def test_a_newcomer_gets_an_answer_although_a_flood_has_come_before_it() -> None:
    def participant(number: int) -> tuple[socket.socket, bytes, bytes]:
        """A socket, the header of its datagrams, and its announcement. The carrier answers the announcement."""
        opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        opened.bind(("127.0.0.1", 0))
        opened.setblocking(False)
        prefix = bytes([1, 15, number]) + bytes(9)
        own = [UdpAddress(*opened.getsockname())]
        data = ParticipantData(prefix + guids.PARTICIPANT, VENDOR, own, own, LEASE_NS, b"")
        return opened, encode_header(prefix), encode_data(guids.SPDP_WRITER, 1, data.encode(), 0)

    async def run() -> None:
        async with AsyncExitStack() as stack:
            carrier = DdsCarrier(DOMAIN)
            stack.push_async_callback(carrier.stop)
            assert await carrier.start() is None
            door = "127.0.0.1", metatraffic_port(DOMAIN, 0)
            (foe, foe_header, late), (friend, header, announcement) = participant(1), participant(2)
            stack.callback(foe.close)
            stack.callback(friend.close)
            beat = encode_heartbeat(guids.UNKNOWN, guids.writer_id(1), 1, 1, 1, final=True)
            for _ in range(100):
                foe.sendto(foe_header + 400 * beat, door)
            foe.sendto(foe_header + late, door)
            friend.sendto(header + announcement, door)
            await asyncio.get_running_loop().sock_recv(friend, 65_536)
            with pytest.raises(BlockingIOError):
                foe.recv(65_536)
            await asyncio.get_running_loop().sock_recv(foe, 65_536)

    asyncio.run(asyncio.wait_for(run(), TIMEOUT))

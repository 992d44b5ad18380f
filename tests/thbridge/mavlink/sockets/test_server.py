"""MAVLink's sockets, with a session behind them that answers every ping."""

import asyncio
import errno
import socket
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.mavlink.answering_exchange import ANSWER, AnsweringExchange, frame
from thbridge.mavlink.sockets import links as mavlink_links
from thbridge.mavlink.sockets import tcp as mavlink_tcp
from thbridge.mavlink.sockets import udp as mavlink_udp
from thbridge.mavlink.sockets.links import GARBAGE_LIMIT
from thbridge.mavlink.sockets.server import MavlinkPorts, MavlinkServer
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.frames.framer import FrameParser
from thbridge.mavlink.wire.links import DropReason
from thbridge.sockets.addresses import Address, UdpTarget, parse_target
from thbridge.sockets.errors import CannotListen

PATIENCE = 120


PING = frame(mav.MAVLink_ping_message(7, 1, 0, 0))
HEARTBEAT = frame(mav.MAVLink_heartbeat_message(10, 0, 0, 0, 4, 3), system=1)


class Station:
    """A ground station's UDP socket."""

    def __init__(self, host: str = "127.0.0.1") -> None:
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        self.socket = socket.socket(family, socket.SOCK_DGRAM)
        self.socket.bind((host, 0))
        self.socket.setblocking(False)
        self.address = Address(host, self.socket.getsockname()[1])

    async def hear(self) -> tuple[bytes, tuple[str, int]]:
        async with asyncio.timeout(PATIENCE):
            return await asyncio.get_running_loop().sock_recvfrom(self.socket, 65535)

    def hears_nothing(self) -> bool:
        try:
            self.socket.recv(65535)
        except BlockingIOError:
            return True
        return False


@pytest.fixture
def station():
    made = Station()
    yield made
    made.socket.close()


@asynccontextmanager
async def served(
    *udp: Address | UdpTarget, tcp: Address | None = None, listen: Address | None = None
) -> AsyncIterator[tuple[AnsweringExchange, list[str]]]:
    targets = tuple(there if isinstance(there, UdpTarget) else UdpTarget(there) for there in udp)
    server, exchange = MavlinkServer(MavlinkPorts(targets, tcp, None, listen)), AnsweringExchange()
    try:
        names = await server.open()
        assert not isinstance(names, CannotListen), names
        exchange.transmit = server.transmit
        await server.serve(exchange)
        yield exchange, names
    finally:
        await server.close()
    assert exchange.names == {}


async def until(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(PATIENCE):
        while not true():
            await asyncio.sleep(0.002)


def test_the_target_is_spoken_to_before_it_says_anything(station: Station) -> None:
    async def whole() -> None:
        async with served(station.address) as (exchange, names):
            assert list(exchange.names.values()) == names == [f"udp {station.address}"]
            exchange.say(HEARTBEAT)
            data, _ = await station.hear()
            assert data == HEARTBEAT.to_bytes()

    asyncio.run(whole())


def test_a_target_of_one_robot_has_links_of_that_robot_alone(station: Station) -> None:
    async def whole() -> None:
        async with served(UdpTarget(station.address, 3)) as (exchange, names):
            assert names == [f"udp {station.address}/3"]
            assert exchange.robots == {f"udp {station.address}": 2}

    asyncio.run(whole())


@given(st.none() | st.integers(1, 250))
def test_a_target_is_read_as_it_is_written(number: int | None) -> None:
    target = UdpTarget(Address("::1", 14550), number)
    assert parse_target(str(target)) == target


@pytest.mark.parametrize("text", ["h:1/0", "h:1/", "h:1/x", "h:1/-1", "h:1/1/1", "h/1", "/1"])
def test_what_is_no_target(text: str) -> None:
    assert parse_target(text) is None


def test_an_answer_comes_at_once_and_on_the_link_it_was_asked_on(station: Station) -> None:
    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(HEARTBEAT)
            _, vehicles = await station.hear()
            station.socket.sendto(PING.to_bytes(), vehicles)
            assert (await station.hear())[0] == ANSWER.to_bytes()
            assert exchange.received == [(f"udp {station.address}", PING)]

    asyncio.run(whole())


def test_who_speaks_first_is_answered_and_heard_from_then_on(station: Station) -> None:
    async def whole() -> None:
        async with served(listen=Address("127.0.0.1", 0)) as (exchange, names):
            assert exchange.names == {}
            host, port = names[0].removeprefix("udp from ").split(":")
            station.socket.sendto(PING.to_bytes(), (host, int(port)))
            assert (await station.hear())[0] == ANSWER.to_bytes()
            assert list(exchange.names.values()) == [f"udp {station.address}"]
            exchange.say(HEARTBEAT)
            assert (await station.hear())[0] == HEARTBEAT.to_bytes()

    asyncio.run(whole())


def test_a_udp_port_that_is_taken_is_told_before_anything_starts(station: Station) -> None:
    async def whole() -> None:
        server = MavlinkServer(MavlinkPorts((), None, None, station.address))
        why = await server.open()
        assert isinstance(why, CannotListen)
        assert str(station.address) in str(why)
        await server.close()

    asyncio.run(whole())


def test_what_goes_nowhere_is_told_once(station: Station, caplog: pytest.LogCaptureFixture) -> None:
    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(HEARTBEAT)
            data, vehicles = await station.hear()
            for _ in range(2):
                station.socket.sendto(data, vehicles)
            await until(lambda: len(exchange.received) == 2)

    asyncio.run(whole())
    told = [record.message for record in caplog.records if record.levelname == "WARNING"]
    assert told == [f"MAVLink: udp {station.address}: a frame was dropped: {DropReason.OURS}"]


def test_whoever_else_speaks_to_the_socket_is_a_link_of_its_own(station: Station) -> None:
    other = Station()

    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(HEARTBEAT)
            _, vehicles = await station.hear()
            other.socket.sendto(PING.to_bytes(), vehicles)
            assert (await other.hear())[0] == ANSWER.to_bytes()
            assert list(exchange.names.values()) == [f"udp {station.address}", f"udp {other.address}"]
            assert station.hears_nothing()
            exchange.say(HEARTBEAT)
            assert (await other.hear())[0] == (await station.hear())[0] == HEARTBEAT.to_bytes()

    asyncio.run(whole())
    other.socket.close()


class FullSocket(socket.socket):
    """Takes nothing, and says so, as a network that is down does."""

    def sendto(self, *_: object) -> int:
        raise OSError(errno.ENETUNREACH, "no way there")


def test_frames_that_cannot_be_sent_are_counted_and_told(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(socket, "socket", FullSocket)

    async def whole() -> None:
        async with served(Address("127.0.0.1", 14550)) as (exchange, _):
            exchange.say(HEARTBEAT, HEARTBEAT)
            exchange.say(HEARTBEAT)

    asyncio.run(whole())
    assert [record.message for record in caplog.records] == [
        "MAVLink: udp 127.0.0.1:14550: some frames could not be sent and are lost",
        "MAVLink: 0 frames received, 0 sent, 3 could not be sent",
    ]


def test_a_stranger_who_sends_garbage_is_no_link(station: Station) -> None:
    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(HEARTBEAT)
            _, vehicles = await station.hear()
            other = Station()
            other.socket.sendto(b"\xfd" * 100, vehicles)
            station.socket.sendto(PING.to_bytes(), vehicles)
            await station.hear()
            assert len(exchange.names) == 1
            other.socket.close()

    asyncio.run(whole())


def test_whoever_sends_nothing_but_garbage_is_not_listened_to_for_a_while(
    station: Station, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(mavlink_udp, "MUTE_SECONDS", 0.2)

    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(HEARTBEAT)
            _, vehicles = await station.hear()
            for _ in range(3):  # of a datagram, half of that is read
                station.socket.sendto(bytes(GARBAGE_LIMIT + 1), vehicles)
            station.socket.sendto(PING.to_bytes(), vehicles)
            await until(lambda: "is ignored for 0.2 s: it sends no valid frames" in caplog.text)
            assert station.hears_nothing()
            async with asyncio.timeout(PATIENCE):
                while not exchange.received:
                    station.socket.sendto(PING.to_bytes(), vehicles)
                    await asyncio.sleep(0.05)

    asyncio.run(whole())


def test_frames_of_one_tick_share_datagrams_of_limited_size(station: Station) -> None:
    frames = [frame(mav.MAVLink_ping_message(7, number, 255, 190), 1, number) for number in range(200)]

    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(*frames)
            sizes, heard, framer = [], [], FrameParser()
            while len(heard) < len(frames):
                data, _ = await station.hear()
                sizes.append(len(data))
                heard += framer.receive_data(data)
            assert heard == frames
            assert len(sizes) == -(-sum(len(each.to_bytes()) for each in frames) // 1200)
            assert max(sizes) <= 1200

    asyncio.run(whole())


def test_a_target_that_is_not_there_loses_nobody_anything(station: Station) -> None:
    absent = Station()
    absent.socket.close()

    async def whole() -> None:
        async with served(absent.address, station.address) as (exchange, _):
            for _ in range(3):
                exchange.say(HEARTBEAT)
                assert (await station.hear())[0] == HEARTBEAT.to_bytes()

    asyncio.run(whole())


def test_the_silent_one_goes_when_too_many_speak(station: Station, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mavlink_udp, "MAX_PEERS", 2)
    others = [Station() for _ in range(3)]

    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(HEARTBEAT)
            _, vehicles = await station.hear()
            for other in others:
                other.socket.sendto(PING.to_bytes(), vehicles)
                await other.hear()
            assert exchange.gone == [f"udp {others[0].address}"]
            assert len(exchange.names) == 3

    asyncio.run(whole())
    for other in others:
        other.socket.close()


def test_who_has_been_silent_for_long_is_forgotten_but_never_the_target(
    station: Station, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mavlink_udp, "STALE_SECONDS", 0.2)
    other = Station()

    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(HEARTBEAT)
            _, vehicles = await station.hear()
            other.socket.sendto(PING.to_bytes(), vehicles)
            await until(lambda: len(exchange.names) == 2)
            await until(lambda: exchange.gone == [f"udp {other.address}"])
            assert list(exchange.names.values()) == [f"udp {station.address}"]

    asyncio.run(whole())
    other.socket.close()


def test_a_flood_of_strangers_drives_no_ground_station_out(station: Station, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mavlink_udp, "MAX_PEERS", 2)
    strangers = [Station() for _ in range(5)]
    honest = Station()

    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(HEARTBEAT)
            _, vehicles = await station.hear()
            honest.socket.sendto(PING.to_bytes(), vehicles)
            await honest.hear()
            for stranger in strangers:
                stranger.socket.sendto(b"hello", vehicles)
            station.socket.sendto(PING.to_bytes(), vehicles)
            await station.hear()
            assert exchange.gone == []

    asyncio.run(whole())
    for each in (*strangers, honest):
        each.socket.close()


def test_invented_ports_with_good_frames_drive_no_ground_station_out(
    station: Station, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mavlink_udp, "MAX_PEERS", 2)
    monkeypatch.setattr(mavlink_udp, "SETTLED_SECONDS", 0.0)
    invented = [Station() for _ in range(5)]
    honest = Station()

    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(HEARTBEAT)
            _, vehicles = await station.hear()
            for speaker in (honest, honest, *invented):
                speaker.socket.sendto(PING.to_bytes(), vehicles)
                await speaker.hear()
            assert exchange.gone == [f"udp {each.address}" for each in invented[:-1]]

    asyncio.run(whole())
    for each in (*invented, honest):
        each.socket.close()


def test_only_so_many_new_peers_are_met_in_a_second(station: Station, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mavlink_udp, "MEETINGS", 3)
    invented = [Station() for _ in range(6)]

    async def whole() -> None:
        async with served(station.address) as (exchange, _):
            exchange.say(HEARTBEAT)
            _, vehicles = await station.hear()
            for speaker in invented:
                speaker.socket.sendto(PING.to_bytes(), vehicles)
            station.socket.sendto(PING.to_bytes(), vehicles)  # known already, and read after all of them
            await station.hear()
            assert [link for link, _ in exchange.received] == [
                f"udp {each.address}" for each in (*invented[:3], station)
            ]

    asyncio.run(whole())
    for each in invented:
        each.socket.close()


@pytest.mark.skipif(not socket.has_ipv6, reason="this machine has no IPv6")
def test_ipv6() -> None:
    try:
        station = Station("::1")
    except OSError:
        pytest.skip("this machine has no IPv6")

    async def whole() -> None:
        async with served(station.address, tcp=Address("::1", 0)) as (exchange, names):
            assert names[0] == f"udp [::1]:{station.address.port}"
            exchange.say(HEARTBEAT)
            _, vehicles = await station.hear()
            station.socket.sendto(PING.to_bytes(), vehicles)
            assert (await station.hear())[0] == ANSWER.to_bytes()
            reader, writer = await asyncio.open_connection("::1", int(names[1].rpartition(":")[2]))
            writer.write(PING.to_bytes())
            assert await reader.readexactly(len(ANSWER.to_bytes())) == ANSWER.to_bytes()
            assert exchange.received[-1][0].startswith("tcp [::1]:")
            writer.close()

    asyncio.run(whole())
    station.socket.close()


@pytest.mark.parametrize("host", ["256.1.1.1", "no.such.host.invalid", "ä" * 80])
def test_a_target_that_has_no_address_is_told_before_anything_starts(host: str) -> None:
    async def whole() -> None:
        server = MavlinkServer(MavlinkPorts((UdpTarget(Address(host, 14550)),), None, None))
        why = await server.open()
        assert isinstance(why, CannotListen)
        assert host in str(why)
        await server.close()

    asyncio.run(whole())


# TCP

LISTEN = Address("127.0.0.1", 0)


async def connect(name: str) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    return await asyncio.open_connection("127.0.0.1", int(name.rpartition(":")[2]))


def test_each_connection_is_a_link_until_it_ends() -> None:
    async def whole() -> None:
        async with served(tcp=LISTEN) as (exchange, names):
            assert exchange.names == {}
            ends = [await connect(names[0]) for _ in range(2)]
            await until(lambda: len(exchange.names) == 2)
            exchange.say(HEARTBEAT)
            for reader, writer in ends:
                assert await reader.readexactly(len(HEARTBEAT.to_bytes())) == HEARTBEAT.to_bytes()
                for piece in PING.to_bytes():
                    writer.write(bytes((piece,)))
                    await writer.drain()
                assert await reader.readexactly(len(ANSWER.to_bytes())) == ANSWER.to_bytes()
            assert [each for _, each in exchange.received] == [PING, PING]
            ends[0][1].close()
            await until(lambda: len(exchange.names) == 1)
            ends[1][1].close()

    asyncio.run(whole())


def test_who_does_not_read_is_cut_off(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mavlink_tcp, "BACKLOG", 10_000)
    many = [HEARTBEAT] * 5000

    async def whole() -> None:
        async with served(tcp=LISTEN) as (exchange, names):
            _, writer = await connect(names[0])
            await until(lambda: len(exchange.names) == 1)
            while exchange.names:
                exchange.say(*many)
                await asyncio.sleep(0)
            assert "is disconnected: it does not read" in caplog.text
            writer.close()

    asyncio.run(whole())


def test_pages_of_browsers_are_cut_off_before_frames_in_their_requests_are_heard(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def whole() -> None:
        async with served(tcp=LISTEN) as (exchange, names):
            reader, writer = await connect(names[0])
            await until(lambda: len(exchange.names) == 1)
            writer.write(b"POST / HTTP/1.1\r\nHost: x\r\n\r\n" + HEARTBEAT.to_bytes())
            with pytest.raises((ConnectionError, asyncio.IncompleteReadError)):
                await reader.readexactly(1)
            assert "sends HTTP" in caplog.text
            assert exchange.received == []
            writer.close()

    asyncio.run(whole())


def test_who_sends_garbage_alone_is_cut_off(caplog: pytest.LogCaptureFixture) -> None:
    async def whole() -> None:
        async with served(tcp=LISTEN) as (_, names):
            reader, writer = await connect(names[0])
            writer.write(b"no MAVLink here\n" * (GARBAGE_LIMIT // 16 + 2))
            with pytest.raises((ConnectionError, asyncio.IncompleteReadError)):
                await reader.readexactly(1)
            assert "is disconnected: it sends no valid frames" in caplog.text
            writer.close()

    asyncio.run(whole())


def test_one_connection_too_many_is_turned_away(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mavlink_tcp, "CONNECTIONS", 1)

    async def whole() -> None:
        async with served(tcp=LISTEN) as (exchange, names):
            answered, first = await connect(names[0])
            first.write(PING.to_bytes())
            await answered.readexactly(len(ANSWER.to_bytes()))
            reader, second = await connect(names[0])
            with pytest.raises((ConnectionError, asyncio.IncompleteReadError)):
                await reader.readexactly(1)
            assert len(exchange.names) == 1
            first.close()
            second.close()

    asyncio.run(whole())


def test_a_connection_on_which_nobody_spoke_makes_room_for_another(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mavlink_tcp, "CONNECTIONS", 1)

    async def whole() -> None:
        async with served(tcp=LISTEN) as (_, names):
            silent, first = await connect(names[0])
            reader, second = await connect(names[0])
            second.write(PING.to_bytes())
            assert await reader.readexactly(len(ANSWER.to_bytes())) == ANSWER.to_bytes()
            with pytest.raises((ConnectionError, asyncio.IncompleteReadError)):
                await silent.readexactly(1)
            first.close()
            second.close()

    asyncio.run(whole())


def test_by_tcp_frames_that_come_too_fast_wait_and_none_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mavlink_links, "MOST_WAITING", 600)
    monkeypatch.setattr(mavlink_links, "LINK_FRAMES", 150)
    frames = [frame(mav.MAVLink_ping_message(7, number, 0, 0)) for number in range(1500)]

    async def whole() -> None:
        async with served(tcp=LISTEN) as (exchange, names):
            reader, writer = await connect(names[0])
            writer.write(b"".join(each.to_bytes() for each in frames))
            await reader.readexactly(len(frames) * len(ANSWER.to_bytes()))
            assert [each for _, each in exchange.received] == frames
            writer.close()

    asyncio.run(whole())


def test_a_port_that_is_taken_is_told_before_anything_starts() -> None:
    async def whole() -> None:
        async with served(tcp=LISTEN) as (_, names):
            port = int(names[0].rpartition(":")[2])
            server = MavlinkServer(MavlinkPorts((), Address("127.0.0.1", port), None))
            why = await server.open()
            assert isinstance(why, CannotListen)
            assert f"127.0.0.1:{port}: Address already in use" in str(why)
            await server.close()

    asyncio.run(whole())


def test_what_was_said_last_is_still_read() -> None:
    async def whole() -> None:
        async with served(tcp=LISTEN) as (exchange, names):
            reader, writer = await connect(names[0])
            await until(lambda: len(exchange.names) == 1)
            exchange.say(HEARTBEAT)
        assert await reader.read() == HEARTBEAT.to_bytes()
        writer.close()

    asyncio.run(whole())

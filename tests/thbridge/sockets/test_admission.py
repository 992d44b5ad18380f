import asyncio
import socket

import pytest

from thbridge.mavlink.sockets.links import MavlinkLinks
from thbridge.mavlink.sockets.tcp import TcpPort, tcp_port
from thbridge.rosgraph.sockets.master_server import MasterServer
from thbridge.rosgraph.sockets.node import NodeStarted, RosNode
from thbridge.sockets.addresses import Address, ListeningAddress
from thbridge.sockets.admission import OWN_MACHINE, Admission, is_own, parse_network
from thbridge.text_protocol.sockets.server import TextServer
from thbridge.text_protocol.wire.router import MessageRouter
from thbridge.watching.sockets import server as watch_server
from thbridge.watching.sockets.server import SessionPace, WatchServer


@pytest.mark.parametrize("host", ["127.0.0.1", "127.0.1.1", "::1", "localhost", "::ffff:127.0.0.1"])
def test_addresses_of_this_machine_alone(host: str) -> None:
    assert is_own(host)


@pytest.mark.parametrize(
    "host", ["0.0.0.0", "::", "10.0.0.1", "fe80::1%eth0", "lab.example.org", "", "::ffff:10.0.0.1"]
)
def test_addresses_that_others_reach(host: str) -> None:
    assert not is_own(host)


def test_a_network_is_an_address_or_many() -> None:
    assert str(parse_network(" 10.0.0.7/24")) == "10.0.0.0/24"
    assert str(parse_network("10.0.0.7")) == "10.0.0.7/32"
    assert parse_network("lab") is None
    assert parse_network("10.0.0.0/33") is None


def test_machines_of_the_networks_are_admitted_and_this_one() -> None:
    admission = Admission.to(["10.0.0.0/24", "fd00::/8"])
    assert [admission.admits(host) for host in ("10.0.0.9", "::ffff:10.0.0.9", "fd00::1", "127.0.0.1")] == [True] * 4
    assert [admission.admits(host) for host in ("10.0.1.9", "fe80::1", "somebody")] == [False] * 3
    assert not OWN_MACHINE.admits("10.0.0.9")


class Transport(asyncio.Transport):
    def __init__(self, peer: object, own: object) -> None:
        super().__init__({"peername": peer, "sockname": own})


def test_a_program_of_this_machine_may_use_any_of_its_addresses() -> None:
    assert OWN_MACHINE.refused(Transport(("10.0.0.5", 4000), ("10.0.0.5", 6009))) is None
    assert OWN_MACHINE.refused(Transport(("10.0.0.6", 4000), ("10.0.0.5", 6009))) == "10.0.0.6"
    assert OWN_MACHINE.refused(Transport("", "")) is None


def test_a_stranger_is_cut_off_before_it_is_heard(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Admission, "refused", lambda self, transport: "10.0.0.6")

    async def knock() -> bytes:
        server = TextServer()
        where = await server.start(MessageRouter(), "127.0.0.1", 0)
        assert isinstance(where, ListeningAddress)
        with socket.create_connection((where.host, where.port)) as client:
            client.settimeout(20)
            client.sendall(b"%%setid SimR\n")
            try:
                return await asyncio.to_thread(client.recv, 100)
            except ConnectionError:
                return b""
            finally:
                await server.stop()

    assert asyncio.run(knock()) == b""


def test_every_door_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Peers of the loopback are those of another machine here: none of the doors hears them."""
    monkeypatch.setattr(Admission, "admits", lambda self, host: False)
    monkeypatch.setattr(Admission, "refused", lambda self, transport: "10.0.0.6")
    monkeypatch.setattr(watch_server, "peer_of", lambda transport: "10.0.0.6")

    async def hears(port: int, data: bytes) -> bytes:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        try:
            writer.write(data)
            async with asyncio.timeout(120):
                return await reader.read(100)
        except ConnectionError:
            return b""
        finally:
            writer.close()

    async def knock() -> None:
        watch, master = WatchServer(_Nobody()), MasterServer(port=0)
        node, links = RosNode("/us", "http://127.0.0.1:1"), MavlinkLinks(None)
        tcp = await tcp_port(links, Address("127.0.0.1", 0))
        where = await watch.start("127.0.0.1", 0), await master.start(), await node.start()
        assert isinstance(where[0], ListeningAddress)
        assert isinstance(where[1], ListeningAddress)
        assert isinstance(where[2], NodeStarted)
        assert isinstance(tcp, TcpPort)
        await tcp.serve()
        call = b"POST /RPC2 HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\n\r\nx"
        slave = int(where[2].uri.rstrip("/").rpartition(":")[2])
        assert [
            await hears(where[0].port, b"\n"),
            await hears(where[1].port, call),
            await hears(slave, call),
            await hears(tcp.where.port, b"\xfe"),
        ] == [b""] * 4
        await tcp.close()
        await node.stop()
        await master.stop()
        await watch.stop()

    asyncio.run(knock())


class _Nobody:
    """A session that nobody asks for anything."""

    def ask(self, watcher: str, wish: object, key: str = "") -> str | None:
        raise AssertionError

    def pace(self) -> SessionPace:
        return SessionPace(paused=False, rate=1.0, lag=0.0)

    def unwatched(self) -> None:
        raise AssertionError

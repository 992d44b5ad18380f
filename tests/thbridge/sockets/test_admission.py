import asyncio
import socket

import pytest

from thbridge.protocols.text.router import MessageRouter
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.admission import OWN_MACHINE, Admission, is_own, parse_network
from thbridge.sockets.text.server import TextServer


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
        server = TextServer(MessageRouter())
        where = await server.start("127.0.0.1", 0)
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

"""The router: what it reports if it cannot listen, and its gate for other machines."""

import asyncio
import socket

import pytest

from tests.support.programs.ports import free_port
from tests.support.ros.zenoh_graphs import NODE, OTHER, STRING, carriers, run, until
from thbridge.ros2.qos import LATCHED
from thbridge.ros2graph.sockets.zenoh_router import zenoh_router
from thbridge.sockets.addresses import Address, ListeningAddress
from thbridge.sockets.admission import Admission
from thbridge.sockets.errors import CannotListen


@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0"])
def test_a_taken_port_is_reported(host):
    async def scenario():
        with socket.create_server((host, 0)) as taken:
            port = taken.getsockname()[1]
            async with zenoh_router(Address(host, port)) as where:
                assert where == CannotListen(host, port, "Address already in use")

    run(scenario)


def test_programs_meet_through_the_gate():
    async def scenario():
        address = Address("0.0.0.0", free_port())
        async with zenoh_router(address, Admission.to(["10.0.0.0/8"])) as where:
            assert where == ListeningAddress(*address)
            async with carriers(2, Address("127.0.0.1", address.port)) as (here, there):
                got = []
                here.publish(NODE, "/map", STRING, LATCHED).write(bytes(1_000_000))
                there.subscribe(OTHER, "/map", STRING, LATCHED, lambda message, gid: got.append(message))
                await until(lambda: got)
                assert got == [bytes(1_000_000)]

    run(scenario)


class _Refusing(Admission):
    """Admission that takes this machine for a foreign one."""

    def refused(self, transport):
        return "192.0.2.7"


def test_other_machines_are_refused(caplog):
    async def scenario():
        address = Address("0.0.0.0", free_port())
        async with zenoh_router(address, _Refusing()) as where:
            assert isinstance(where, ListeningAddress)
            reader, writer = await asyncio.open_connection("127.0.0.1", address.port)
            assert await reader.read() == b""
            writer.close()

    run(scenario)
    assert "192.0.2.7 may not connect. To allow it, add --open-to 192.0.2.7" in caplog.text


def test_one_silent_client_of_the_gate_does_not_disturb_others():
    async def scenario():
        address = Address("0.0.0.0", free_port())
        async with zenoh_router(address) as where:
            assert isinstance(where, ListeningAddress)
            _, silent = await asyncio.open_connection("127.0.0.1", address.port)
            async with carriers(2, Address("127.0.0.1", address.port)) as (here, there):
                here.add_node(NODE)
                await until(lambda: there.nodes() == [NODE])
            silent.close()

    run(scenario)

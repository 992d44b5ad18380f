"""Services between our DDS carrier and real implementations, in both styles of correlation."""

from collections.abc import Callable

import pytest

from tests.peers.ros2.peer_messages import SET_BOOL, request, response, success_and_message
from tests.peers.ros2.peer_process import DOMAIN, joined, needs_ros2, peer, until, with_timeout
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.values.graph import NodeName

pytestmark = needs_ros2

OURS = NodeName("/robot1", "ours")
PEERS = {"rclpy": ("rclpy_peer.py", "theirs", "/peer"), "cyclone": ("cyclone_peer.py",)}


@pytest.mark.parametrize("name", PEERS)
@with_timeout
async def test_peers_call_our_service(name: str) -> None:
    callers = set[bytes]()

    def answer(data: bytes, gid: bytes, reply: Callable[[bytes], None]) -> None:
        callers.add(gid)
        reply(response(success=not data[4], message="ours"))

    carrier = DdsCarrier(DOMAIN)
    carrier.serve(OURS, "/robot1/enable", SET_BOOL, answer)
    async with joined(carrier), peer(*PEERS[name]) as other:
        for data in (True, False, True):
            other.do("call", service="/robot1/enable", data=data)
            answered = await other.event("response")
            assert (answered["success"], answered["message"]) == (not data, "ours")
        if name == "rclpy":
            # The first request may come before the list of its program's nodes.
            await until(lambda: {carrier.node_of(gid) for gid in callers} == {"/peer/theirs"}, "its node is known")


@pytest.mark.parametrize("name", PEERS)
@with_timeout
async def test_we_call_services_of_peers(name: str) -> None:
    answers: list[tuple[bool, str]] = []
    carrier = DdsCarrier(DOMAIN)
    client = carrier.client(OURS, "/peer/enable", SET_BOOL)
    async with joined(carrier), peer(*PEERS[name]) as other:
        assert not client.has_server
        other.do("serve", service="/peer/enable")
        await until(lambda: client.has_server, "the server is known")
        for at in range(20):
            client.call(request(data=at % 2 == 0), lambda data: answers.append(success_and_message(data)))
            await until(lambda at=at: len(answers) == at + 1, "the response came")
        peer_name = "theirs" if name == "rclpy" else "cyclone"
        assert answers == [(at % 2 == 0, peer_name) for at in range(20)]


@with_timeout
async def test_a_service_is_called_by_clients_of_both_styles_at_once() -> None:
    held: list[tuple[bool, Callable[[bytes], None]]] = []
    carrier = DdsCarrier(DOMAIN)
    carrier.serve(OURS, "/enable", SET_BOOL, lambda data, gid, reply: held.append((bool(data[4]), reply)))
    async with joined(carrier), peer(*PEERS["rclpy"]) as first, peer(*PEERS["cyclone"]) as second:
        first.do("call", service="/enable", data=True)
        second.do("call", service="/enable", data=False)
        await until(lambda: len(held) == 2, "both requests came")
        for data, reply in reversed(held):
            reply(response(success=data, message="later"))
        assert (await first.event("response"))["success"]
        assert not (await second.event("response"))["success"]


@with_timeout
async def test_a_closed_client_leaves_the_graph() -> None:
    carrier = DdsCarrier(DOMAIN)
    client = carrier.client(OURS, "/peer/enable", SET_BOOL)
    async with joined(carrier), peer(*PEERS["rclpy"]) as other:
        other.do("serve", service="/peer/enable")
        await until(lambda: client.has_server, "the server is known")
        client.close()
        client.call(request(data=True), lambda data: pytest.fail("it is closed"))
        clients: object = None
        while clients != []:
            other.do("graph", node="ours", namespace="/robot1", topics=[])
            clients = (await other.event("graph"))["clients"]

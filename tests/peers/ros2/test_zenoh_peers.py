"""zenoh-ros2-sdk and pyzeros exchange messages and requests with a carrier, in both directions."""

import asyncio
import functools
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path
from typing import TypeAlias

import pytest

from tests.peers.ros2.peer_process import ZENOH_PEERS, PeerProcess, needs_ros2, with_timeout, zenoh_peer
from tests.support.ros.zenoh_graphs import DOMAIN, NODE, carriers, router, until
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.qos import DEFAULT, LATCHED
from thbridge.ros2graph.sockets.zenoh import ZenohCarrier
from thbridge.ros2graph.values.graph import EndpointRole, NodeName
from thbridge.ros2graph.wire.zenoh.graph import UNANNOUNCED

pytestmark = needs_ros2

KILTED = Distribution.of("kilted")
STRING = "std_msgs/msg/String"
SET_BOOL = "std_srvs/srv/SetBool"
LIBRARIES = pytest.mark.parametrize("library", ZENOH_PEERS)
BY = {"sdk": "by the sdk", "pyzeros": "by pyzeros"}


Meet: TypeAlias = Callable[[str], AbstractAsyncContextManager[tuple[ZenohCarrier, PeerProcess]]]


@pytest.fixture
def meeting(tmp_path: Path) -> Meet:
    """Return a function that returns a carrier and a peer at one router."""

    @asynccontextmanager
    async def meet(library: str) -> AsyncIterator[tuple[ZenohCarrier, PeerProcess]]:
        async with (
            router() as at,
            carriers(1, at) as (carrier,),
            zenoh_peer(library, at, DOMAIN, tmp_path) as other,
        ):
            yield carrier, other

    return meet


async def repeat(step: Callable[[], object], until_done: asyncio.Future) -> None:
    """Repeat a step until something is done: the peers announce themselves before they listen."""
    while not until_done.done():
        step()
        await asyncio.wait({until_done}, timeout=0.1)


async def nodes_of(topic: str, other: PeerProcess, count: int = 1) -> list[str]:
    """Return the nodes of a topic with strings as the peer knows them, as soon as it knows this many."""
    while True:
        other.do("info", name=topic)
        found = await other.event("info")
        if len(found["nodes"]) >= count:
            assert found["types"] == [STRING]
            return found["nodes"]


def text_of(message: bytes) -> str:
    return KILTED.decode(STRING, message).data


@LIBRARIES
@with_timeout
async def test_messages_reach_the_peer(meeting: Meet, library: str) -> None:
    async with meeting(library) as (carrier, other):
        writer = carrier.publish(NODE, "/chatter", KILTED.message(STRING), DEFAULT)
        other.do("subscribe", name="/chatter", latched=False)
        await until(lambda: writer.readers)
        arrives = asyncio.create_task(other.event("message"))
        await repeat(lambda: writer.write(KILTED.encode(STRING, KILTED.make(STRING, data="für alle"))), arrives)
        assert arrives.result()["text"] == "für alle"


@LIBRARIES
@with_timeout
async def test_messages_of_the_peer_arrive(meeting: Meet, library: str) -> None:
    async with meeting(library) as (carrier, other):
        first = asyncio.get_running_loop().create_future()
        carrier.subscribe(
            NODE, "/chatter", KILTED.message(STRING), DEFAULT, lambda *item: first.done() or first.set_result(item)
        )
        await repeat(lambda: other.do("publish", name="/chatter", text="hello"), first)
        message, gid = first.result()
        await until(lambda: carrier.endpoints() and carrier.nodes())
        assert text_of(message) == "hello"
        (endpoint,) = carrier.endpoints()
        assert (endpoint.role, endpoint.name, endpoint.type) == (EndpointRole.PUBLISHER, "/chatter", STRING)
        assert endpoint.hash == KILTED.message(STRING).hash
        assert endpoint.qos == DEFAULT
        assert carrier.nodes() == [NodeName("/", "peer")]
        # The SDK sends random ids instead of those of rmw_zenoh.
        assert carrier.node_of(gid) == ("/peer" if library == "pyzeros" else UNANNOUNCED)


@with_timeout
async def test_late_peers_get_latched_messages(meeting: Meet) -> None:
    async with meeting("sdk") as (carrier, other):
        writer = carrier.publish(NODE, "/map", KILTED.message(STRING), LATCHED)
        for text in ("old", "map"):
            writer.write(KILTED.encode(STRING, KILTED.make(STRING, data=text)))
        # A late subscription of the SDK asks once, and only the publishers that its session already knows.
        assert await nodes_of("/map", other) == ["amcl"]
        arrives = asyncio.create_task(other.event("message"))
        await repeat(lambda: other.do("subscribe", name="/map", latched=True), arrives)
        assert arrives.result()["text"] == "map"


@LIBRARIES
@with_timeout
async def test_the_peer_calls_a_service(meeting: Meet, library: str) -> None:
    async with meeting(library) as (carrier, other):
        callers = []

        def on_request(request, gid, reply) -> None:
            callers.append(carrier.node_of(gid))
            wanted = KILTED.decode(f"{SET_BOOL}_Request", request).data
            made = KILTED.make(f"{SET_BOOL}_Response", success=wanted, message="by the carrier")
            reply(KILTED.encode(f"{SET_BOOL}_Response", made))

        carrier.serve(NODE, "/switch", KILTED.service(SET_BOOL), on_request)
        for wanted in (True, False):
            other.do("call", name="/switch", data=wanted)
            response = await other.event("response")
            assert (response["success"], response["message"]) == (wanted, "by the carrier")
        assert len(callers) == 2
        assert library == "sdk" or set(callers) == {"/peer"}


@LIBRARIES
@with_timeout
async def test_the_peer_answers_a_call(meeting: Meet, library: str) -> None:
    async with meeting(library) as (carrier, other):
        client = carrier.client(NODE, "/switch", KILTED.service(SET_BOOL))
        assert not client.has_server
        other.do("serve", name="/switch")
        await until(lambda: client.has_server)
        for wanted in (True, False):
            request = KILTED.encode(f"{SET_BOOL}_Request", KILTED.make(f"{SET_BOOL}_Request", data=wanted))
            answered = asyncio.get_running_loop().create_future()

            def take(response: bytes, answered: asyncio.Future = answered) -> None:
                if not answered.done():
                    answered.set_result(KILTED.decode(f"{SET_BOOL}_Response", response))

            await repeat(functools.partial(client.call, request, take), answered)
            assert (answered.result().success, answered.result().message) == (wanted, BY[library])


@with_timeout
async def test_the_peer_reads_our_graph(meeting: Meet) -> None:
    async with meeting("sdk") as (carrier, other):
        carrier.publish(NODE, "/robot1/map", KILTED.message(STRING), LATCHED)
        carrier.subscribe(NODE, "/robot1/map", KILTED.message(STRING), DEFAULT, lambda *item: None)
        assert await nodes_of("/robot1/map", other, 2) == ["amcl", "amcl"]


@LIBRARIES
@with_timeout
async def test_a_killed_peer_leaves_the_graph(meeting: Meet, library: str) -> None:
    async with meeting(library) as (carrier, other):
        other.do("subscribe", name="/chatter", latched=False)
        await until(lambda: carrier.nodes() and carrier.endpoints())
        other.kill()
        await until(lambda: not carrier.nodes() and not carrier.endpoints())

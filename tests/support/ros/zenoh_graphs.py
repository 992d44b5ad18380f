"""Graphs over zenoh for tests: a router, carriers that have joined, and waits for events."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AsyncExitStack, asynccontextmanager

from thbridge.ros2.supports import MessageSupport, ServiceSupport
from thbridge.ros2graph.sockets.zenoh import ZenohCarrier
from thbridge.ros2graph.sockets.zenoh_router import zenoh_router
from thbridge.ros2graph.values.graph import NodeName
from thbridge.sockets.addresses import Address, ListeningAddress

DOMAIN = 71
PATIENCE = 60.0
NODE = NodeName("/robot1", "amcl")
OTHER = NodeName("/", "map_server")
STRING = MessageSupport(
    "std_msgs/msg/String", "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
)
ADD_HASH = "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
ADD = ServiceSupport(
    "example_interfaces/srv/AddTwoInts",
    ADD_HASH,
    MessageSupport("example_interfaces/srv/AddTwoInts_Request", ADD_HASH),
    MessageSupport("example_interfaces/srv/AddTwoInts_Response", ADD_HASH),
)


def run(scenario: Callable[[], Awaitable[None]]) -> None:
    """Run a scenario within the time limit; it must leave no task behind."""

    async def within_patience() -> None:
        async with asyncio.timeout(PATIENCE):
            await scenario()
        assert asyncio.all_tasks() == {asyncio.current_task()}

    asyncio.run(within_patience())


async def until(condition: Callable[[], object]) -> None:
    """Wait until a condition is true."""
    while not condition():
        await asyncio.sleep(0.005)


@asynccontextmanager
async def router(port: int = 0) -> AsyncIterator[Address]:
    """Run a router."""
    async with zenoh_router(Address("127.0.0.1", port)) as where:
        assert isinstance(where, ListeningAddress), where
        yield Address(where.host, where.port)


@asynccontextmanager
async def carriers(count: int, at: Address, domain: int = DOMAIN) -> AsyncIterator[list[ZenohCarrier]]:
    """Return carriers that have joined the graph; they leave it at the end."""
    async with AsyncExitStack() as stack:
        joined = [ZenohCarrier(domain, at) for _ in range(count)]
        for each in joined:
            stack.push_async_callback(each.stop)
            assert await each.start() is None
        yield joined

"""Our own programs' client over real TCP, against our server and against scripted ones."""

import asyncio
from collections.abc import AsyncIterator, Awaitable
from contextlib import asynccontextmanager
from typing import TypeVar

import pytest

from tests.support.programs.event_loops import in_event_loop
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.reconnecting import Backoff, ConnectionLost, LossReason
from thbridge.text_protocol.sockets.client import TextClient
from thbridge.text_protocol.sockets.server import TextServer
from thbridge.text_protocol.wire.client import NameRegistered
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.router import MessageRouter

T = TypeVar("T")

HURRIED = Backoff(initial=0.005, maximum=0.02)
HELLO = TextMessage("%%error", "A", "B", ("hello",))
PATIENCE = 120


async def soon(event: Awaitable[T]) -> T:
    async with asyncio.timeout(PATIENCE):
        return await event


@asynccontextmanager
async def serving(port: int = 0) -> AsyncIterator[tuple[MessageRouter, ListeningAddress]]:
    router = MessageRouter()
    server = TextServer()
    address = await server.start(router, "127.0.0.1", port)
    assert isinstance(address, ListeningAddress)
    try:
        yield router, address
    finally:
        await server.stop()


@asynccontextmanager
async def running(name: str, port: int, backoff: Backoff = HURRIED) -> AsyncIterator[TextClient]:
    client = TextClient(name, f"token-{name}", "127.0.0.1", port, backoff)
    task = asyncio.create_task(client.run())
    try:
        yield client
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


@in_event_loop
async def test_two_programs_talk_through_the_server() -> None:
    async with serving() as (_, address), running("A", address.port) as a, running("B", address.port) as b:
        assert await soon(a.next_event()) == NameRegistered()
        assert await soon(b.next_event()) == NameRegistered()
        assert a.take() == []
        assert a.send(HELLO)
        assert await soon(b.next_event()) == HELLO


@in_event_loop
async def test_it_waits_for_a_server_and_registers_again_with_the_next_one() -> None:
    async with serving() as (_, address):
        port = address.port
    async with running("A", port) as a:
        event = await soon(a.next_event())
        assert isinstance(event, ConnectionLost)
        assert event.reason is LossReason.UNREACHABLE
        assert not a.send(HELLO)
        for _ in range(2):
            async with serving(port):
                assert await soon(a.next_event()) == NameRegistered()
            assert await soon(a.next_event()) == ConnectionLost(LossReason.STOPPED)
            event = await soon(a.next_event())
            assert isinstance(event, ConnectionLost)
            assert event.reason is LossReason.UNREACHABLE


@in_event_loop
async def test_a_taken_name_is_told_once_and_had_as_soon_as_it_is_free() -> None:
    async with serving() as (router, address):
        router.local.attach("A")
        async with running("A", address.port) as a:
            assert await soon(a.next_event()) == ConnectionLost(LossReason.REFUSED)
            router.local.detach("A")
            assert await soon(a.next_event()) == NameRegistered()


@in_event_loop
async def test_it_answers_a_ping_and_notices_a_broken_connection() -> None:
    heard: asyncio.Queue[bytes] = asyncio.Queue()

    async def server(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await heard.put(await reader.readline())
        writer.write(b"%%ack \n%%ping \n")
        await heard.put(await reader.readline())
        writer.transport.abort()

    async with await asyncio.start_server(server, "127.0.0.1", 0) as listening:
        port = listening.sockets[0].getsockname()[1]
        async with running("A", port) as a:
            assert await soon(heard.get()) == b"%%setid A extended token-A\n"
            assert await soon(heard.get()) == b"%%pong \n"
            assert await soon(a.next_event()) == NameRegistered()
            event = await soon(a.next_event())
            assert isinstance(event, ConnectionLost)
            assert event.reason is LossReason.BROKEN
            assert await soon(a.next_event()) == NameRegistered()


@in_event_loop
async def test_a_server_that_falls_silent_counts_as_broken() -> None:
    connections = 0

    async def server(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        nonlocal connections
        connections += 1
        writer.write(b"%%ack \n")
        await reader.read()
        writer.close()

    async with await asyncio.start_server(server, "127.0.0.1", 0) as listening:
        port = listening.sockets[0].getsockname()[1]
        async with running("A", port, Backoff(initial=0.005, maximum=0.005, timeout=0.05)) as a:
            assert await soon(a.next_event()) == NameRegistered()
            event = await soon(a.next_event())
            assert isinstance(event, ConnectionLost)
            assert event.reason is LossReason.BROKEN
            assert await soon(a.next_event()) == NameRegistered()
            assert connections == 2


def test_a_bad_name_is_refused_at_once() -> None:
    with pytest.raises(ValueError, match="one word"):
        TextClient("two words", "t", "127.0.0.1", 6009)

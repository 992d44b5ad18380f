"""XML-RPC over real sockets: calls, many a connection, and peers that are slow, hostile or gone."""

import asyncio
import socket
import threading
import xmlrpc.client
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.programs.event_loops import eventually
from thbridge.rosgraph.sockets.documents import read_document, write_document
from thbridge.rosgraph.sockets.http_client import CallFailed, XmlRpcClient
from thbridge.rosgraph.sockets.http_server import CallHandler, HttpLimits, XmlRpcServer
from thbridge.rosgraph.wire import xmlrpc as codec
from thbridge.rosgraph.wire.xmlrpc import Fault, MethodCall, MethodResponse, XmlRpcValue
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen

METHODS = ("echo", "later", "fail", "refuse", "unwritable")
PATIENCE = 60.0


async def _later(value: XmlRpcValue) -> XmlRpcValue:
    await asyncio.sleep(0)
    return value


def handle(call: MethodCall, peer: str) -> XmlRpcValue | Fault | Awaitable[XmlRpcValue | Fault]:
    match call.method:
        case "echo":
            return call.params
        case "later":
            return _later(call.params[0])
        case "refuse":
            return Fault(7, "not now")
        case "unwritable":
            return 2**63
        case _:
            raise RuntimeError("oh")


@asynccontextmanager
async def serving(
    limits: HttpLimits | None = None, handler: CallHandler = handle
) -> AsyncIterator[tuple[XmlRpcServer, ListeningAddress]]:
    server = XmlRpcServer(METHODS, handler, limits)
    address = await server.start()
    assert isinstance(address, ListeningAddress)
    try:
        yield server, address
    finally:
        await server.stop()
        assert server.connections == 0


def run(scenario: Callable[[], Awaitable[None]]) -> None:
    async def within_patience() -> None:
        async with asyncio.timeout(PATIENCE):
            await scenario()
        assert asyncio.all_tasks() == {asyncio.current_task()}

    asyncio.run(within_patience())


def request(method: str, *params: XmlRpcValue) -> bytes:
    body = codec.encode_call(method, [*params])
    return b"POST /RPC2 HTTP/1.1\r\nHost: x\r\nContent-Length: %d\r\n\r\n%b" % (len(body), body)


def test_calls_and_their_answers():
    async def scenario():
        async with serving() as (server, at):
            client, uri = XmlRpcClient(), f"http://{at.host}:{at.port}/"
            assert await client.call(uri, "echo", 1, "two", [3.0]) == MethodResponse([1, "two", [3.0]])
            assert await client.call(uri, "later", {"a": True}) == MethodResponse({"a": True})
            assert await client.call(uri, "refuse") == Fault(7, "not now")
            assert await client.call(uri, "unwritable") == Fault(
                1, "the answer cannot be encoded: 9223372036854775808 does not fit into 64 bits"
            )
            failed = await client.call(uri, "fail")
            assert isinstance(failed, Fault) and "oh" in failed.text
            unknown = await client.call(uri, "no_such")
            assert isinstance(unknown, Fault) and "no_such" in unknown.text
            assert server.connections == 1
            await client.close()

    run(scenario)


def test_multicall_and_list_methods():
    async def scenario():
        async with serving() as (_, at):
            client, uri = XmlRpcClient(), f"http://{at.host}:{at.port}"
            calls: list[XmlRpcValue] = [
                {"methodName": "echo", "params": ["x"]},
                {"methodName": "refuse", "params": []},
                {"methodName": "system.multicall", "params": [[]]},
                17,
            ]
            answer = await client.call(uri, "system.multicall", calls)
            assert isinstance(answer, MethodResponse) and isinstance(answer.value, list)
            assert answer.value[0] == [["x"]]
            assert [set(fault) for fault in answer.value[1:]] == [{"faultCode", "faultString"}] * 3
            assert isinstance(await client.call(uri, "system.multicall", 1), Fault)
            names = await client.call(uri, "system.listMethods")
            assert isinstance(names, MethodResponse) and set(names.value) == {
                *METHODS,
                "system.listMethods",
                "system.multicall",
            }
            await client.close()

    run(scenario)


def test_pythons_own_client_calls_us():
    async def scenario():
        async with serving() as (_server, at):

            def ask() -> object:
                with xmlrpc.client.ServerProxy(f"http://{at.host}:{at.port}") as proxy:
                    many = xmlrpc.client.MultiCall(proxy)
                    many.echo(1)
                    many.echo("b")
                    return proxy.echo("a", b"b"), tuple(many())

            answer, many = await asyncio.to_thread(ask)
            assert answer[0] == "a" and answer[1].data == b"b"
            assert many == ([1], ["b"])

    run(scenario)


def test_requests_one_upon_another_and_byte_by_byte():
    async def scenario():
        async with serving() as (_, at):
            reader, writer = await asyncio.open_connection(at.host, at.port)
            writer.write(request("echo", "first") + request("echo", "second"))
            for byte in request("echo", "third"):
                writer.write(bytes([byte]))
                await writer.drain()
            for word in (b"first", b"second", b"third"):
                assert word in await reader.readuntil(b"</methodResponse>\n")
            writer.close()

    run(scenario)


@pytest.mark.parametrize(
    ("sent", "status"),
    [
        (b"GET / HTTP/1.1\r\nHost: x\r\n\r\n", b"405"),
        (b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999\r\n\r\n", b"413"),
        (b"POST / HTTP/1.1\r\nHost: x\r\nOrigin: null\r\nContent-Length: 0\r\n\r\n", b"403"),
        (b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: many\r\n\r\n", b"400"),
        (b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: " + b"9" * 5000 + b"\r\n\r\n", b"400"),
        (b"POST / HTTP/1.1\r\nHost: x\r\n" + b"a: b\r\n" * 50_000 + b"\r\n", b"431"),
        (
            b"POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
            + b"10000\r\n%b\r\n" % (b" " * 2**16) * 300,
            b"413",
        ),
        (b"\x16\x03\x01\x00\xf1\r\n\r\n", b"400"),
    ],
)
def test_what_is_no_request_is_turned_away(sent, status):
    async def scenario():
        async with serving() as (server, at):
            reader, writer = await asyncio.open_connection(at.host, at.port)
            writer.write(sent)
            answer = await reader.read(20)
            assert answer.startswith(b"HTTP/1.1 " + status)
            writer.close()
            await eventually(lambda: server.connections == 0)

    run(scenario)


def test_a_call_that_is_none_is_a_fault_and_the_connection_goes_on():
    async def scenario():
        async with serving() as (_, at):
            reader, writer = await asyncio.open_connection(at.host, at.port)
            writer.write(b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 3\r\n\r\n<a>" + request("echo", "more"))
            assert b"-32700" in await reader.readuntil(b"</methodResponse>\n")
            assert b"more" in await reader.readuntil(b"</methodResponse>\n")
            writer.close()

    run(scenario)


def test_slow_silent_and_half_open_peers_are_cut_off():
    async def scenario():
        limits = HttpLimits(request_seconds=0.1, idle_seconds=0.1)
        async with serving(limits) as (server, at):
            for sent in (b"", b"POST /", request("echo")[:-5], request("echo") + b"POST"):
                reader, writer = await asyncio.open_connection(at.host, at.port)
                writer.write(sent)
                with_rest = await reader.read()  # ends because the server does
                assert with_rest.count(b"HTTP/1.1 200") == sent.count(b"</methodCall>")
                writer.close()
            await eventually(lambda: server.connections == 0)

    run(scenario)


def test_a_peer_that_does_not_read_is_cut_off():
    async def scenario():
        async with serving(HttpLimits(request_seconds=0.1)) as (server, at):
            _reader, writer = await asyncio.open_connection(at.host, at.port)
            writer.write(request("echo", "x" * 8_000_000))
            await eventually(lambda: server.connections == 1)
            await eventually(lambda: server.connections == 0)
            writer.transport.abort()

    run(scenario)


def test_one_connection_too_many_ends_the_one_that_is_silent_longest():
    async def scenario():
        async with serving(HttpLimits(connections=3)) as (server, at):
            peers = [await asyncio.open_connection(at.host, at.port) for _ in range(3)]
            await eventually(lambda: server.connections == 3)
            for reader, writer in (peers[0], peers[2]):
                writer.write(request("echo"))
                await reader.readuntil(b"</methodResponse>\n")
            peers.append(await asyncio.open_connection(at.host, at.port))
            assert await peers[1][0].read() == b""
            for reader, writer in (peers[0], peers[2], peers[3]):
                writer.write(request("echo"))
                await reader.readuntil(b"</methodResponse>\n")
            for _, writer in peers:
                writer.close()

    run(scenario)


def test_many_connections_from_one_address_end_none_of_another():
    async def scenario():
        async with serving(HttpLimits(connections=3)) as (server, at):
            ours, to_us = await asyncio.open_connection(at.host, at.port)
            await eventually(lambda: server.connections == 1)
            flood = [await asyncio.open_connection(at.host, at.port, local_addr=("127.0.0.2", 0)) for _ in range(20)]
            for reader, _ in flood[:-2]:
                assert await reader.read() == b""
            to_us.write(request("echo"))
            await ours.readuntil(b"</methodResponse>\n")
            for writer in (to_us, *(writer for _, writer in flood)):
                writer.close()

    run(scenario)


def test_answers_that_nobody_reads_have_a_bound():
    async def scenario():
        async with serving(HttpLimits(held_bytes=20_000_000)) as (_server, at):
            peer = socket.socket()
            peer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 65_536)  # else the system may take the whole answer
            peer.connect((at.host, at.port))
            reader, writer = await asyncio.open_connection(sock=peer)
            writer.write(request("echo", "x" * 15_000_000))
            await reader.readexactly(1)  # its answer is under way; requests have the same bound
            client = XmlRpcClient()
            answer = await client.call(f"http://{at.host}:{at.port}", "echo", "x" * 8_000_000)
            assert isinstance(answer, Fault)
            assert "too many unread answers" in answer.text
            writer.transport.abort()
            await client.close()

    run(scenario)


def test_long_documents_are_read_and_written_beside_the_loop():
    async def scenario():
        loop_thread = threading.get_ident()

        def thread_of(document: bytes) -> int:
            return threading.get_ident()

        assert await read_document(thread_of, b"x" * 100) == loop_thread
        assert await read_document(thread_of, b"x" * 100_000) != loop_thread
        for value, at_once in (("x", True), (["x"] * 10_000, False), ({"a": "x" * 100_000}, False)):
            threads: list[int] = []
            await write_document(lambda threads=threads: bytes(threads.append(threading.get_ident()) or b""), value)
            assert (threads == [loop_thread]) is at_once

    run(scenario)


def test_a_connection_that_is_cut_off_before_its_first_word_is_closed():
    async def scenario():
        server = XmlRpcServer(METHODS, handle, HttpLimits(connections=1))
        at = await server.start()
        assert isinstance(at, ListeningAddress)
        peers = [await asyncio.open_connection(at.host, at.port) for _ in range(20)]
        await eventually(lambda: server.connections == 1)
        await server.stop()
        for reader, writer in peers:
            assert await reader.read() == b""
            writer.close()

    run(scenario)


def test_what_is_held_at_a_time_is_bounded():
    async def scenario():
        async with serving(HttpLimits(held_bytes=100_000)) as (server, at):
            peers = [await asyncio.open_connection(at.host, at.port) for _ in range(3)]
            for _, writer in peers:
                writer.write(request("echo", "x" * 60_000)[:-1])
            answers = [asyncio.ensure_future(reader.read(12)) for reader, _ in peers]
            done, waiting = await asyncio.wait(answers, return_when=asyncio.FIRST_COMPLETED)
            assert {task.result() for task in done} == {b"HTTP/1.1 503"}
            for task in waiting:
                task.cancel()
            for _, writer in peers:
                writer.transport.abort()
            await asyncio.wait(answers)
            await eventually(lambda: server.connections == 0)
            client = XmlRpcClient()
            assert await client.call(f"http://{at.host}:{at.port}", "later", "x" * 60_000) == MethodResponse(
                "x" * 60_000
            )
            await client.close()

    run(scenario)


def test_two_servers_do_not_share_a_port():
    async def scenario():
        async with serving() as (_, at):
            second = await XmlRpcServer((), handle).start(at.host, at.port)
            assert isinstance(second, CannotListen)
        assert isinstance(await XmlRpcServer((), handle).start("127.0.0.1", 70_000), CannotListen)
        assert isinstance(await XmlRpcServer((), handle).start("a" * 80 + ".x", 0), CannotListen)

    run(scenario)


def test_a_client_outlives_its_servers():
    async def scenario():
        client = XmlRpcClient()
        async with serving() as (_, at):
            uri = f"http://{at.host}:{at.port}/"
            assert await client.call(uri, "later", 1) == MethodResponse(1)
        failed = await client.call(uri, "later", 1)
        assert isinstance(failed, CallFailed) and uri in str(failed)
        again = XmlRpcServer(METHODS, handle)
        assert isinstance(await again.start(at.host, at.port), ListeningAddress)
        assert await client.call(uri, "later", 2) == MethodResponse(2)
        await again.stop()
        again = XmlRpcServer(METHODS, handle)
        assert isinstance(await again.start(at.host, at.port), ListeningAddress)
        assert await client.call(uri, "later", 3) == MethodResponse(3)  # the kept connection is stale, and replaced
        await client.close()
        await again.stop()

    run(scenario)


@pytest.mark.parametrize(
    "uri",
    ["", "rosrpc://x:1", "http://", "http://x:port/", "http://[::1/", "http://127.0.0.1:1/a b", f"http://{'a' * 80}/"],
)
def test_uris_that_lead_nowhere(uri):
    async def scenario():
        assert isinstance(await XmlRpcClient().call(uri, "echo"), CallFailed)

    run(scenario)


@pytest.mark.parametrize(
    "said",
    [
        b"",
        b"HTTP/1.1 500 No\r\nContent-Length: 0\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nContent-Length: 3\r\n\r\n<a>",
        b"HTTP/1.1 200 OK\r\nContent-Length: 30\r\n\r\n<a>",
        b"220 smtp.example.org ready\r\n",
        b"HTTP/1.1 200 OK\r\n" + b"a: b\r\n" * 10_000,
    ],
)
def test_servers_that_speak_something_else(said):
    async def scenario():
        async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            await reader.readuntil(b"</methodCall>\n")
            writer.write(said)
            writer.close()

        server = await asyncio.start_server(answer, "127.0.0.1", 0)
        host, port = server.sockets[0].getsockname()
        client = XmlRpcClient()
        assert isinstance(await client.call(f"http://{host}:{port}/", "echo"), CallFailed)
        await client.close()
        server.close()
        await server.wait_closed()

    run(scenario)


def test_a_server_that_says_nothing_costs_the_timeout():
    async def scenario():
        with socket.create_server(("127.0.0.1", 0)) as silent:
            failed = await XmlRpcClient().call(f"http://127.0.0.1:{silent.getsockname()[1]}/", "echo", timeout=0.05)
            assert failed == CallFailed(f"http://127.0.0.1:{silent.getsockname()[1]}/", "no answer within 0.05 s")

    run(scenario)


def test_the_client_keeps_few_connections():
    async def scenario():
        client = XmlRpcClient(kept=2)
        servers = [XmlRpcServer(METHODS, handle) for _ in range(4)]
        for server in servers:
            at = await server.start()
            assert isinstance(at, ListeningAddress)
            uri = f"http://{at.host}:{at.port}/"
            many = await asyncio.gather(*(client.call(uri, "later", number) for number in range(5)))
            assert many == [MethodResponse(number) for number in range(5)]
        while sum(server.connections for server in servers) != 2:
            await asyncio.sleep(0.005)
        await client.close()
        for server in servers:
            await server.stop()

    run(scenario)


bits = st.sampled_from(
    [
        request("echo", "a"),
        b"POST / HTTP/1.1\r\n",
        b"Content-Length: 5\r\n",
        b"\r\n\r\n",
        b"Transfer-Encoding: chunked\r\n",
        b"<value>",
    ]
)


@given(st.lists(st.lists(st.binary(max_size=40) | bits, max_size=6).map(b"".join), min_size=1, max_size=4))
@settings(max_examples=40, deadline=None)
def test_arbitrary_bytes_over_sockets_leave_nothing_behind(streams):
    async def scenario():
        async with serving(HttpLimits(request_seconds=1)) as (server, at):
            for stream in streams:
                reader, writer = await asyncio.open_connection(at.host, at.port)
                writer.write(stream)
                writer.write_eof()
                with suppress(ConnectionError):
                    await reader.read()
                writer.close()
            await eventually(lambda: server.connections == 0)
            client = XmlRpcClient()
            assert await client.call(f"http://{at.host}:{at.port}", "later", 1) == MethodResponse(1)
            await client.close()

    run(scenario)

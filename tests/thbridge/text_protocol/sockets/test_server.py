"""The text server over real TCP."""

import asyncio
import contextlib
import socket
import struct
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import pytest

from tests.support.programs.event_loops import in_event_loop
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.listening import ServerDoor
from thbridge.text_protocol.sockets import server as text_server
from thbridge.text_protocol.sockets.server import TextServer
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.router import MessageRouter, RouterLimits

ACK = b"%%ack \n"
SHUTDOWN = b"%%sshhuuttddoowwnn \n"
PATIENCE = 120  # seconds until a test that hangs gives up; nothing waits that long otherwise


class Client:
    """A plain TCP client, as a stranger would write it."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader = reader
        self.writer = writer

    async def says(self, data: bytes) -> None:
        self.writer.write(data)
        await self.writer.drain()

    async def hears(self) -> bytes:
        async with asyncio.timeout(PATIENCE):
            return await self.reader.readline()

    async def hears_the_rest(self) -> bytes:
        async with asyncio.timeout(PATIENCE):
            return await self.reader.read()


class House:
    """A running server and the clients of one test."""

    def __init__(self, server: TextServer, address: ListeningAddress) -> None:
        self.server = server
        self.address = address
        self.clients: list[Client] = []

    async def enter(self, name: str = "") -> Client:
        client = Client(*await asyncio.open_connection(self.address.host, self.address.port, limit=1 << 20))
        self.clients.append(client)
        if name:
            await client.says(f"%%setid {name}\n".encode())
            assert await client.hears() == ACK
        return client


@asynccontextmanager
async def serving(
    router: MessageRouter | None = None,
    clock: Callable[[], float] = lambda: 0.0,
) -> AsyncIterator[House]:
    server = TextServer(clock)
    address = await server.start(router or MessageRouter(), "127.0.0.1", 0)
    assert isinstance(address, ListeningAddress)
    house = House(server, address)
    try:
        yield house
    finally:
        for client in house.clients:
            client.writer.close()
        async with asyncio.timeout(PATIENCE):
            await server.stop()


@in_event_loop
async def test_two_clients_talk() -> None:
    async with serving() as house:
        tabui, simr = await house.enter("TabUI"), await house.enter("SimR \r")
        await tabui.says(b"%%goto  TabUI SimR 0 3 3 45\r\n")
        assert await tabui.hears() == ACK
        assert await simr.hears() == b"%%goto TabUI SimR 0 3 3 45 \n"


@in_event_loop
async def test_half_lines_wait_and_several_lines_share_a_segment() -> None:
    async with serving() as house:
        client = await house.enter()
        for piece in [b"%%pi", b"ng\n%%get", b"id\n\xff\n\n"]:
            await client.says(piece)
            await asyncio.sleep(0)
        assert [await client.hears() for _ in range(6)] == [b"%%pong i am here\n", ACK, b"%%setid 1\n", ACK, ACK, ACK]


@in_event_loop
async def test_a_held_name_gets_a_farewell_and_the_end() -> None:
    async with serving() as house:
        holder, newcomer = await house.enter("TabUI"), await house.enter()
        await newcomer.says(b"%%setid TabUI\n%%ping\n" + b"more\n" * 1000)
        assert await newcomer.hears_the_rest() == SHUTDOWN
        await holder.says(b"%%ping\n")
        assert await holder.hears() == b"%%pong i am here\n"


@in_event_loop
async def test_a_name_is_free_once_its_client_has_gone() -> None:
    async with serving() as house:
        for leave in [b"%%sshhuuttddoowwnn\n", b""]:
            client = await house.enter("TabUI")
            await client.says(leave)
            client.writer.write_eof()
            assert await client.hears_the_rest() == b""
        await house.enter("TabUI")


@in_event_loop
async def test_300_connections_of_which_256_find_room() -> None:
    async with serving() as house:
        clients = [await house.enter() for _ in range(300)]
        for number, client in enumerate(clients[:256]):
            await client.says(f"%%setid client{number}\n".encode())
        for client in clients[:256]:
            assert await client.hears() == ACK
        for client in clients[256:]:
            await client.says(b"%%setid late\n")
            assert await client.hears_the_rest() == SHUTDOWN
        await clients[0].says(b"%%error client0 client255 hello\n")
        assert await clients[255].hears() == b"%%error client0 client255 hello \n"


@in_event_loop
async def test_of_many_that_are_turned_away_few_linger() -> None:
    async with serving(MessageRouter(RouterLimits(clients=1))) as house:
        await house.enter("SimR")
        # None of them closes its side.
        turned_away = [await house.enter() for _ in range(200)]
        assert [await client.hears() for client in turned_away] == [SHUTDOWN] * 200
        assert len(house.server._open) <= text_server._MOST_LINGERING + 2


@in_event_loop
async def test_a_server_full_of_silent_connections_lets_a_program_in() -> None:
    now = [0.0]
    async with serving(MessageRouter(RouterLimits(clients=20)), clock=lambda: now[0]) as house:
        silent = [await house.enter() for _ in range(20)]
        now[0] = 3.0
        simr = await house.enter("SimR")
        await simr.says(b"%%ping\n")
        assert await simr.hears() == b"%%pong i am here\n"
        assert await silent[0].hears_the_rest() == b""


def test_where_descriptors_are_few_those_without_a_name_make_room(monkeypatch: pytest.MonkeyPatch) -> None:
    @in_event_loop
    async def whole() -> None:
        async with serving() as house:
            simr, nameless = await house.enter("SimR"), await house.enter()
            monkeypatch.setattr(ServerDoor, "most", 2)
            tabui = await house.enter("TabUI")
            assert await nameless.hears_the_rest() == b""
            await tabui.says(b"%%goto TabUI SimR 0 3 3 45\n")
            assert await simr.hears() == b"%%goto TabUI SimR 0 3 3 45 \n"
            kept_out = await house.enter()
            assert await kept_out.hears_the_rest() == b"", "all others have names"

    whole()


@in_event_loop
async def test_a_client_that_never_reads_is_cut_off_and_hurts_nobody() -> None:
    async with serving() as house:
        deaf = socket.socket()
        deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        deaf.connect((house.address.host, house.address.port))
        deaf.sendall(b"%%setid deaf\n")
        speaker = await house.enter("speaker extended")
        line = b"%%error speaker deaf " + b"x" * 60_000 + b"\n"
        for _ in range(500):
            await speaker.says(line)
            answer = await speaker.hears()
            if answer != ACK:
                assert answer.startswith(b"%%error Server speaker thbridge ")
                assert await speaker.hears() == ACK
                break
        else:
            pytest.fail("30 MB were buffered for a client that does not read")
        await speaker.says(b"%%error speaker speaker hello\n")
        assert await speaker.hears() == b"%%error speaker speaker hello \n"
        deaf.close()


@in_event_loop
async def test_clients_that_reset_their_connection_hurt_nobody() -> None:
    async with serving() as house:
        other = await house.enter("other")
        for _ in range(5):
            rude = socket.create_connection((house.address.host, house.address.port))
            rude.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            rude.sendall(b"%%ping\n" * 1000)
            rude.close()
        await other.says(b"%%error other other hello\n")
        assert await other.hears() == b"%%error other other hello \n"


@in_event_loop
async def test_a_megabyte_without_an_end_is_skipped() -> None:
    async with serving() as house:
        client = await house.enter()
        await client.says(b"x" * 1_000_000)
        await client.says(b"\n%%ping\n")
        assert [await client.hears() for _ in range(3)] == [ACK, b"%%pong i am here\n", ACK]


def test_silent_clients_are_pinged_by_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text_server, "_CHECK_INTERVAL", 0.001)
    now = [100.0]

    @in_event_loop
    async def whole() -> None:
        async with serving(clock=lambda: now[0]) as house:
            client = await house.enter("A")
            now[0] = 115.0
            assert await client.hears() == b"%%ping \n"
            now[0] = 130.0
            assert await client.hears_the_rest() == b""
            await house.enter("A")

    whole()


@in_event_loop
async def test_a_stopping_server_says_farewell_and_frees_its_port() -> None:
    async with serving() as house:
        clients = [await house.enter("A"), await house.enter()]
        stopping = asyncio.create_task(house.server.stop())
        for client in clients:
            assert await client.hears_the_rest() == SHUTDOWN
            client.writer.close()
        await stopping
        with pytest.raises(ConnectionRefusedError):
            await house.enter()
        again = TextServer()
        assert await again.start(MessageRouter(), house.address.host, house.address.port) == house.address
        await again.stop()


@in_event_loop
async def test_a_client_that_ignores_the_farewell_does_not_keep_the_server_from_stopping() -> None:
    async with serving() as house:
        stubborn = await house.enter("A")
        await house.server.stop()
        assert await stubborn.hears_the_rest() == SHUTDOWN


@in_event_loop
async def test_the_window_of_2016_finds_the_server_at_the_address_that_it_was_built_with() -> None:
    async with serving() as house:
        reader, writer = await asyncio.open_connection("127.0.1.1", house.address.port)
        house.clients.append(Client(reader, writer))
        tabui, simr = house.clients[0], await house.enter("SimR")
        await tabui.says(b"%%setid TabUI\n")
        assert await tabui.hears() == ACK
        await tabui.says(b"%%goto TabUI SimR 0 3 3 45\n")
        assert await tabui.hears() == ACK
        assert await simr.hears() == b"%%goto TabUI SimR 0 3 3 45 \n"


@in_event_loop
async def test_who_has_that_address_keeps_it_and_the_server_serves_all_the_same() -> None:
    with socket.create_server(("127.0.1.1", 0)) as other:
        server = TextServer()
        address = await server.start(MessageRouter(), "127.0.0.1", other.getsockname()[1])
        assert isinstance(address, ListeningAddress)
        await server.stop()


@in_event_loop
async def test_a_port_in_use_is_told_in_one_line() -> None:
    async with serving() as house:
        refusal = await TextServer().start(MessageRouter(), house.address.host, house.address.port)
        assert isinstance(refusal, CannotListen)
        assert str(refusal).startswith(f"cannot listen on 127.0.0.1:{house.address.port}: ")
        assert "\n" not in str(refusal)


@pytest.mark.parametrize(
    ("host", "port"), [("127.0.0.1", 70_000), ("127.0.0.1", -1), ("not a host", 0), ("x" * 80, 0), ("203.0.113.7", 0)]
)
def test_a_bad_address_is_told_in_one_line(host: str, port: int) -> None:
    refusal = asyncio.run(TextServer().start(MessageRouter(), host, port))
    assert isinstance(refusal, CannotListen)
    assert str(refusal).startswith(f"cannot listen on {host}:{port}: ")
    assert "\n" not in str(refusal)


@in_event_loop
async def test_programs_of_this_process_talk_with_clients() -> None:
    router = MessageRouter()
    router.local.attach("SimR")
    async with serving(router) as house:
        tabui = await house.enter("TabUI")
        await tabui.says(b"%%goto TabUI SimR 0 3 3 45\n%%snap TabUI Hider 3\n")
        assert [await tabui.hears(), await tabui.hears()] == [ACK, ACK]
        house.server.perform(router.exchange())
        goto = TextMessage("%%goto", "TabUI", "SimR", ("0", "3", "3", "45"))
        assert router.local.take("SimR") == [goto]
        arrived = TextMessage("%%error", "SimR", "TabUI", ('"0;3"',))
        router.local.submit("SimR", arrived)
        house.server.perform(router.exchange())
        assert await tabui.hears() == b'%%error SimR TabUI "0;3" \n'


@in_event_loop
async def test_messages_in_the_request_of_a_page_in_a_browser_are_not_heard():
    router = MessageRouter()
    router.local.attach("Game")
    async with serving(router) as house:
        hider = await house.enter("hider")
        page = await house.enter()
        await page.says(b"POST / HTTP/1.1\r\nHost: x\r\n\r\n%%setid simr \n%%goto simr Game 0 1 1 45 \n")
        with contextlib.suppress(ConnectionError):
            assert await page.hears_the_rest() == b""
        await house.enter("simr")  # the name is free: whoever has it is the first
        await hider.says(b"%%ping \n")
        assert (await hider.hears()).startswith(b"%%pong")
        router.exchange()
        assert router.local.take("Game") == []

"""A flood of lines while no tick is run: what is kept for the next one is bounded, none is lost, others are heard."""

import asyncio
from pathlib import Path

from thbridge.app.compose.session import Programs, SessionRecording, open_session
from thbridge.app.compose.setting import read_setting
from thbridge.app.session.inputs import BytesReceived
from thbridge.app.session.session import Session, SessionOutlets, TickRecord
from thbridge.sockets.addresses import ListeningAddress
from thbridge.study.study_file import Study
from thbridge.text_protocol.sockets.server import TextServer

PATIENCE = 60.0
LINE = b"%%error Flood Nobody x\n"
LINES = 8_000


class Records:
    def __init__(self) -> None:
        self.ticks: list[TickRecord] = []

    def record(self, record: TickRecord) -> None:
        self.ticks.append(record)


def heard(ticks: list[TickRecord], sender: str) -> bytes:
    given = (item for tick in ticks for item in tick.inputs)
    return b"".join(item.data for item in given if isinstance(item, BytesReceived) and item.sender == sender)


async def served() -> tuple[Session, TextServer, ListeningAddress, Records]:
    records = Records()
    setting, server = read_setting(Study(), Path()), TextServer()
    session = open_session(setting, Programs(), SessionRecording([records]), SessionOutlets(server.perform))
    where = await server.start(session.router, "127.0.0.1", 0)
    assert isinstance(where, ListeningAddress)
    return session, server, where, records


async def until_quiet() -> None:
    for _ in range(2000):
        await asyncio.sleep(0)


def test_a_flood_in_a_pause_waits_in_the_sockets_and_is_heard_line_by_line() -> None:
    async def flood() -> None:
        session, server, where, records = await served()
        _, loud = await asyncio.open_connection(where.host, where.port)
        loud.write(b"%%setid Flood\n" + LINE * LINES)
        await until_quiet()
        reader, writer = await asyncio.open_connection(where.host, where.port)
        writer.write(b"%%setid Quiet\n%%ping\n")
        async with asyncio.timeout(PATIENCE):
            assert await reader.readline() == b"%%ack \n"
            assert await reader.readline() == b"%%pong i am here\n"
        session.step()
        assert 0 < len(heard(records.ticks, "Flood")) < 20_000
        async with asyncio.timeout(PATIENCE):
            while len(heard(records.ticks, "Flood")) < LINES * len(LINE):
                session.step()
                await until_quiet()
        assert heard(records.ticks, "Flood") == LINE * LINES
        assert max(len(tick.inputs) for tick in records.ticks) < 200
        loud.close()
        writer.close()
        await server.stop()

    asyncio.run(flood())


def test_many_that_flood_share_what_a_tick_takes() -> None:
    async def flood() -> None:
        session, server, where, records = await served()
        writers = [(await asyncio.open_connection(where.host, where.port))[1] for _ in range(100)]
        for writer in writers:
            writer.write(LINE * 500)
        await until_quiet()
        session.step()
        for _ in range(5):
            session.step()
            await until_quiet()
        assert max(len(tick.inputs) for tick in records.ticks) < 100 * 9 + 512
        for writer in writers:
            writer.close()
        await server.stop()

    asyncio.run(flood())

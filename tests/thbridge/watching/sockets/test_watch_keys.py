"""Keys with rights at the watch server, over real TCP."""

import asyncio
import json
from collections.abc import Mapping
from pathlib import Path

import pytest

from thbridge.files.keys.certificate import certificate_of
from thbridge.files.keys.key_ring import KeyRing, Right
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.keys import RingKeys
from thbridge.sockets.tls import server_context
from thbridge.watching.sockets.server import SessionPace, WatchServer
from thbridge.watching.wire import BagStreamReader, SessionMessage, WatchStatus, parse_status

PATIENCE = 120.0


class Session:
    """A session that takes down who asks what."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, object]] = []

    def ask(self, watcher: str, wish: Mapping[str, object], key: str = "") -> str | None:
        self.asked.append((watcher, wish["request"]))
        return None

    def pace(self) -> SessionPace:
        return SessionPace(paused=False, rate=1.0, lag=0.0)

    def unwatched(self) -> None:
        pass


class Window:
    """A researcher's window."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer, self._stream = reader, writer, BagStreamReader()

    def says(self, **line: object) -> None:
        self._writer.write(json.dumps(line).encode() + b"\n")

    async def status(self) -> WatchStatus | None:
        """Return the next status; None at the end."""
        async with asyncio.timeout(PATIENCE):
            while data := await self._reader.read(2**16):
                for message in self._stream.feed(data):
                    status = parse_status(message) if isinstance(message, SessionMessage) else None
                    if status is not None:
                        return status
        return None

    async def refusal(self) -> str:
        """Return the reason of the next refusal."""
        while (status := await self.status()) is not None:
            if status.refused is not None:
                return status.refused.reason
        return "closed"

    def close(self) -> None:
        self._writer.close()


NOW = "2026-03-01T12:00:00Z"


@pytest.fixture
def ring(tmp_path: Path) -> KeyRing:
    ring = KeyRing(tmp_path / "keys", lambda: NOW)
    ring.add("looks", [Right.WATCH], "secret of looks", None)
    ring.add("acts", [Right.WATCH, Right.INTERVENE], "secret of acts", None)
    ring.add("late", [Right.WATCH, Right.INTERVENE], "secret of late", "2026-03-01T11:00:00Z")
    return ring


def test_a_key_is_good_for_its_rights_alone_and_told_with_what_is_asked(ring: KeyRing) -> None:
    async def watch() -> None:
        session = Session()
        server = WatchServer(session, RingKeys(ring, server_context(certificate_of(ring.folder, NOW))))
        where = await server.start("127.0.0.1", 0)
        assert isinstance(where, ListeningAddress)

        async def window(key: str) -> Window:
            opened = Window(*await asyncio.open_connection(where.host, where.port))
            opened.says(key=key)
            return opened

        looks, acts = await window("secret of looks"), await window("secret of acts")
        assert await looks.status() is not None
        assert await acts.status() is not None
        looks.says(request="Pause", fields={})
        assert await looks.refusal() == "this key allows watching only"
        acts.says(request="Pause", fields={})
        async with asyncio.timeout(PATIENCE):
            while not session.asked:
                await acts.status()
        assert session.asked == [("watcher 2 (acts)", "Pause")]
        wrong, late = await window("secret"), await window("secret of late")
        assert await wrong.refusal() == "the key is wrong"
        assert await late.refusal() == "the key late has expired"
        ring.revoke("acts")
        assert await acts.refusal() == "the key acts was revoked"
        assert await acts.status() is None
        again = await window("secret of acts")
        assert await again.refusal() == "the key acts was revoked"
        assert await looks.status() is not None
        for each in (looks, acts, wrong, late, again):
            each.close()
        await server.stop()

    asyncio.run(watch())

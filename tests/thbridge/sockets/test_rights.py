"""Each right at each door, over real TLS: who may do what, and what those are told who may not."""

import asyncio
import socket
import ssl
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from thbridge.credentials import Right, key_line
from thbridge.files.keys.certificate import certificate_of
from thbridge.files.keys.key_file import ClientKey, read_key
from thbridge.files.keys.key_ring import KeyRing
from thbridge.sockets import admission
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.keys import RingKeys
from thbridge.sockets.reconnecting import Backoff, ConnectionLost, LossReason
from thbridge.sockets.tls import server_context
from thbridge.text_protocol.sockets import server as text_server
from thbridge.text_protocol.sockets.client import TextClient
from thbridge.text_protocol.sockets.server import TextServer
from thbridge.text_protocol.wire.client import NameRegistered
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import notice
from thbridge.text_protocol.wire.router import ConnectionId, Forwarded, MessageRouter, RouterOutput
from thbridge.watching.sockets import server as watch_server
from thbridge.watching.sockets.client import SessionMessage, WatchClient, WatchConnected
from thbridge.watching.sockets.server import SessionPace, WatchServer
from thbridge.watching.wire import parse_status

PATIENCE = 120.0
NOW = "2026-03-01T12:00:00Z"
SOON = Backoff(0.05, 0.05, 20.0)

NAMES = {"SimR": Right.ROBOTS, "Hider": Right.HIDER, "TabUI": Right.PARTICIPANT, "Anybody": Right.PARTICIPANT}
MAY = {right: {name for name, needed in NAMES.items() if right in (needed, Right.ADMIN)} for right in Right}
MAY[Right.WATCH] |= {"watch"}
MAY[Right.INTERVENE] |= {"watch", "ask"}
MAY[Right.ADMIN] |= {"watch", "ask"}


class Session:
    """A session that grants whatever watchers ask for."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, str]] = []

    def ask(self, watcher: str, wish: Mapping[str, object], key: str = "") -> str | None:
        self.asked.append((watcher, key))
        return None

    def pace(self) -> SessionPace:
        return SessionPace(paused=False, rate=1.0, lag=0.0)

    def unwatched(self) -> None:
        pass


class HearingRouter(MessageRouter):
    """Router that keeps what it forwarded."""

    def __init__(self) -> None:
        super().__init__()
        self.heard: list[Forwarded] = []

    def receive_data(self, connection: ConnectionId, data: bytes, now: float) -> list[RouterOutput]:
        outputs = super().receive_data(connection, data, now)
        self.heard += [output for output in outputs if isinstance(output, Forwarded)]
        return outputs


class House:
    """A session's doors for whoever has a key of a ring, which has one for each right, named after it."""

    def __init__(self, folder: Path) -> None:
        self.now = NOW
        self.ring = KeyRing(folder / "keys", lambda: self.now)
        self.keys = {
            right: read_key(self.ring.add(right, [right], f"secret of {right}", "2026-03-02T12:00:00Z"))
            for right in Right
        }
        self.session = Session()
        self.verifier = RingKeys(self.ring, server_context(certificate_of(self.ring.folder, NOW)))
        self.router = HearingRouter()
        self.router.local.attach("Game")
        self.text = TextServer(keys=self.verifier)
        self.watch = WatchServer(self.session, self.verifier)
        self.ports = (0, 0)

    @asynccontextmanager
    async def open(self) -> AsyncIterator[None]:
        where = await self.text.start(self.router, "127.0.0.1", 0), await self.watch.start("127.0.0.1", 0)
        assert isinstance(where[0], ListeningAddress)
        assert isinstance(where[1], ListeningAddress)
        self.ports = where[0].port, where[1].port
        try:
            yield
        finally:
            await self.watch.stop()
            await self.text.stop()

    @asynccontextmanager
    async def program(self, name: str, key: ClientKey | None) -> AsyncIterator[TextClient]:
        client = TextClient(name, "token", "127.0.0.1", self.ports[0], SOON, key)
        async with client.running():
            yield client

    async def joins(self, name: str, key: ClientKey | None) -> NameRegistered | ConnectionLost:
        """Return the first that a program hears of the server: that it has its name, or why it has not."""
        async with self.program(name, key) as client:
            return await first(client)

    async def refuses(self, name: str, key: ClientKey | None) -> ConnectionLost | None:
        """Return why a program cannot join, without letting it join."""
        return await TextClient.why_refused(name, "127.0.0.1", self.ports[0], key, 20.0)

    async def watches(self, key: ClientKey | None, *, asks: bool = False) -> str:
        """Return why a window sees nothing, or is granted nothing; empty: it is."""
        client = WatchClient("127.0.0.1", self.ports[1], key, SOON)
        running = asyncio.ensure_future(client.run())
        try:
            async with asyncio.timeout(PATIENCE):
                while True:
                    for event in client.take():
                        match event:
                            case ConnectionLost(reason, detail):
                                return detail or reason.value
                            case WatchConnected() if not asks:
                                return ""
                            case WatchConnected():
                                client.send(b'{"sender":"somebody else","request":"Pause","fields":{}}\n')
                            case SessionMessage():
                                status = parse_status(event)
                                if status is not None and status.refused is not None:
                                    return status.refused.reason
                    if asks and self.session.asked:
                        return ""
                    await asyncio.sleep(0.01)
        finally:
            running.cancel()


async def first(client: TextClient) -> NameRegistered | ConnectionLost:
    """Return the next that is no message."""
    async with asyncio.timeout(PATIENCE):
        while True:
            for event in client.take():
                if isinstance(event, NameRegistered | ConnectionLost):
                    return event
            await asyncio.sleep(0.01)


async def until(condition: object) -> None:
    async with asyncio.timeout(PATIENCE):
        while not condition():  # type: ignore[operator]
            await asyncio.sleep(0.01)


@pytest.fixture
def house(tmp_path: Path) -> House:
    return House(tmp_path)


@pytest.mark.parametrize("right", Right)
def test_a_key_opens_the_doors_of_its_rights_and_no_other(house: House, right: Right) -> None:
    async def try_all() -> set[str]:
        could: set[str] = set()
        async with house.open():
            for name in NAMES:
                refused = await house.refuses(name, house.keys[right])
                answer = await house.joins(name, house.keys[right])
                assert refused == (answer if isinstance(answer, ConnectionLost) else None)
                if isinstance(answer, NameRegistered):
                    could.add(name)
                else:
                    why = f"the key {right} does not allow the name {name}; its rights: {right}"
                    assert answer == ConnectionLost(LossReason.REFUSED, why)
            seen = await house.watches(house.keys[right])
            assert seen in ("", f"the key {right} ({right}) does not allow watching")
            could |= set() if seen else {"watch"}
            if not seen:
                granted = await house.watches(house.keys[right], asks=True)
                assert granted in ("", "this key allows watching only")
                could |= set() if granted else {"ask"}
        return could

    assert asyncio.run(try_all()) == MAY[right]
    if right in (Right.INTERVENE, Right.ADMIN):
        assert [key for _, key in house.session.asked] == [right]


@pytest.mark.parametrize(
    ("key", "why"),
    [
        ("wrong", "the key is wrong"),
        ("\ud800", "a key is required"),
        ("secret of revoked", "the key revoked was revoked"),
        ("secret of late", "the key late has expired"),
    ],
)
def test_a_key_that_is_none_opens_nothing(house: House, key: str, why: str) -> None:
    house.ring.add("late", [Right.ADMIN], "secret of late", NOW)
    house.ring.add("revoked", [Right.ADMIN], "secret of revoked", None)
    house.ring.revoke("revoked")
    shown = ClientKey(key.encode(errors="replace").decode(), house.keys[Right.ADMIN].fingerprint)

    async def knock() -> None:
        async with house.open():
            if key.isascii():
                assert await house.refuses("SimR", shown) == ConnectionLost(LossReason.REFUSED, why)
                assert await house.joins("SimR", shown) == ConnectionLost(LossReason.REFUSED, why)
                assert await house.watches(shown) == why

    asyncio.run(knock())


def test_a_key_is_shown_to_the_session_alone_that_it_is_for(house: House) -> None:
    stranger = ClientKey("secret of robots", "0" * 64)

    async def knock() -> None:
        async with house.open():
            answer = await house.joins("SimR", stranger)
            assert isinstance(answer, ConnectionLost)
            assert answer.reason is LossReason.UNTRUSTED
            assert "its certificate is sha256:" in answer.detail
            assert "its certificate is sha256:" in await house.watches(stranger)

    asyncio.run(knock())


def test_whoever_loses_the_right_to_a_key_is_cut_off_and_told(house: House) -> None:
    async def play() -> None:
        async with house.open(), house.program("SimR", house.keys[Right.ROBOTS]) as simr:
            assert isinstance(await first(simr), NameRegistered)
            house.ring.revoke("robots")
            assert await first(simr) == ConnectionLost(LossReason.REFUSED, "the key robots was revoked")

    async def play_on() -> None:
        async with house.open(), house.program("Hider", house.keys[Right.HIDER]) as hider:
            assert isinstance(await first(hider), NameRegistered)
            house.now = "2026-03-03T12:00:00Z"
            assert await first(hider) == ConnectionLost(LossReason.REFUSED, "the key hider has expired")

    asyncio.run(play())
    house.router, house.text = HearingRouter(), TextServer(keys=house.verifier)
    asyncio.run(play_on())


def test_whoever_has_a_key_speaks_in_the_name_of_their_connection_alone(house: House) -> None:
    async def play() -> None:
        async with (
            house.open(),
            house.program("TabUI", house.keys[Right.PARTICIPANT]) as tabui,
            house.program("SimR", house.keys[Right.ROBOTS]) as simr,
        ):
            assert isinstance(await first(tabui), NameRegistered)
            assert isinstance(await first(simr), NameRegistered)
            tabui.send(TextMessage("%%goto", "SimR", "Game", tuple("1234")))
            tabui.send(TextMessage("%%goto", "TabUI", "Game", tuple("4321")))
            await until(lambda: len(house.router.heard) >= 1)
            assert [each.message.text for each in house.router.heard] == ["4 3 2 1"]
            tabui.send(notice("TabUI", "Game", "PlayAgain", game=1))
            tabui.send(TextMessage("%%goto", "TabUI", "Game", tuple("5555")))
            await until(lambda: len(house.router.heard) >= 2)
            assert [each.message.text for each in house.router.heard] == ["4 3 2 1", "5 5 5 5"]

    asyncio.run(play())


def test_a_participants_key_is_good_for_one_game(house: House) -> None:
    async def play() -> None:
        key = house.keys[Right.PARTICIPANT]
        async with house.open():
            async with house.program("TabUI", key) as tabui:
                assert isinstance(await first(tabui), NameRegistered)
                house.text.note_game("run/1", over=False)
                house.text.note_game("run/1", over=True)
                # Its end may be looked at, and looked at again; whoever sees the end alone has not played.
                assert isinstance(await house.joins("Anybody", key), NameRegistered)
                assert isinstance(await house.joins("Late", read_key(other)), NameRegistered)
                house.text.note_game("run/2", over=False)
                over = ConnectionLost(LossReason.REFUSED, "the key participant was for one game, which is over")
                assert await first(tabui) == over
            assert await house.joins("TabUI", key) == over
            assert isinstance(await house.joins("Late", read_key(other)), NameRegistered)
            house.text.note_game("run/1", over=False)
            assert isinstance(await house.joins("TabUI", key), NameRegistered)

    other = house.ring.add("other", [Right.PARTICIPANT, Right.ROBOTS], "secret of other", None)
    asyncio.run(play())
    assert [(entry.name, entry.game) for entry in house.ring.entries if entry.game] == [
        ("participant", "run/1"),
        ("other", "run/2"),
    ]


def test_a_key_of_some_seats_admits_to_no_other_seat(house: House) -> None:
    async def play() -> None:
        async with house.open():
            assert isinstance(await house.joins("TabUI-driver", ann), NameRegistered)
            assert isinstance(await house.joins("TabUI-scout", ann), NameRegistered)
            assert await house.refuses("TabUI-scout", ann) is None
            for other in ("TabUI-namer", "TabUI", "driver"):
                assert await house.joins(other, ann) == await house.refuses(other, ann) == refused
            assert isinstance(await house.joins("TabUI-namer", house.keys[Right.PARTICIPANT]), NameRegistered)

    refused = ConnectionLost(LossReason.REFUSED, "the key ann is not for this seat; use --seat with: driver, scout")
    seats = ["driver", "scout"]
    ann = read_key(house.ring.add("ann", [Right.PARTICIPANT], "secret of ann", None, seats))
    asyncio.run(play())


def test_a_key_for_robots_too_is_not_a_participants_where_it_is_simr(house: House) -> None:
    async def play() -> None:
        async with house.open(), house.program("SimR", read_key(both)) as simr:
            assert isinstance(await first(simr), NameRegistered)
            house.text.note_game("run/1", over=False)
            house.text.note_game("run/2", over=False)
            assert isinstance(await house.joins("TabUI", read_key(both)), NameRegistered)
            assert not [each for each in simr.take() if isinstance(each, ConnectionLost)]

    both = house.ring.add("both", [Right.PARTICIPANT, Right.ROBOTS], "secret of both", None)
    asyncio.run(play())


def test_a_revoked_key_of_a_connection_without_a_name_does_not_save_others(house: House) -> None:
    async def play() -> None:
        async with house.open(), house.program("SimR", house.keys[Right.ROBOTS]) as simr:
            assert isinstance(await first(simr), NameRegistered)
            reader, writer = await _encrypted(house.ports[0])
            writer.write(key_line("secret of hider"))
            assert await reader.readline() == b'{"admitted":"hider"}\n'
            house.ring.revoke("hider")
            assert await reader.read() == b"%%sshhuuttddoowwnn \n"
            writer.close()
            house.ring.revoke("robots")
            assert await first(simr) == ConnectionLost(LossReason.REFUSED, "the key robots was revoked")

    asyncio.run(play())


def test_a_name_is_its_holders_whoever_has_another_key_or_none(house: House) -> None:
    async def play() -> None:
        taken = ConnectionLost(LossReason.REFUSED, "")
        async with house.open(), house.program("TabUI", house.keys[Right.PARTICIPANT]) as tabui:
            assert isinstance(await first(tabui), NameRegistered)
            # The same token, by which a program takes its own name back.
            assert await house.joins("TabUI", house.keys[Right.ADMIN]) == taken
            assert await house.joins("TabUI", None) == taken
            assert await house.joins("Server", house.keys[Right.ADMIN]) == taken
            assert isinstance(await house.joins("TabUI", house.keys[Right.PARTICIPANT]), NameRegistered)

    asyncio.run(play())


def test_programs_of_other_machines_show_a_key_or_speak_as_in_2016(
    house: House, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Peers of the loopback are those of another machine here, which the text server is open to."""
    for module in (text_server, watch_server, admission):
        monkeypatch.setattr(module, "peer_of", lambda transport: "10.0.0.6")
    house.text._admission = admission.Admission.to(["10.0.0.0/24"])

    async def knock() -> None:
        async with house.open():
            why = "programs of thbridge on another machine need a key"
            assert await house.joins("TabUI", None) == ConnectionLost(LossReason.REFUSED, why)
            reader, writer = await asyncio.open_connection("127.0.0.1", house.ports[0])
            writer.write(b"%%setid TabUI\n")
            assert await reader.readline() == b"%%ack \n"
            ready = notice("TabUI", "Game", "ParticipantReady", run="x").line().encode()
            writer.write(ready + b"\n%%goto TabUI Game 1 2\n")
            await until(lambda: len(house.router.heard) > 0)
            assert [each.message.command for each in house.router.heard] == ["%%goto"]
            writer.close()
            assert isinstance(await house.joins("Anybody", house.keys[Right.PARTICIPANT]), NameRegistered)
            # There is no plain way to watch.
            reader, writer = await asyncio.open_connection("127.0.0.1", house.ports[1])
            writer.write(b'{"key":"secret of admin"}\n')
            with pytest.raises(ConnectionError):
                assert await reader.read() == b"reset"
            writer.close()
            assert await house.watches(house.keys[Right.ADMIN]) == ""

    asyncio.run(knock())


def test_those_who_show_no_key_in_tls_make_room_for_those_who_do(house: House) -> None:
    async def crowd() -> None:
        async with house.open():
            silent = [await _silent(house.ports[0]) for _ in range(70)]
            assert isinstance(await house.joins("SimR", house.keys[Right.ROBOTS]), NameRegistered)
            for writer in silent:
                writer.close()

    asyncio.run(crowd())


def test_whoever_has_left_already_is_no_program_of_this_machine() -> None:
    class Reset(asyncio.Transport):
        def get_extra_info(self, name: str, default: object = None) -> object:
            return ("10.0.0.5", 6009) if name == "sockname" else None

    assert admission.peer_of(Reset()) is not None
    assert admission.Admission.to(["10.0.0.0/24"]).refused(Reset()) is not None


async def _silent(port: int) -> asyncio.StreamWriter:
    return (await _encrypted(port))[1]


async def _encrypted(port: int) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    return await asyncio.open_connection("127.0.0.1", port, ssl=context)


def test_handshakes_that_are_left_hold_few_descriptors(house: House) -> None:
    async def crowd() -> int:
        async with house.open():
            before = len([*Path("/dev/fd").iterdir()])
            clients = [socket.create_connection(("127.0.0.1", house.ports[0])) for _ in range(500)]
            for client in clients:
                client.sendall(b"\x16\x03\x01\x02\x00\x01")
            assert isinstance(await house.joins("SimR", house.keys[Right.ROBOTS]), NameRegistered)
            held = len([*Path("/dev/fd").iterdir()]) - before - len(clients)
            for client in clients:
                client.close()
            return held

    assert asyncio.run(crowd()) <= 260

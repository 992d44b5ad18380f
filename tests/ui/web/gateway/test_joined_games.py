"""A visitor who joins a game whose server runs elsewhere: `thbridge serve --server`, with all programs as processes."""

import asyncio
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import chdir, contextmanager
from pathlib import Path

import pytest

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.commands import refusal, thbridge
from tests.support.programs.ports import free_port
from tests.support.programs.processes import Program, until
from tests.support.studies.served_games import served
from tests.support.studies.served_program import kill_workers, playing, port_for_browsers
from tests.support.studies.team_at_browsers import TEAM_TEXT, own_robots
from thbridge.app.session.session import SessionOutlets
from thbridge.credentials import Right
from thbridge.files.keys.certificate import certificate_of
from thbridge.files.keys.key_ring import KeyRing
from thbridge.recording.bag.reading.reader import messages
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.ros import names
from thbridge.ros.messages import unpack
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.keys import RingKeys
from thbridge.sockets.tls import server_context
from thbridge.study.study_file import Study
from thbridge.text_protocol.sockets.server import TextServer
from thbridge.text_protocol.wire.router import MessageRouter
from thbridge.timing.wall_clock import utc_now
from ui.web.pool.joined_game import JoinedGame
from ui.web.pool.running_games import RunningGames

STUDY = """\
map: practice
templates: practice
robots: 1
rate: 1
participant: {consent: consent.txt}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "consent.txt").write_text("We record what you do.")
    (tmp_path / "study.yaml").write_text(STUDY)
    return tmp_path


@pytest.fixture
def programs(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> Iterator[list[Program]]:
    """Programs that the test starts. They keep running games in a folder of their own."""
    running = tmp_path_factory.mktemp("t")
    monkeypatch.setenv("TMPDIR", str(running))
    started: list[Program] = []
    yield started
    for program in reversed(started):
        if program.process.poll() is None:
            program.stop()
        program.close()
    for games in running.glob("thbridge-serve-*/*"):
        kill_workers(RunningGames(games))


def begin_game(folder: Path, programs: list[Program], outside: str) -> str:
    """Start a game without these programs; return the address of its server."""
    address = f"127.0.0.1:{free_port()}"
    game = Program(
        folder, "play", "study.yaml", "--headless", "--port", address.partition(":")[2], "--bag", "run.bag",
        "--no-report", "--outside", outside,
    )  # fmt: skip
    programs.append(game)
    until("the game", lambda: address in game.text or game.process.poll() is not None, programs)
    return address


def serve(folder: Path, programs: list[Program], address: str, *options: str) -> int:
    """Serve the game at an address to browsers; return the port for browsers."""
    program = Program(folder, "serve", "study.yaml", "--server", address, "--port", "0", *options)
    programs.append(program)
    return port_for_browsers(program)


async def asked(port: int) -> BrowserClient:
    """Return the browser of a visitor who has read the rules, and whom the game asks for consent."""
    browser = await BrowserClient.arrived(port)
    await browser.press_button()
    await browser.until(lambda: browser.tree.get("consent_buttons"))
    assert browser.tree["consent"] == "We record what you do."
    await asyncio.sleep(0.4)  # The page ignores earlier acts.
    return browser


@pytest.mark.slow
def test_a_visitor_plays_in_a_game_elsewhere_and_its_replay_is_the_same(folder: Path, programs: list[Program]) -> None:
    port = serve(folder, programs, begin_game(folder, programs, "TabUI"))

    async def play() -> None:
        browser = await asked(port)
        await browser.act(browser.tree["consent_buttons"][0]["act"])
        await playing(browser)
        await asyncio.sleep(0.4)
        await browser.act(browser.tree["tiles"][1]["choose"]["act"])
        await browser.until(lambda: browser.tree["dialogue"] and browser.tree["dialogue"]["choices"])
        await asyncio.sleep(0.4)
        await browser.act(browser.tree["dialogue"]["choices"][0]["act"])
        await browser.until(lambda: not browser.tree["dialogue"])
        second = await BrowserClient.arrived(port)
        await second.press_button()
        await second.until(lambda: second.shown["heading"] == "Another person is playing at the moment")
        await second.close()
        await browser.come_back(port)
        await playing(browser)
        assert "Go to room 2." in str(browser.tree["history"])
        await browser.act({"act": "StopRobotAct", "robot": 0})
        await browser.until(lambda: browser.tree["tools"][-1]["enabled"])
        await browser.end_game()
        await browser.until(lambda: "The game is over" in browser.shown["html"])
        await browser.close()

    asyncio.run(asyncio.wait_for(play(), 40))
    game, server = programs
    assert game.process.wait(60) == 0, game.text
    events = [unpack.game_event(message.data) for message in messages(folder / "run.bag", [names.GAME_EVENTS])]
    assert ("departed", 0, 2) in {(each.kind, each.robot, each.room) for each in events}, events
    assert not (folder / "served").exists()
    assert "Traceback" not in server.text
    assert "the same, bit for bit" in thbridge(folder, "replay", "run.bag").output


@pytest.mark.slow
def test_a_visitor_takes_a_seat_and_the_page_says_when_the_game_is_lost(folder: Path, programs: list[Program]) -> None:
    (folder / "study.yaml").write_text(TEAM_TEXT)
    address = begin_game(folder, programs, "TabUI-north,TabUI-south,TabUI-judge")
    port = serve(folder, programs, address, "--seat", "north")

    async def lose() -> None:
        browser = await BrowserClient.arrived(port)
        await browser.until(lambda: "In this game, you are the north" in browser.shown["html"])
        await browser.press_button()
        await playing(browser)
        assert own_robots(browser) == [1]
        programs[0].kill()
        await browser.until(lambda: "Reconnecting" in browser.tree["banner"])
        await browser.close()

    asyncio.run(asyncio.wait_for(lose(), 40))


STUDY_ELSEWHERE = Study(map="practice", templates="practice", robots=2)


def test_after_a_game_the_next_person_and_the_same_one_play_the_next_games_or_decline(tmp_path: Path) -> None:
    async def play() -> None:
        server = TextServer()
        hunt = HuntWithoutSimulator(outside=("TabUI",), outlets=SessionOutlets(server.perform))
        where = await server.start(hunt.session.router, "127.0.0.1", 0)
        assert isinstance(where, ListeningAddress)

        async def tick() -> None:
            while True:
                hunt.run(1)
                await asyncio.sleep(0.02)

        def game() -> int:
            return 0 if hunt.session.game is None else hunt.session.game.started.game

        ticking = asyncio.create_task(tick())
        async with served(tmp_path, games=1, joined=JoinedGame.at(STUDY_ELSEWHERE, None, where)) as port:
            first, second = await BrowserClient.arrived(port), await BrowserClient.arrived(port)
            await first.press_button()
            await playing(first)
            await second.press_button()
            await second.until(lambda: second.shown["heading"] == "Another person is playing at the moment")
            await first.end_game()
            await playing(second)
            assert game() == 2
            await first.press_button()
            await first.until(lambda: first.shown["heading"] == "Another person is playing at the moment")
            await second.end_game()
            await playing(first)
            assert game() == 3
            await first.end_game()
            await first.until(lambda: first.shown.get("button") == "Play again")
            await server.stop()
            await second.press_button()
            await second.until(lambda: second.shown["heading"] == "No game is open at the moment")
            server = TextServer()
            asks = Briefing(names=("ball",), consent="We record what you do.")
            hunt = HuntWithoutSimulator(outside=("TabUI",), outlets=SessionOutlets(server.perform), briefing=asks)
            await server.start(hunt.session.router, where.host, where.port)
            await second.until(lambda: second.tree.get("consent_buttons"))
            await asyncio.sleep(0.4)  # The page ignores earlier acts.
            await second.act(second.tree["consent_buttons"][1]["act"])
            await second.until(lambda: "You do not take part" in second.shown["html"])
            await asyncio.gather(first.close(), second.close())
        ticking.cancel()
        await server.stop()

    asyncio.run(asyncio.wait_for(play(), 120))


def test_a_game_that_cannot_be_joined_is_refused_before_anything_starts(folder: Path) -> None:
    (folder / "people").mkdir()
    address = f"127.0.0.1:{free_port()}"
    with chdir(folder):
        unreached = refusal("serve", "study.yaml", "--server", address)
        assert f"--server: no game at {address}: Connection refused. Start `thbridge server` or" in unreached
        assert "study with people" in refusal("serve", "people", "--server", address)
        assert "Omit --games" in refusal("serve", "study.yaml", "--server", address, "--games", "2")
        assert "belong to --server" in refusal("serve", "study.yaml", "--seat", "north")


@contextmanager
def keyed_server(ring: KeyRing) -> Iterator[str]:
    """Run a text server in another thread, for clients with keys; yield its address."""

    async def run() -> None:
        server = TextServer(keys=RingKeys(ring, server_context(certificate_of(ring.folder, utc_now()))))
        where = await server.start(MessageRouter(), "127.0.0.1", 0)
        assert isinstance(where, ListeningAddress)
        address.set_result(f"{where.host}:{where.port}")
        await asyncio.wrap_future(ended)
        await server.stop()

    address, ended = Future[str](), Future[None]()
    with ThreadPoolExecutor(1) as threads:
        running = threads.submit(asyncio.run, run())
        try:
            yield address.result(60)
        finally:
            ended.set_result(None)
            running.result(60)


def test_a_key_that_does_not_admit_the_participant_is_refused_before_anything_starts(folder: Path) -> None:
    ring = KeyRing(folder / "keys", utc_now)
    robots, other = (ring.add(name, [Right.ROBOTS], f"secret of {name}", None) for name in ("robots", "other"))
    ring.revoke("other")
    foreign = KeyRing(folder / "foreign", utc_now).add("foreign", [Right.PARTICIPANT], "secret of foreign", None)
    with keyed_server(ring) as address, chdir(folder):
        for key, problem in (
            (robots, "does not allow the name TabUI; its rights: robots. Ask the admin"),
            (other, "the key other was revoked"),
            (foreign, "its certificate is sha256:"),
        ):
            refused = refusal("serve", "study.yaml", "--server", address, "--key", str(key))
            assert f"--key {key}: " in " ".join(refused.split())
            assert problem in " ".join(refused.split())

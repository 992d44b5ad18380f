"""Several people in browsers who play one game, each in their seat."""

import asyncio
import json
import os
import signal
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.processes import run_thbridge
from tests.support.studies.served_games import served
from tests.support.studies.served_program import ServedProgram
from tests.support.studies.team_at_browsers import (
    TEAM,
    TEAM_TEXT,
    end,
    go_on,
    playing,
    seat_of,
    seated,
    talk,
    waiting,
)
from thbridge.hunt.events import SeatLeft, SeatTaken
from thbridge.recording.journal import journal_path, read_journal
from thbridge.recording.recordings import journal_of
from ui.web.pool.running_games import RunningGames


def history(browser: BrowserClient) -> list[str]:
    """Return the lines of the history."""
    return [each["text"] for each in browser.tree["history"]]


def energy(browser: BrowserClient, robot: int) -> str:
    """Return the words about a robot's energy."""
    return str(browser.tree["cards"][robot]["energy"][1])


async def leave_page(browser: BrowserClient) -> None:
    """Press the only button of the page."""
    await browser.send({"type": "WentOn", "page": browser.shown["page"]})


def presence(folder: Path, seat: str) -> list[bool]:
    """Return when a seat was taken (True) and left (False), as the journal of the only game has it."""
    (log,) = folder.glob("*.inputs")
    events = read_journal(journal_path(journal_of(log.with_suffix(".bag")), 1)).events
    return [
        isinstance(each, SeatTaken) for each in events if isinstance(each, SeatTaken | SeatLeft) and each.seat == seat
    ]


@pytest.mark.slow
def test_a_game_starts_when_all_seats_are_filled_and_who_leaves_the_lobby_blocks_nobody(tmp_path: Path) -> None:
    async def run() -> None:
        async with served(tmp_path, TEAM, games=1) as port:
            gone, stopped = await waiting(port), await waiting(port)
            await gone.close()
            await leave_page(stopped)
            await stopped.until(lambda: stopped.shown["heading"] == "You are not waiting for the others any more")
            team = await seated(port)
            assert [*tmp_path.glob("*.bag*")]

            # The only game is taken, so the next people wait until it is over.
            await gone.come_back(port)
            await leave_page(stopped)
            late = await waiting(port)
            await late.until(lambda: late.shown["t"] == "turn" and late.shown["waited"].endswith("0:02."))
            assert gone.shown["t"] == stopped.shown["t"] == "turn"
            await end(team["south"])
            await asyncio.gather(*map(go_on, team.values()))
            await asyncio.gather(*map(playing, (gone, stopped, late)))
            assert {seat_of(each) for each in (gone, stopped, late)} == {*team}
            await asyncio.gather(*(each.close() for each in (*team.values(), gone, stopped, late)))

    asyncio.run(asyncio.wait_for(run(), 280))
    assert len([*tmp_path.glob("*.inputs")]) == 2


def test_people_come_back_to_their_seats_and_receive_nothing_of_another_seat(tmp_path: Path) -> None:
    async def run() -> None:
        async with served(tmp_path, TEAM, games=1) as port:
            team = await seated(port)
            north, south, judge = team["north"], team["south"], team["judge"]
            said = {"north": await talk(north), "south": await talk(south)}
            before = {seat: history(each) for seat, each in team.items()}

            await north.come_back(port)  # The page is loaded again.
            south.abort()  # The connection is lost, and the page connects again.
            await south.open()
            await asyncio.gather(playing(north), playing(south))
            assert {seat: seat_of(each) for seat, each in team.items()} == {seat: seat for seat in team}
            assert history(north) == before["north"]
            assert history(south) == before["south"]

            # The others see that a seat is empty, and the person finds it again.
            await judge.close()
            async with asyncio.timeout(60):
                while presence(tmp_path, "judge") != [True, False]:
                    await asyncio.sleep(0.2)
            await judge.come_back(port)
            await playing(judge)
            async with asyncio.timeout(60):
                while presence(tmp_path, "judge") != [True, False, True]:
                    await asyncio.sleep(0.2)

            # An agreed move costs energy, which the pages of north and south show.
            await asyncio.sleep(0.4)
            await south.act(south.tree["dialogue"]["choices"][0]["act"])
            await south.until(lambda: energy(south, 1) != energy(south, 0))
            await north.until(lambda: energy(north, 1) == energy(south, 1))
            spent = energy(north, 1)
            await end(north)
            await asyncio.gather(*map(go_on, team.values()))
            await asyncio.gather(*(each.close() for each in team.values()))

            received = {seat: "\n".join(each.texts) for seat, each in team.items()}
            for seat, sentence in said.items():
                words = json.dumps(sentence)[1:-1]
                assert [other for other, text in received.items() if words in text] == [seat]
            assert spent in received["north"]
            assert spent not in received["judge"]
            kinds = {seat: {json.loads(text)["t"] for text in each.texts} for seat, each in team.items()}
            assert "floor" in kinds["north"]
            assert "floor" not in kinds["judge"]
            assert not any('"robots":[{' in text for text in judge.texts)

    asyncio.run(asyncio.wait_for(run(), 280))


@pytest.mark.slow
def test_a_killed_worker_brings_each_person_back_to_their_seat(tmp_path: Path) -> None:
    running = RunningGames.of(tmp_path)

    async def run() -> None:
        async with served(tmp_path, TEAM, running, games=1) as port:
            team = await seated(port)
            said = await talk(team["north"])
            before = {seat: history(each) for seat, each in team.items()}
            (key,) = running
            worker = running.address(key)
            assert worker is not None
            children = Path(f"/proc/{worker.process}/task/{worker.process}/children")
            for kills_copies in (False, True):
                await team["north"].until(lambda path=children: path.read_text())
                whole = [(each, each.whole_pages) for each in team.values()]
                copies = [*map(int, children.read_text().split())] if kills_copies else []
                for process in (*copies, worker.process):
                    os.kill(process, signal.SIGKILL)
                for each, pages in whole:
                    await each.until(lambda each=each, pages=pages: each.whole_pages > pages)
                    await playing(each)
                for seat, each in team.items():
                    assert seat_of(each) == seat
                    assert history(each) == before[seat]
                await team["north"].until(lambda: team["north"].tree["dialogue"])
                assert team["north"].tree["dialogue"]["sentences"][-1]["text"] == said
                woken = running.address(key)
                assert woken is not None
                assert (woken.token == worker.token) is not kills_copies
                worker = woken
                children = Path(f"/proc/{worker.process}/task/{worker.process}/children")
            await end(team["judge"])
            await asyncio.gather(*map(go_on, team.values()))
            await asyncio.gather(*(each.close() for each in team.values()))
            assert not [*running.folder.glob("*.history")]
            assert not [*running.folder.glob("*.group")]

    asyncio.run(asyncio.wait_for(run(), 280))
    (bag,) = tmp_path.glob("*.bag")
    assert read_journal(journal_path(journal_of(bag), 1)).state.ended is not None
    assert run_thbridge(tmp_path, "replay", str(bag)).returncode == 0


@pytest.mark.slow
def test_a_killed_server_brings_each_person_back_to_their_seat(tmp_path: Path) -> None:
    study, bags = tmp_path / "team.yaml", tmp_path / "bags"
    study.write_text(f"{TEAM_TEXT}recording: {{format: mcap}}\n")

    async def run(server: ServedProgram) -> None:
        team = await seated(server.port)
        said = await talk(team["south"])
        alone = await waiting(server.port)
        workers = server.workers
        os.kill(server.child, signal.SIGKILL)
        await asyncio.gather(*(each.come_back(server.port) for each in team.values()))
        await asyncio.gather(*map(playing, team.values()))
        assert {seat: seat_of(each) for seat, each in team.items()} == {seat: seat for seat in team}
        assert team["south"].tree["dialogue"]["sentences"][-1]["text"] == said
        assert server.workers == workers
        await team["north"].close()
        await end(team["judge"])
        # A person who comes back only after the end of the game learns it, too.
        await asyncio.gather(go_on(team["judge"]), go_on(team["south"]))
        await team["north"].come_back(server.port)
        await go_on(team["north"])
        await team["north"].until(lambda: not server.workers)
        await asyncio.gather(*(each.close() for each in (*team.values(), alone)))

    with ServedProgram(study, "--games", "1", "--bags", str(bags), recorded=bags) as server:
        asyncio.run(asyncio.wait_for(run(server), 280))
    (mcap,) = bags.glob("*.mcap")
    assert run_thbridge(tmp_path, "replay", str(mcap)).returncode == 0

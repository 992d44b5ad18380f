"""Programs that hold seats of games in workers."""

import asyncio
import os
import signal
from dataclasses import replace
from pathlib import Path

import pytest

from tests.support.programs.processes import run_thbridge
from tests.support.studies.seats_in_a_worker import KEY, BrowserAtWorker, at_worker
from tests.support.studies.team_at_browsers import TEAM, TEAM_TEXT, own_robots, playing
from thbridge.hunt.events import ConsentGiven, JournalEntry, PersonSaid, RobotDeparted, SeatLeft, SeatTaken
from thbridge.hunt.seats import PlayedBy
from thbridge.recording.journal import journal_path, read_journal
from thbridge.recording.recordings import journal_of
from thbridge.study.study_file import ParticipantSection, Study
from ui.web.pool.running_games import RunningGames
from ui.web.pool.single_game import SingleGame

PEOPLE = {"north": "", "judge": ""}
STUDY = replace(TEAM, map="arena8", templates=Study().templates)
"""Game that lasts longer than the tests."""
_HOLDERS = {PlayedBy.PERSON: "+", PlayedBy.PROGRAM: "*"}


@pytest.fixture
def games(tmp_path: Path) -> RunningGames:
    return RunningGames(tmp_path / "running")


@pytest.fixture
def request_(tmp_path: Path) -> SingleGame:
    """Return a game in which a program has the seat of the south from the start."""
    return SingleGame(STUDY, None, tmp_path / "team.bag", False, PEOPLE, 600.0, programs=frozenset({"south"}))


def entries(request: SingleGame) -> tuple[JournalEntry, ...]:
    """Return the entries of the journal so far."""
    assert request.bag is not None
    path = journal_path(journal_of(request.bag), 1)
    return read_journal(path).events if path.exists() and path.stat().st_size else ()


def presence(request: SingleGame, seat: str) -> str:
    """Return when a person (+) or a program (*) took a seat, and when it was left (-)."""
    about = (each for each in entries(request) if isinstance(each, SeatTaken | SeatLeft) and each.seat == seat)
    return "".join(_HOLDERS[each.by] if isinstance(each, SeatTaken) else "-" for each in about)


def departures(request: SingleGame) -> set[str]:
    """Return the seats that have sent a robot."""
    return {each.seat for each in entries(request) if isinstance(each, RobotDeparted)}


def said(request: SingleGame) -> list[str]:
    """Return the texts that people have sent to each other."""
    return [each.text for each in entries(request) if isinstance(each, PersonSaid)]


def leave(*people: BrowserAtWorker) -> None:
    """Let these people, who are all people of the game, leave. Then the game ends, because programs keep none open."""
    for each in people:
        each.game.leave()


def check_replay(request: SingleGame) -> None:
    """Check that the replay of the recording is equal."""
    assert request.bag is not None
    replayed = run_thbridge(request.bag.parent, "replay", str(request.bag))
    assert replayed.returncode == 0, replayed.stdout + replayed.stderr


def test_programs_hold_seats_from_the_start_and_while_a_person_is_away(
    games: RunningGames, request_: SingleGame
) -> None:
    async def run() -> None:
        async with at_worker(games, request_, [*PEOPLE]) as people:
            north, judge = people["north"], people["judge"]
            north.open_page()
            judge.open_page()
            await asyncio.gather(playing(north), playing(judge))
            history = [each["text"] for each in judge.tree["history"]]
            await north.until(lambda: departures(request_) == {"south"})
            assert presence(request_, "south") == "*"

            north.game.fill("judge")
            north.game.fill("judge")
            await north.until(lambda: presence(request_, "judge") == "+-*")
            # The browser may connect again meanwhile, and does nothing.
            judge.open_page()
            await judge.act({"act": "SayToPeopleAct", "to": "", "text": "I am back."})
            assert not judge.tree

            judge.game.resume("judge")
            await playing(judge)
            await judge.act({"act": "SayToPeopleAct", "to": "", "text": "Hello."})
            await north.until(lambda: said(request_))
            assert said(request_) == ["Hello."]
            assert presence(request_, "judge") == "+-*-+"
            assert not own_robots(judge)
            assert [each["text"] for each in judge.tree["history"]][: len(history)] == history
            leave(north, judge)

    asyncio.run(asyncio.wait_for(run(), 200))
    check_replay(request_)


def test_a_program_takes_a_seat_before_the_game_begins(games: RunningGames, request_: SingleGame) -> None:
    async def run() -> None:
        async with at_worker(games, request_, [*PEOPLE]) as people:
            judge = people["judge"]
            judge.game.fill("north")  # The game has not begun yet.
            judge.open_page()
            await playing(judge)
            await judge.until(lambda: departures(request_) == {"north", "south"})
            leave(judge)

    asyncio.run(asyncio.wait_for(run(), 200))


def test_a_game_waits_for_no_consent_of_programs_and_empty_seats(games: RunningGames, tmp_path: Path) -> None:
    (tmp_path / "consent.txt").write_text("We record what you do.")
    (tmp_path / "team.yaml").write_text(TEAM_TEXT)
    study = replace(STUDY, participant=ParticipantSection(consent=Path("consent.txt")))
    people, programs = {"north": "2026-10-01T10:00:00Z"}, frozenset({"south"})
    request = SingleGame(study, tmp_path / "team.yaml", tmp_path / "team.bag", False, people, 600.0, programs=programs)

    async def run() -> None:
        async with at_worker(games, request, [*people]) as browsers:
            north = browsers["north"]
            north.open_page()
            await playing(north)
            await north.until(lambda: departures(request) == {"south"})
            leave(north)

    asyncio.run(asyncio.wait_for(run(), 200))
    assert {each.seat for each in entries(request) if isinstance(each, ConsentGiven)} == {"north", "south"}
    assert presence(request, "judge") == ""


@pytest.mark.slow
@pytest.mark.parametrize("kills_copies", [False, True])
def test_after_a_kill_the_gateway_lets_the_program_have_the_seat_again(
    games: RunningGames, request_: SingleGame, kills_copies: bool
) -> None:
    async def run() -> None:
        async with at_worker(games, request_, [*PEOPLE]) as people:
            north, judge = people["north"], people["judge"]
            north.open_page()
            judge.open_page()
            await asyncio.gather(playing(north), playing(judge))
            worker = games.address(KEY)
            assert worker is not None
            children = Path(f"/proc/{worker.process}/task/{worker.process}/children")
            await judge.until(children.read_text)
            judge.game.fill("north")
            await judge.until(lambda: presence(request_, "north") == "+-*")
            copies = [*map(int, children.read_text().split())] if kills_copies else []
            for process in (*copies, worker.process):
                os.kill(process, signal.SIGKILL)
        async with at_worker(games, request_, [*PEOPLE]) as people:
            north, judge = people["north"], people["judge"]
            north.game.fill("north")
            north.open_page()
            judge.open_page()
            await playing(judge)
            await judge.until(lambda: {"north", "south"} <= departures(request_))
            await judge.until(lambda: presence(request_, "north")[3:].endswith("*"))
            assert not north.tree
            judge.game.resume("north")
            await playing(north)
            leave(north, judge)

    asyncio.run(asyncio.wait_for(run(), 280))
    check_replay(request_)

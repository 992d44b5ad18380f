"""Games of groups in a served study: people wait, play, leave, come back, and lose nothing in crashes."""

import asyncio
import hashlib
import os
import signal
from collections.abc import Awaitable, Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from tests.support.programs.browser_person import BrowserPerson, Manner
from tests.support.programs.processes import run_thbridge
from tests.support.studies.served_program import ServedProgram
from tests.support.studies.served_study import served
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.groups import GroupGame
from thbridge.experiment.lobby import SeatHolder
from thbridge.experiment.progress import Progress
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.store.events import EventKind, LogEntry, LoggedEvent, RunState
from ui.web.pool.running_games import RunningGames

STUDY = """\
title: Two in browsers
seed: 3
base:
  map: practice
  templates: practice
  robots: 2
  rate: 10
  server: {port: 0}
  seats:
    - {name: north, label: the north, robots: [1]}
    - {name: south, label: the south, robots: [2]}
  team: {agreement: {end: one}}
quota: 8
consent_elsewhere: People agreed before.
presence: {grace: 10, page_grace: 600, then: end}
lobby: {wait: 300, leaving: end}
recruiting: {endings: {complete: ALL-DONE, no_group: NO-GROUP, timed_out: AWAY, ended_early: EARLY}}
steps:
  - {step: trial, name: game, max_seconds: 3000}
  - {step: form, form: after.yaml, name: after}
"""
AFTER = """\
title: After the game
items:
  - {id: again, text: Would you play again?, scale: choice, options: ['yes', 'no', maybe]}
"""
ENDS = Manner(SimulatedPeople(drop_out=0.0), acts=-1)
"""A person who ends each game at once."""
WATCHES = replace(ENDS, ends=False)
"""A person who does nothing in a game."""
SEATS = ("north", "south")


@pytest.fixture
def folder(tmp_path: Path) -> ExperimentFolder:
    (tmp_path / "study").mkdir()
    (tmp_path / "study" / "after.yaml").write_text(AFTER)
    return change(ExperimentFolder(tmp_path / "study"), {})


def change(folder: ExperimentFolder, changes: Mapping[str, str]) -> ExperimentFolder:
    """Write the study with changes of its text."""
    text = STUDY
    for before, after in changes.items():
        assert before in text
        text = text.replace(before, after)
    folder.file.write_text(text)
    return folder


def person(folder: ExperimentFolder, port: int, manner: Manner = ENDS, seed: int = 1) -> BrowserPerson:
    return BrowserPerson(port, folder.read(), manner, seed)


async def plays(one: BrowserPerson) -> None:
    """Go on until the page of the game is complete."""
    async with asyncio.timeout(120):
        await one.go_on(lambda: one.plays)


async def waits(one: BrowserPerson) -> None:
    """Go on until the person waits for others."""
    async with asyncio.timeout(60):
        await one.go_on(lambda: one.shown == "turn")


async def seated(
    folder: ExperimentFolder, port: int, manners: Sequence[Manner] = (ENDS, ENDS)
) -> dict[str, BrowserPerson]:
    """Return people who play; the people get their seats in the order of their arrival."""
    people = [person(folder, port, manner, seed) for seed, manner in enumerate(manners)]
    for one in people[:-1]:
        await one.reload()
        await waits(one)
    await people[-1].reload()
    await asyncio.gather(*map(plays, people))
    team = {seat_of(one): one for one in people}
    assert [*team] == [*SEATS]
    return team


def seat_of(one: BrowserPerson) -> str:
    """Return the seat that the page shows as the person's own."""
    return str(one.browser.tree["people"]["people"][0]["seat"])


def history(one: BrowserPerson) -> list[str]:
    """Return the lines of the history."""
    return [each["text"] for each in one.browser.tree["history"]]


async def sees_mate(one: BrowserPerson, *, present: bool) -> None:
    """Wait until the page shows that the other person is present or absent."""
    await one.browser.until(lambda: one.browser.tree["people"]["people"][1]["present"] is present)


async def finish(team: Mapping[str, BrowserPerson]) -> None:
    """Let all people go on to the end."""
    async with asyncio.timeout(120):
        await asyncio.gather(*(one.go_on() for one in team.values()))


def scenario(
    folder: ExperimentFolder,
    play: Callable[[int, Conductor], Awaitable[None]],
    running: RunningGames | None = None,
) -> Progress:
    """Serve the study, run a function, and return the progress of the study."""

    async def run() -> None:
        async with served(folder.root, running) as (port, conductor):
            await play(port, conductor)

    asyncio.run(asyncio.wait_for(run(), 280))
    return progress_of(folder)


def progress_of(folder: ExperimentFolder) -> Progress:
    return Progress(folder.read()).after(folder.entries())


def events(entries: Iterable[LogEntry], *kinds: EventKind) -> list[LoggedEvent]:
    """Return the events of these kinds in a log."""
    return [each for each in entries if isinstance(each, LoggedEvent) and each.event.kind in kinds]


def seat_events(entries: Iterable[LogEntry]) -> list[tuple[str, object]]:
    """Return the kinds and the seats of all changes of seats."""
    changes = events(entries, EventKind.SEAT_LEFT, EventKind.SEAT_FILLED, EventKind.SEAT_RESUMED)
    return [(each.event.kind, (each.event.data or {})["seat"]) for each in changes]


def only_game(folder: ExperimentFolder, progress: Progress, *people: BrowserPerson) -> GroupGame:
    """Check that there is one game, recorded once and logged once for each of these people; return it."""
    (game,) = progress.groups.values()
    played = events(folder.entries(), EventKind.GAME_PLAYED)
    runs = {run.code: run for run in progress.runs.values() if run.code}
    assert sorted(each.event.participant for each in played) == sorted(runs[one.code].participant for one in people)
    assert game.played is not None
    bag = folder.bag_named(game.played["bag"])
    assert hashlib.sha256(bag.read_bytes()).hexdigest() == game.played["sha256"]
    assert [*folder.recordings.rglob("*.bag")] == [bag]
    for each in played:
        data = each.event.data or {}
        assert (data["bag"], data["group"]) == (game.played["bag"], game.group)
        assert game.people[str(data["seat"])] == each.event.participant
    return game


def test_a_group_plays_together_and_each_person_has_their_own_way_through_the_study(folder: ExperimentFolder) -> None:
    team: dict[str, BrowserPerson] = {}

    async def play(port: int, _: Conductor) -> None:
        said = [f"I am {seat}." for seat in SEATS]
        team.update(await seated(folder, port, [replace(WATCHES, says=text) for text in said]))
        async with asyncio.timeout(60):
            await asyncio.gather(*(one.go_on(lambda one=one: one.heard == {*said}) for one in team.values()))
        team["north"].manner = ENDS
        await finish(team)

    progress = scenario(folder, play)
    only_game(folder, progress, *team.values())
    for seat, one in team.items():
        (run,) = (each for each in progress.runs.values() if each.code == one.code)
        assert run.state is RunState.COMPLETE
        assert [taken.seat for taken in run.seats.values()] == [seat]
        assert [run.answers["after.again"]] == [each["again"] for each in one.given.values()]
        assert one.ending == "ALL-DONE"


@pytest.mark.slow
def test_people_who_reload_are_back_in_the_lobby_and_in_their_seats(folder: ExperimentFolder) -> None:
    async def play(port: int, conductor: Conductor) -> None:
        first, second = person(folder, port), person(folder, port)
        await first.reload()
        await waits(first)
        await first.reload()
        await waits(first)
        assert not conductor.progress.groups
        await second.reload()
        await asyncio.gather(plays(first), plays(second))
        seats = [seat_of(one) for one in (first, second)]
        assert sorted(seats) == [*SEATS]
        before = [history(one) for one in (first, second)]
        await first.reload()
        await second.lose_connection()
        await asyncio.gather(plays(first), plays(second))
        assert [seat_of(one) for one in (first, second)] == seats
        assert [history(one)[: len(lines)] for one, lines in zip((first, second), before, strict=True)] == before
        await finish({"first": first, "second": second})

    progress = scenario(folder, play)
    assert [run.state for run in progress.runs.values()] == [RunState.COMPLETE] * 2
    assert seat_events(folder.entries()) == []


@pytest.mark.slow
def test_a_person_who_left_the_lobby_does_not_block_the_others(folder: ExperimentFolder) -> None:
    async def play(port: int, _: Conductor) -> None:
        gone = person(folder, port)
        await gone.reload()
        await waits(gone)
        await gone.lose_connection()
        team = await seated(folder, port)
        await finish(team)

    progress = scenario(folder, play)
    (game,) = progress.groups.values()
    assert sorted(run.state for run in progress.runs.values()) == sorted(
        [RunState.UNDER_WAY, RunState.COMPLETE, RunState.COMPLETE]
    )
    assert {progress.runs[each].state for each in game.people.values()} == {RunState.COMPLETE}


LEAVING = {
    "end": [(EventKind.SEAT_LEFT, "north")],
    "empty": [(EventKind.SEAT_LEFT, "north")],
    "program": [(EventKind.SEAT_LEFT, "north"), (EventKind.SEAT_FILLED, "north")],
}
"""Changes of seats if the north leaves, for each rule."""


@pytest.mark.slow
@pytest.mark.parametrize("rule", LEAVING)
@pytest.mark.parametrize("stops", [True, False])
def test_the_others_go_on_if_a_person_leaves_the_game(folder: ExperimentFolder, rule: str, stops: bool) -> None:
    change(folder, {"leaving: end": f"leaving: {rule}"})
    team: dict[str, BrowserPerson] = {}

    async def play(port: int, conductor: Conductor) -> None:
        # With the rule `end`, nothing else ends the game.
        team.update(await seated(folder, port, (WATCHES, WATCHES if rule == "end" else ENDS)))
        north, south = team.values()
        if stops:
            await north.stop()
            await north.go_on()
        else:
            await north.lose_connection()
            (game,) = conductor.progress.groups.values()
            await south.browser.until(lambda: conductor.progress.runs[game.people["north"]].state is RunState.LEFT)
        await south.browser.until(lambda: len(seat_events(conductor.entries)) == len(LEAVING[rule]))
        if rule == "empty":
            await sees_mate(south, present=False)
        if rule == "program":
            await sees_mate(south, present=True)
        await finish({"south": south})
        if not stops:
            await north.reload()
            await north.go_on()

    progress = scenario(folder, play)
    north, south = team.values()
    game = only_game(folder, progress, south)
    assert seat_events(folder.entries()) == LEAVING[rule]
    assert game.seats["south"] is SeatHolder.PERSON
    assert progress.runs[game.people["north"]].state is RunState.LEFT
    assert north.ending == ("EARLY" if stops else "AWAY")
    # The others are paid, but an incomplete game does not count.
    run = progress.runs[game.people["south"]]
    assert (run.state, run.code, south.ending) == (RunState.EXCLUDED, south.code, "ALL-DONE")
    assert "seat of game" in run.reason


@pytest.mark.slow
def test_a_person_may_leave_a_practice_game_of_the_group(folder: ExperimentFolder) -> None:
    change(folder, {"steps:\n": "steps:\n  - {step: practice, name: try, max_seconds: 3000}\n"})
    team: dict[str, BrowserPerson] = {}

    async def play(port: int, _conductor: Conductor) -> None:
        team.update(await seated(folder, port, (WATCHES, WATCHES)))
        await team["north"].stop()
        await finish(team)

    progress = scenario(folder, play)
    north, south = progress.runs.values()
    assert (north.state, team["north"].ending) == (RunState.LEFT, "EARLY")
    assert (south.state, team["south"].ending) == (RunState.EXCLUDED, "ALL-DONE")
    assert "could not be played" in south.reason


@pytest.mark.slow
def test_an_absent_person_finds_the_seat_again(folder: ExperimentFolder) -> None:
    change(folder, {"leaving: end": "leaving: program", "then: end": "then: wait"})
    team: dict[str, BrowserPerson] = {}

    async def play(port: int, conductor: Conductor) -> None:
        team.update(await seated(folder, port))
        north, south = team.values()
        await south.lose_connection()
        await north.browser.until(lambda: len(seat_events(conductor.entries)) == 2)
        await sees_mate(north, present=True)
        await south.reload()
        await plays(south)
        assert seat_of(south) == "south"
        await south.browser.until(lambda: len(seat_events(conductor.entries)) == 3)
        await finish(team)

    progress = scenario(folder, play)
    game = only_game(folder, progress, *team.values())
    kinds = (EventKind.SEAT_LEFT, EventKind.SEAT_FILLED, EventKind.SEAT_RESUMED)
    assert seat_events(folder.entries()) == [(kind, "south") for kind in kinds]
    assert {*game.seats.values()} == {SeatHolder.PERSON}
    assert game.incomplete


@pytest.mark.slow
def test_a_person_whose_group_cannot_be_completed_gets_an_ending_with_a_code(folder: ExperimentFolder) -> None:
    change(folder, {"wait: 300": "wait: 5"})
    people: list[BrowserPerson] = []

    async def play(port: int, _: Conductor) -> None:
        people.append(person(folder, port))
        async with asyncio.timeout(60):
            await people[0].go_through()

    progress = scenario(folder, play)
    (run,) = progress.runs.values()
    assert run.unmatched
    assert (people[0].ending, people[0].code) == ("NO-GROUP", run.code)
    assert run.code
    assert not progress.groups


@pytest.mark.slow
@pytest.mark.parametrize(("rule", "holder"), [("fewer, least: 1", SeatHolder.EMPTY), ("program", SeatHolder.PROGRAM)])
def test_a_game_starts_with_fewer_people_if_the_rule_allows_it(
    folder: ExperimentFolder, rule: str, holder: SeatHolder
) -> None:
    change(folder, {"wait: 300": f"wait: 5, then: {rule}"})
    people: list[BrowserPerson] = []

    async def play(port: int, _: Conductor) -> None:
        people.append(person(folder, port))
        async with asyncio.timeout(120):
            await people[0].go_through()

    progress = scenario(folder, play)
    game = only_game(folder, progress, people[0])
    assert game.began == {"north": SeatHolder.PERSON, "south": holder}


@pytest.mark.slow
def test_a_killed_worker_resumes_the_game_of_a_group(folder: ExperimentFolder) -> None:
    running = RunningGames.of(folder.root)
    team: dict[str, BrowserPerson] = {}

    async def play(port: int, _: Conductor) -> None:
        team.update(await seated(folder, port))
        (key,) = running
        for kills_copies in (False, True):
            worker = running.address(key)
            assert worker is not None
            children = Path(f"/proc/{worker.process}/task/{worker.process}/children")
            await team["north"].browser.until(lambda path=children: path.read_text())
            copies = [*map(int, children.read_text().split())] if kills_copies else []
            pages = {seat: one.browser.whole_pages for seat, one in team.items()}
            for process in (*copies, worker.process):
                os.kill(process, signal.SIGKILL)
            for seat, one in team.items():
                await one.browser.until(lambda one=one, before=pages[seat]: one.browser.whole_pages > before)
                await plays(one)
                assert seat_of(one) == seat
        await finish(team)

    progress = scenario(folder, play, running)
    game = only_game(folder, progress, *team.values())
    assert game.played is not None
    assert run_thbridge(folder.root, "replay", str(folder.bag_named(game.played["bag"]))).returncode == 0


@pytest.mark.slow
def test_a_killed_server_brings_all_people_back_to_their_game(folder: ExperimentFolder) -> None:
    team: dict[str, BrowserPerson] = {}

    async def run(server: ServedProgram) -> None:
        team.update(await seated(folder, server.port))
        waiting = person(folder, server.port)
        await waiting.reload()
        await waits(waiting)
        workers = server.workers
        os.kill(server.child, signal.SIGKILL)
        await asyncio.gather(*(one.reload() for one in (*team.values(), waiting)))
        await asyncio.gather(*map(plays, team.values()), waits(waiting))
        assert {seat: seat_of(one) for seat, one in team.items()} == {seat: seat for seat in SEATS}
        assert server.workers == workers
        await finish(team)
        await waiting.lose_connection()

    with ServedProgram(folder.root, "--games", "2") as server:
        asyncio.run(asyncio.wait_for(run(server), 280))
    only_game(folder, progress_of(folder), *team.values())
    assert seat_events(folder.entries()) == []


@pytest.mark.slow
def test_a_server_that_is_killed_after_the_end_of_a_game_logs_it_once_for_each_person(folder: ExperimentFolder) -> None:
    change(folder, {"max_seconds: 3000": "max_seconds: 150"})
    team: dict[str, BrowserPerson] = {}

    async def run(server: ServedProgram) -> None:
        team.update(await seated(folder, server.port))
        north, south = team.values()
        (key,) = server.workers
        child = server.child
        server.program.kill()
        os.kill(child, signal.SIGKILL)
        await asyncio.gather(north.lose_connection(), south.lose_connection())
        await north.browser.until(lambda: server.running.result(key) is not None, 120)
        server.again()
        north.browser.port = south.browser.port = server.port
        await north.reload()
        await north.browser.until(lambda: events(folder.entries(), EventKind.GAME_PLAYED))
        os.kill(server.child, signal.SIGKILL)
        await asyncio.gather(north.reload(), south.reload())
        await finish(team)

    with ServedProgram(folder.root, "--games", "2") as server:
        asyncio.run(asyncio.wait_for(run(server), 280))
    progress = progress_of(folder)
    only_game(folder, progress, *team.values())
    assert [each.state for each in progress.runs.values()] == [RunState.COMPLETE] * 2

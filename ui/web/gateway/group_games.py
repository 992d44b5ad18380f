"""Games of groups in a served study: people wait for each other, play together, leave, and come back."""

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import cast

import msgspec

from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.lobby import LeavingRule, WaitRule
from thbridge.experiment.design.plan import PlannedStep, seats_of_game
from thbridge.experiment.design.presence import AbsenceRule
from thbridge.experiment.design.steps import ResumeRule, StepKind
from thbridge.experiment.groups import GroupGame
from thbridge.experiment.lobby import SeatHolder, WaitEnded
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import EventKind, JsonValue, RunState
from thbridge.experiment.waiting_room import WaitingRoom
from thbridge.files.errors import BadFile
from ui.hosting.kiosk import words
from ui.hosting.kiosk.pages import KioskPages, StepOver
from ui.model.kiosk import GamePrepared, TextToRead
from ui.web.gateway.game_queue import GameQueue
from ui.web.gateway.lobby import ServedLobby, WaitEnd, await_place
from ui.web.gateway.matching import MatchedGame, Matches
from ui.web.gateway.waiting import await_turn, pause
from ui.web.pool.messages import FromWorker, GamePassed, WorkerResult
from ui.web.pool.pool import MOST_DEATHS, DeathCount, HostedGame, WorkerDied, WorkerPool
from ui.web.pool.study_game import StudyGame, seats_at_windows

LOOK = 0.5
"""Seconds between two looks at the people of a game."""


def group_key(game: GroupGame) -> str:
    """Return the key of a group's game in the pool of workers. Each step of a group has at most one game."""
    return f"{game.group}-{game.step}-1"


class GroupGames:
    """Games of the groups of a served study, and the lobby of their people.

    Args:
        folder: folder of the study.
        design: design of the study.
        conductor: conductor of the study.
        pool: pool of workers.
        queue: queue of people who wait for a game.
        absence_of: function that returns for how many seconds a person has been absent.
        report: function that receives sentences about problems, for the researcher.
    """

    def __init__(
        self,
        folder: Path,
        design: ExperimentDesign,
        conductor: Conductor,
        pool: WorkerPool,
        queue: GameQueue,
        absence_of: Callable[[str], float],
        report: Callable[[str], None],
    ) -> None:
        self._folder = folder
        self._design = design
        self._conductor = conductor
        self._pool = pool
        self._queue = queue
        self._absence_of = absence_of
        self._report = report
        self._steps: dict[str, PlannedStep] = {}
        matching = _StudyMatching(WaitingRoom(design, conductor), self._steps)
        self._lobby = ServedLobby(matching, self._begin, lambda: queue.spare)
        self._runners: dict[str, GroupRunner] = {}

    @property
    def waited(self) -> Mapping[str, float]:
        """Seconds for which each person in the lobby has waited, by their ids."""
        return self._lobby.seconds

    def has(self, run: Run, step: PlannedStep) -> bool:
        """Return True if the game of a step is for a group."""
        return bool(seats_of_game(self._design, run.place, step))

    @asynccontextmanager
    async def opened(self) -> AsyncIterator[None]:
        """Continue games of an earlier server inside this context."""
        games, running = self._pool.games, [*self._conductor.progress.groups.values()]
        for game in running:
            key = group_key(game)
            if game.played is not None:
                games.forget(key)
            elif games.is_running(key) or games.result(key) is not None:
                self._run(game, comes_back=True)
        try:
            yield
        finally:
            for runner in self._runners.values():
                runner.stop()
            await asyncio.gather(*(runner.task for runner in self._runners.values()), return_exceptions=True)

    async def join(self, pages: KioskPages, step: PlannedStep, is_here: Callable[[], bool]) -> "GroupRunner":
        """Let a person wait until their group is complete, if they have no group yet; return the group's game.

        Args:
            pages: pages of the person.
            step: step of the game.
            is_here: function that returns True while the person's window is connected.

        Raises:
            RunOver: the person's run has ended meanwhile.
            StepOver: the game was skipped, or has ended without the person.
        """
        person = pages.person
        game = self._conductor.progress.group_game(person, step)
        if game is None:
            await self._await_group(pages, step, is_here)
            game = self._conductor.progress.groups[pages.run.seats[step.number].group, step.number]
        if game.played is not None:
            await self.pass_over(pages, step)
        return self._runners.get(group_key(game)) or self._run(game, comes_back=True)

    async def pass_over(self, pages: KioskPages, step: PlannedStep) -> None:
        """End the step of a person whose game has ended without them, or did not take place, and inform them.

        Raises:
            StepOver: always.
        """
        game = self._conductor.progress.group_game(pages.person, step)
        was_here = game is not None and pages.person in game.present
        self._conductor.end_wait(pages.person, step, WaitEnded(pages.person, 0.0, is_skipped=True))
        await pages.read(TextToRead(0, *words.headed(pages.texts, "group_left" if was_here else "game_without_you")))
        raise StepOver

    async def _await_group(self, pages: KioskPages, step: PlannedStep, is_here: Callable[[], bool]) -> None:
        """Let a person wait until their group is complete; see `join`."""
        person, texts, heading, text = (
            pages.person,
            pages.texts,
            *words.headed(pages.texts, "waiting_for_others", "web"),
        )
        lobby = self._design.file.lobby
        most = texts.text("web.wait_at_most", count=max(round(lobby.wait / 60.0), 1))
        then = texts.text("web.wait_then_end" if lobby.then is WaitRule.PAY else "web.wait_then_fewer")
        self._steps[person] = step

        async def show(has_come: Callable[[], bool]) -> bool:
            return await await_turn(pages, (heading, f"{text}\n\n{most} {then}"), has_come)

        def waits() -> bool:
            return is_here() and pages.run.state is RunState.UNDER_WAY

        while True:
            end, _ = await await_place(self._lobby, person, waits, show, lambda: self._queue.is_closed)
            match end:
                case WaitEnd.PLACED:
                    seat = words.seat_label(self._design, pages.run, step)
                    await pages.show(GamePrepared(0, texts.text("web.others_found", seat=seat)))
                    return
                case WaitEnd.CLOSED:
                    await pause(pages.window, texts)
                case WaitEnd.UNMATCHED:
                    pages.check()
                    await pages.read(TextToRead(0, *words.headed(texts, "group_left")))
                    raise StepOver
                case WaitEnd.STOPPED:
                    stopped, what = words.headed(texts, "game_not_awaited", "web")
                    await pages.read(TextToRead(0, stopped, what, button=texts.text("web.wait_again")))

    def _begin(self, matched: MatchedGame) -> None:
        """Start the game of a group that is complete."""
        self._pool.reserve(matched.key)
        self._run(next(game for game in self._conductor.progress.groups.values() if group_key(game) == matched.key))

    def _run(self, game: GroupGame, *, comes_back: bool = False) -> "GroupRunner":
        runner = GroupRunner(
            self._folder, self._design, self._conductor, self._pool, game, self._absence_of, comes_back=comes_back
        )
        self._runners[runner.key] = runner
        runner.task.add_done_callback(lambda _: self._ended(runner))
        return runner

    def _ended(self, runner: "GroupRunner") -> None:
        del self._runners[runner.key]
        if not runner.task.cancelled() and (error := runner.task.exception()) is not None:
            self._report(str(error))


class GroupRunner:
    """Runner of a group's game: it starts the worker, applies the rule for people who leave, and logs the result.

    People of the group only show the game. So it goes on, and is logged, also if none of their browsers is connected.

    Args:
        folder: folder of the study.
        design: design of the study.
        conductor: conductor of the study.
        pool: pool of workers.
        game: the game.
        absence_of: see `GroupGames`.
        comes_back: True if an earlier server has begun the game.

    Attributes:
        key: key of the game in the pool.
        task: task that ends with the game.
    """

    def __init__(
        self,
        folder: Path,
        design: ExperimentDesign,
        conductor: Conductor,
        pool: WorkerPool,
        game: GroupGame,
        absence_of: Callable[[str], float],
        *,
        comes_back: bool,
    ) -> None:
        self.key = group_key(game)
        self._design = design
        self._conductor = conductor
        self._pool = pool
        self._absence_of = absence_of
        self._group = game.group, game.step
        self._deaths = DeathCount()
        self._is_shown_over = False
        self._ends = game.has_absent and design.file.lobby.leaving is LeavingRule.END
        self._begun = asyncio.Event()
        self._over = asyncio.Event()
        self._result: JsonValue = None
        self._failure: BadFile | None = None
        self._inside = 0
        runs = {seat: conductor.progress.runs[person] for seat, person in game.people.items()}
        one = next(iter(runs.values()))
        self._step = one.plan[game.step - 1]
        practice = self._step.entry.step is StepKind.PRACTICE
        self._request = StudyGame(
            folder,
            one,
            self._step,
            practice,
            goes_on=not practice and not (comes_back and self._step.entry.resume is not ResumeRule.EXACT),
            consents={seat: "" if practice else run.agreed_at for seat, run in runs.items()},
            group=game.group,
            windows=seats_at_windows(runs),
            programs=frozenset(
                seat for seat, holder in game.began.items() if holder is SeatHolder.PROGRAM and seat not in runs
            ),
        )
        self.task = asyncio.create_task(self._run())

    @property
    def game(self) -> GroupGame:
        """The game, as the log has it."""
        return self._conductor.progress.groups[self._group]

    @property
    def is_over(self) -> bool:
        """True after the game has ended, and is logged."""
        return self._over.is_set()

    def seat_of(self, person: str) -> str:
        """Return the seat of a person."""
        return next(seat for seat, each in self.game.people.items() if each == person)

    def note_seen_over(self) -> None:
        """Note that a person sees the end of the game: who leaves from now on has not left it early."""
        self._is_shown_over = True

    async def request(self) -> StudyGame:
        """Return the request for the worker, after it has started for the first time."""
        await self._begun.wait()
        return self._request

    async def ended(self) -> JsonValue:
        """Wait until the game has ended and is logged; return the result of its worker.

        Raises:
            BadFile: the game could not be played.
        """
        self._inside += 1
        try:
            await self._over.wait()
        finally:
            self._inside -= 1
        if self._failure is not None:
            raise self._failure
        return self._result

    def stop(self) -> None:
        """Stop running the game here; its worker waits for another server."""
        self.task.cancel()

    async def _run(self) -> None:
        """Play the game to its end, and log it."""
        try:
            if not self._request.goes_on:
                await self._pool.end(self.key)
            self._log(await self._played())
        except BadFile as failure:
            self._failure = failure
        self._begun.set()
        self._over.set()
        while self._inside:
            await asyncio.sleep(LOOK)
        if self._failure is not None:
            raise self._failure
        self._pool.games.forget(self.key)

    async def _played(self) -> WorkerResult:
        """Play the game to its end; if its worker dies, another one resumes it."""
        while not self._deaths.are_too_many:
            try:
                return self._pool.games.result(self.key) or await self._run_once()
            except WorkerDied:
                self._deaths.add()
        problem = f"the programs of {MOST_DEATHS} games in a row have ended unexpectedly"
        raise BadFile(self._request.folder, problem, "See the messages above; `thbridge doctor` checks this machine")

    def _log(self, ended: WorkerResult) -> None:
        if ended.problem:
            raise BadFile(self._request.folder, ended.problem, "See `thbridge study status`")
        self._result = cast(JsonValue, msgspec.json.decode(ended.result))
        if not self._request.practice and isinstance(self._result, dict) and self.game.played is None:
            self._conductor.end_group_game(self.game, self._result)

    async def _run_once(self) -> WorkerResult:
        def hear(message: FromWorker) -> None:
            if isinstance(message, GamePassed):
                self._deaths.reached = message.seconds

        async with self._pool.enter(self.key, self._request, lambda _text: None, hear, None) as hosted:
            self._request = replace(self._request, goes_on=not self._request.practice)
            self._begun.set()
            tasks = asyncio.create_task(hosted.ended()), asyncio.create_task(self._watch(hosted))
            ending, watching = tasks
            try:
                await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
                if watching.done():
                    await watching  # It ends only if the log cannot be written.
                return await ending
            finally:
                for task in tasks:
                    task.cancel()
                await asyncio.gather(*tasks, return_exceptions=True)

    async def _watch(self, hosted: HostedGame) -> None:
        """Look at the people of the game again and again."""
        # This may be another worker than before.
        for seat, holder in self.game.seats.items():
            if holder is SeatHolder.PROGRAM and seat in self.game.people:
                hosted.fill(seat)
        while True:
            self._look(hosted)
            await asyncio.sleep(LOOK)

    def _look(self, hosted: HostedGame) -> None:
        for seat, person in self.game.people.items():
            is_here, holder = self._is_here(person), self.game.seats[seat]
            if is_here and holder is not SeatHolder.PERSON:
                self._change(EventKind.SEAT_RESUMED, seat)
                hosted.resume(seat)
            elif not is_here and holder is SeatHolder.PERSON and not self._is_shown_over and self._may_leave(person):
                self._change(EventKind.SEAT_LEFT, seat)
                self._leave(hosted, seat)
        runs = (self._conductor.progress.runs.get(person) for person in self.game.people.values())
        if self._ends or not any(run is not None and run.state is RunState.UNDER_WAY for run in runs):
            hosted.leave(everybody=True)

    def _leave(self, hosted: HostedGame, seat: str) -> None:
        """Apply the rule for a seat whose person has left."""
        match self._design.file.lobby.leaving:
            case LeavingRule.PROGRAM:
                self._change(EventKind.SEAT_FILLED, seat)
                hosted.fill(seat)
            case LeavingRule.END:
                self._ends = True
            case LeavingRule.EMPTY:
                pass

    def _is_here(self, person: str) -> bool:
        """Return True if a person takes part in the game, or has finished it."""
        run, presence = self._conductor.progress.runs.get(person), self._design.file.presence
        if run is None or run.state is not RunState.UNDER_WAY:
            return run is not None and run.step > self._step.number
        waits = presence.then is AbsenceRule.WAIT
        return run.step > self._step.number or not (waits and self._absence_of(person) >= presence.grace)

    def _may_leave(self, person: str) -> bool:
        """Return True unless a person is only absent and no other one holds a seat: the last one keeps the game."""
        run = self._conductor.progress.runs.get(person)
        return run is None or run.state is not RunState.UNDER_WAY or len(self.game.present) > 1

    def _change(self, kind: EventKind, seat: str) -> None:
        self._conductor.change_seat(kind, self.game, seat, self._deaths.reached)


class _StudyMatching:
    """Matching by the rules of a study; see `Matching`. `steps` has the step of each person who waits."""

    def __init__(self, room: WaitingRoom, steps: Mapping[str, PlannedStep]) -> None:
        self._room = room
        self._steps = steps

    def enter(self, person: str, now: float) -> None:
        self._room.enter(person, self._steps[person], now)

    def leave(self, person: str) -> None:
        self._room.leave(person)

    def update(self, now: float, most: int) -> Matches:
        changes = self._room.update(now, most)
        return Matches(tuple(MatchedGame(group_key(game), game.people) for game in changes.games), changes.ended)

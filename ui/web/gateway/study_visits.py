"""Courses of many people through one study, each in their own browser."""

import asyncio
import contextlib
import time
from collections.abc import AsyncIterator, Callable
from contextvars import ContextVar
from dataclasses import replace
from pathlib import Path

from thbridge.app.compose.setting import texts_of
from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.recruiting import Ending, ending_of
from thbridge.experiment.progress import Run
from thbridge.experiment.store.browser_tickets import BrowserTickets
from thbridge.experiment.store.events import EventKind, FrontEnd, LoggedEvent, RunState
from thbridge.files.errors import BadFile
from thbridge.roles.shared.notices import GameTexts
from thbridge.sockets.addresses import LOCALHOST
from ui.command_line.terminal import command
from ui.hosting.kiosk import words
from ui.hosting.kiosk.course import StudyCourse
from ui.hosting.kiosk.game_steps import StudyClock
from ui.hosting.kiosk.games import KioskStopped
from ui.hosting.kiosk.pages import KioskPages, WindowOfKiosk
from ui.model.kiosk import HostStops, ResearcherMessage, StudyTexts, TextToRead, WentOn
from ui.web.gateway.browser_window import BrowserWindow
from ui.web.gateway.entry import LinkEntry
from ui.web.gateway.game_queue import GameQueue
from ui.web.gateway.group_games import GroupGames
from ui.web.gateway.people import Visitor
from ui.web.gateway.players_window import PlayersWindow
from ui.web.gateway.pooled_games import PooledGames, game_key
from ui.web.gateway.presence import NOTICED, PersonHere, absence_of
from ui.web.gateway.served_kiosk import ServedKiosk
from ui.web.gateway.waiting import await_turn, pause
from ui.web.page.desk_page import PersonNow
from ui.web.pool.pool import WorkerPool


class VisitClock(StudyClock):
    """Clock of a study with many people: each person's task has the simulated time of its own game."""

    def __init__(self) -> None:
        self._simulated: ContextVar[float | None] = ContextVar("simulated", default=None)

    @property
    def simulated(self) -> float | None:
        """Simulated time of the game that this task runs, seconds; None outside of games."""
        return self._simulated.get()

    @simulated.setter
    def simulated(self, seconds: float | None) -> None:
        self._simulated.set(seconds)


class StudyVisits:
    """Courses of all visitors of one study.

    Args:
        folder: folder of the study.
        design: its design.
        conductor: its conductor, which uses `clock`.
        clock: clock of the log's events.
        pool: pool of workers.
        queue: queue of people who wait for a game.
        tickets: record of browsers and their participants.
        report: function that receives sentences about problems, for the researcher.

    Attributes:
        here: people who have opened the study since the gateway was started, by their ids.
        groups: games of groups.
        kiosk: window on this machine, at which people take part as well; None if there is none.
    """

    def __init__(
        self,
        folder: Path,
        design: ExperimentDesign,
        conductor: Conductor,
        clock: VisitClock,
        pool: WorkerPool,
        queue: GameQueue,
        tickets: BrowserTickets,
        report: Callable[[str], None],
    ) -> None:
        self._folder = folder
        self._design = design
        self._conductor = conductor
        self._clock = clock
        self._pool = pool
        self._queue = queue
        self._tickets = tickets
        self._report = report
        conductor.listeners.append(self._forget_result)
        self.here: dict[str, PersonHere] = {}
        self.kiosk: ServedKiosk | None = None
        began = time.monotonic()

        def absent(participant: str) -> float:
            if self.kiosk is not None and participant == self.kiosk.person:
                return 0.0
            return absence_of(self.here.get(participant), began, time.monotonic())

        self.groups = GroupGames(folder, design, conductor, pool, queue, absent, report)
        self.texts: Texts = texts_of(design.study, design.beside).in_browser()

    def _forget_result(self, logged: LoggedEvent) -> None:
        """Delete the result of a person's game once the log shows that it is not needed any more."""
        event = logged.event
        if event.kind in {EventKind.STEP_ENDED, EventKind.RUN_ENDED}:
            run = self._conductor.progress.runs[event.participant]
            for step in run.plan[: event.step or run.step]:
                self._pool.games.forget(game_key(run, step))

    def window(self) -> BrowserWindow:
        """Return a window in the study's language."""
        return BrowserWindow(self.texts)

    @contextlib.asynccontextmanager
    async def kiosk_opened(self, window: WindowOfKiosk) -> AsyncIterator[ServedKiosk]:
        """Lead people at this window through the study inside this context, one after the other."""
        self.kiosk = ServedKiosk(
            self._folder,
            self._design,
            self._conductor,
            self._clock,
            self._pool,
            self._queue,
            self.groups,
            window,
            self._report,
        )
        async with self.kiosk.opened():
            yield self.kiosk

    # The researcher's side; see `PeopleHere`

    def people_now(self) -> dict[str, PersonNow]:
        """Return the browsers and the window of people, by their ids."""
        people = {who: self._now(who, each.window, each.pages, *_connection(each)) for who, each in self.here.items()}
        if self.kiosk is not None and self.kiosk.person:
            who = self.kiosk.person
            people[who] = self._now(who, self.kiosk.window, self.kiosk.pages, "here", None)
        return people

    def _now(
        self, participant: str, window: PlayersWindow, pages: KioskPages, connection: str, round_trip: float | None
    ) -> PersonNow:
        progress = self._conductor.progress
        watch = command("watch", f"{LOCALHOST}:{window.watch_port}") if window.watch_port else ""
        now = PersonNow(connection, round_trip, pages.lag, window.plays, watch, window.watch_host)
        waited, run, step = self.groups.waited.get(participant), progress.runs[participant], None
        if run.state is RunState.UNDER_WAY:
            step = progress.next_step(participant)
        if step is None or step.number not in run.seats:
            return replace(now, waited=None if waited is None else int(waited))
        return replace(now, game=run.seats[step.number].group, seat=words.seat_label(self._design, run, step))

    async def show_message(self, participant: str, text: str) -> None:
        """Show a message of the researcher to a person, who may see it only when they come back."""
        if (found := self._found(participant)) is not None:
            await found.pages.window.send(ResearcherMessage(text))

    def wake(self, participant: str) -> None:
        """Make the course of a person look at their run again."""
        if (found := self._found(participant)) is not None:
            found.pages.wake()

    def watch(self, participant: str) -> None:
        """Make the game of a person ready for `thbridge watch`."""
        if (found := self._found(participant)) is not None:
            found.window.watch_game()

    def _found(self, participant: str) -> PersonHere | ServedKiosk | None:
        """Return the browser or the kiosk of a person; None if they have not opened the study yet."""
        is_at_kiosk = self.kiosk is not None and participant == self.kiosk.person
        return self.kiosk if is_at_kiosk else self.here.get(participant)

    # The people's side

    def greet(self, secret: str, entry: LinkEntry) -> TextToRead | None:
        """Return the first page of a new visitor; None for people who have begun, and for people who must wait."""
        return None if self._run_of(secret, entry) is not None else self._entrance(entry)

    async def visit(self, visitor: Visitor) -> None:
        """Take a visitor through the study, from the step at which they are."""
        window = visitor.window
        await window.send(StudyTexts(GameTexts.of(self.texts)))
        pages = KioskPages(self._conductor, window, self.texts)
        games = PooledGames(self._folder, self._pool, self._queue, self.groups, window, pages)
        course = StudyCourse(self._design, self._conductor, pages, games, self._clock)
        listening = asyncio.create_task(pages.listen())
        try:
            with contextlib.suppress(KioskStopped):
                await self._go_through(course, pages, visitor)
        except BadFile as bad:
            self._report(str(bad))
            text = self.texts.text("kiosk.failed_text")
            await window.send(HostStops(self.texts.text("kiosk.pauses"), text))
        finally:
            window.has_place = False
            listening.cancel()
            await asyncio.gather(listening, return_exceptions=True)

    async def _go_through(self, course: StudyCourse, pages: KioskPages, visitor: Visitor) -> None:
        run, again = self._run_of(visitor.secret, visitor.entry), False
        if run is None:
            run = await self._admit(course, pages, visitor.entry)
            if run is None:
                return
        elif run.state is RunState.UNDER_WAY:
            again = True
        visitor.window.has_place = True
        participant = run.participant
        self._tickets.keep(visitor.secret, participant)
        pages.person = participant
        self.here[participant] = PersonHere(visitor, pages)
        if run.message:
            await visitor.window.send(ResearcherMessage(run.message))
        if run.state is RunState.UNDER_WAY:
            await course.go_through(participant, again=again)
        elif not run.farewell_read:
            await course.part(participant)
        run = self._conductor.progress.runs[participant]
        thanks, ending = self.texts.text("kiosk.thank_you"), course.ending(run)
        # A person who loads the page again still finds what the recruiting service wants.
        text = "" if ending else self.texts.text("pages.close_window")
        await pages.show(TextToRead(0, thanks, text, button="", code=run.code, ending=ending))

    def _run_of(self, secret: str, entry: LinkEntry) -> Run | None:
        """Return the run of a visitor who has begun before."""
        progress = self._conductor.progress
        if entry.external_id:
            return progress.run_of(entry.external_id)
        return progress.runs.get(self._tickets.participant(secret))

    def _entrance(self, entry: LinkEntry) -> TextToRead | None:
        """Return the first page of a new visitor: it invites them, or says that the study is full; None if they must
        wait.
        """
        texts, place = self.texts, self._conductor.progress.next_place()
        if self._queue.is_closed or place in {NoPlace.TAKEN, NoPlace.CLOSED}:
            return None
        if place is NoPlace.FULL:
            ending = ending_of(self._design.file.recruiting, Ending.FULL, entry.parameters)
            return TextToRead(0, *words.headed(texts, "full"), button="", ending=ending)
        return TextToRead(0, *words.headed(texts, "welcome"), button=texts.text("kiosk.begin"), anew=True)

    async def _await_place(self, pages: KioskPages) -> None:
        """Let a visitor wait until a place may be free, or until the study is full."""
        if not await await_turn(
            pages,
            words.headed(self.texts, "waiting_for_place", "web"),
            lambda: self._conductor.progress.next_place() not in {NoPlace.TAKEN, NoPlace.CLOSED},
        ):
            heading, text = words.headed(self.texts, "waiting_stopped", "web")
            await pages.show(TextToRead(0, heading, text, button=self.texts.text("web.wait_again")))
            while not isinstance(await pages.next(), WentOn):
                pass

    async def _admit(self, course: StudyCourse, pages: KioskPages, entry: LinkEntry) -> Run | None:
        """Show the first page until a visitor has a place; return their run, or None if the study is full."""
        await course.text_steps.send_instructions(None)
        while True:
            if self._queue.is_closed:
                await pause(pages.window, self.texts)
            entrance = self._entrance(entry)
            if entrance is None:
                await self._await_place(pages)
                continue
            await pages.show(entrance)
            if not entrance.button:
                return None
            while not isinstance(await pages.next(), WentOn):
                pass
            if self._queue.is_closed:
                continue
            admitted = self._conductor.admit(entry.external_id, entry.parameters, FrontEnd.BROWSER)
            if not isinstance(admitted, NoPlace):
                return admitted


def _connection(person: PersonHere) -> tuple[str, float | None]:
    """Return the connection of a person's browser, as in `PersonNow`, and its last round-trip time."""
    visitor = person.visitor
    is_away = time.monotonic() - visitor.present_at > NOTICED
    return "gone" if visitor.live is None else "away" if is_away else "here", visitor.round_trip

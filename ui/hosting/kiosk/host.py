"""Host of the kiosk: shows pages one after the other, and logs all actions of the person at once.

The host's only state is the log. After a crash, the host resumes with the same person at the same step.
"""

import asyncio
import contextlib
from collections.abc import Callable, Coroutine

from thbridge.app.compose.setting import texts_of
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign, WhoBegins
from thbridge.experiment.store.events import EventKind, FrontEnd, LoggedEvent, RunState
from thbridge.files.errors import BadFile
from thbridge.roles.shared.notices import GameTexts
from ui.hosting.kiosk import words
from ui.hosting.kiosk.course import StudyCourse
from ui.hosting.kiosk.game_steps import GamesOfStudy, StudyClock
from ui.hosting.kiosk.games import KioskStopped
from ui.hosting.kiosk.hosted_study import HostedStudy, runs_at_kiosk, unfinished_at_kiosk
from ui.hosting.kiosk.pages import KioskPages, RunOver, WindowOfKiosk
from ui.model.kiosk import (
    BeginNext,
    CloseKiosk,
    HostStops,
    ResearcherMessage,
    StudyTexts,
    TextToRead,
    WentOn,
)

CHANGES_PLACES = {
    EventKind.RUN_BEGUN,
    EventKind.RUN_ENDED,
    EventKind.RUN_EXCLUDED,
    EventKind.ADMISSION_CLOSED,
    EventKind.ADMISSION_OPENED,
}
"""Kinds of events after which the next person may have a place, or none."""


class KioskHost:
    """Host that leads one person after the other through a study.

    Args:
        design: design of the study.
        conductor: conductor of the study, which uses `clock`.
        window: window of the kiosk; it is opened here.
        games: player of the games.
        clock: clock of the log's events.
        pages: pages of the window, if other parts use them too. If None, the host makes them.
        is_closed: function that returns True if no further people can begin, for a reason that is not in the log.

    Raises:
        BadFile: the texts of the study's language cannot be read.

    Attributes:
        study: interface for the researcher's desk.
    """

    def __init__(
        self,
        design: ExperimentDesign,
        conductor: Conductor,
        window: WindowOfKiosk,
        games: GamesOfStudy,
        clock: StudyClock,
        pages: KioskPages | None = None,
        is_closed: Callable[[], bool] = lambda: False,
    ) -> None:
        self._design = design
        self._pages = pages or KioskPages(conductor, window, texts_of(design.study, design.beside))
        self._texts = self._pages.texts
        self._conductor = conductor
        self._window = window
        self._is_closed = is_closed
        self._course = StudyCourse(design, conductor, self._pages, games, clock)
        self.study = HostedStudy(conductor, self._pages)
        conductor.listeners.append(self._look_for_place)

    async def run(self) -> None:
        """Lead people through the study until the window is closed or the program is stopped.

        Raises:
            BadFile: the log or a recording cannot be written, or a text cannot be read.
        """
        await self._host(self._people())

    async def preview(self, participant: str, last: int) -> None:
        """Lead a person through the steps up to number `last`, then close the window.

        Raises:
            BadFile: see `run`.
        """
        await self._host(self._steps_until(participant, last))

    async def _host(self, people: Coroutine[object, object, None]) -> None:
        """Keep the window open while a coroutine runs."""
        async with self._window.opened():
            await self._window.send(StudyTexts(GameTexts.of(self._texts)))
            listening = asyncio.create_task(self._pages.listen())
            failed = False
            try:
                with contextlib.suppress(KioskStopped):
                    await people
            except BadFile:
                failed = True
                raise
            finally:
                await self._end(failed=failed)
                listening.cancel()
                await asyncio.gather(listening, return_exceptions=True)

    async def _people(self) -> None:
        await self._resume()
        while True:
            await self._course.go_through(await self._next_run())

    async def _steps_until(self, participant: str, last: int) -> None:
        self._pages.person = participant
        with contextlib.suppress(RunOver):
            while self._pages.run.step <= last and await self._course.begin():
                pass
        self._pages.closed = True

    async def _end(self, *, failed: bool) -> None:
        """Close the window. If a person is in the middle of the study, leave it open with a message instead."""
        if self._pages.closed or not self._pages.person or self._pages.run.state is not RunState.UNDER_WAY:
            await self._window.send(CloseKiosk())
            return
        text = self._texts.text("kiosk.failed_text" if failed else "kiosk.stopped_text")
        await self._window.send(HostStops(self._texts.text("kiosk.pauses"), text))
        self._window.leave_open()

    async def _resume(self) -> None:
        """Resume the run that was in progress at the window when an earlier program crashed."""
        runs = runs_at_kiosk(self._conductor.progress)
        for run in unfinished_at_kiosk(self._conductor.progress):
            self._pages.person = run.participant
            if run.message:
                await self._window.send(ResearcherMessage(run.message))
            with contextlib.suppress(RunOver):
                await self._pages.read(TextToRead(0, *words.headed(self._texts, "restarted")))
            await self._course.go_through(run.participant, again=True)
        if runs and runs[-1].state is not RunState.UNDER_WAY and not runs[-1].farewell_read:
            self._pages.person = runs[-1].participant
            await self._course.part(self._pages.person)

    async def _next_run(self) -> str:
        """Wait until the next person begins; return their id."""
        await self._course.text_steps.send_instructions(None)
        while True:
            no_place = self._no_place()
            if no_place is not None:
                await self._pages.show(TextToRead(0, *words.no_place(self._texts, no_place), button="", anew=True))
            elif self._design.file.begins is WhoBegins.RESEARCHER:
                text = self._texts.text("kiosk.welcome_wait")
                await self._pages.show(TextToRead(0, self._texts.text("kiosk.welcome"), text, button="", anew=True))
            else:
                begin = self._texts.text("kiosk.begin")
                await self._pages.show(TextToRead(0, *words.headed(self._texts, "welcome"), button=begin, anew=True))
            begins = self._pages.admits
            while not begins and self._no_place() is no_place:
                message = await self._pages.next()
                begins = self._pages.admits or isinstance(message, WentOn | BeginNext)
            self._pages.admits = False
            if begins and self._no_place() is None:
                admitted = self._conductor.admit(front_end=FrontEnd.WINDOW)
                if not isinstance(admitted, NoPlace):
                    return admitted.participant

    def _look_for_place(self, logged: LoggedEvent) -> None:
        """Show the next person another page if people in browsers have taken the last place, or if one is free."""
        if not self._pages.person and logged.event.kind in CHANGES_PLACES:
            self._pages.wake()

    def _no_place(self) -> NoPlace | None:
        """Return the reason why the next person cannot begin; None if there is a place."""
        place = self._conductor.progress.next_place()
        if self._is_closed() and place is not NoPlace.FULL:
            return NoPlace.CLOSED
        return place if isinstance(place, NoPlace) else None

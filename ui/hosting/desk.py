"""The researcher's desk beside a study under way: kept informed, and what it asks for is passed on."""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Protocol

from thbridge.experiment.folder import ExperimentFolder
from thbridge.files.errors import BadFile
from thbridge.timing.wall_clock import utc_now
from ui.command_line.terminal import THBRIDGE
from ui.hosting.window_process import WindowProcess
from ui.model.desk.messages import (
    DESK,
    DeskClosed,
    DeskState,
    EndRun,
    ExcludeRun,
    FromDesk,
    NextParticipant,
    ShowRun,
    WithdrawRun,
    WriteNote,
)
from ui.sources.experiment import ExperimentSource

GATHERED = 0.2
"""Seconds within which events are told together."""
RENEWED = 20.0
"""Seconds after which minutes are counted anew though nothing has happened."""


class DeskFailed(Exception):  # noqa: N818 - it is told as a sentence
    """The desk cannot be kept open."""


class StudyUnderWay(Protocol):
    """A study that a program carries on, as its desk needs it.

    What is asked for returns a sentence why it cannot be, or nothing.

    Attributes:
        changed: is called after each event of its log, and when `kiosk` or `troubles` are others.
    """

    changed: Callable[[], None]

    @property
    def kiosk(self) -> str:
        """The kiosk's page now, in words."""

    @property
    def troubles(self) -> tuple[str, ...]:
        """Sentences about all that somebody has to look at."""

    def admit_next(self) -> str | None:
        """Let the next person begin at the kiosk."""

    def note(self, text: str, participant: str) -> str | None:
        """Take down a note, about a person or, if that is empty, nobody."""

    def exclude(self, participant: str, reason: str) -> str | None:
        """Decide that a run does not count."""

    def end_run(self, participant: str, reason: str) -> str | None:
        """End a run where it is."""

    def busy_with(self, participant: str) -> str | None:
        """Return why a participant cannot withdraw now."""


class Desk:
    """The desk of one study.

    Args:
        study: what it is about; its `changed` is set here.
        folder: of the study, whose log is shown.
        arguments: of the window's command line.
        troubles: sentences about what else somebody has to look at, such as those of markers.
        command: opens the window; None: the desk's own.
        withdraw: deletes everything of a participant, and returns what somebody still has to do.

    Raises:
        BadFile: the study cannot be read.
    """

    def __init__(
        self,
        study: StudyUnderWay,
        folder: ExperimentFolder,
        arguments: tuple[str, ...] = (),
        troubles: Callable[[], tuple[str, ...]] = tuple,
        command: tuple[str, ...] | None = None,
        withdraw: Callable[[str], str] = lambda _: "This program cannot delete anything.",
    ) -> None:
        self._study = study
        self._withdraw = withdraw
        self._troubles = troubles
        self._source = ExperimentSource(folder, utc_now)
        watch = (*THBRIDGE, "study", "watch", str(folder.root), "--hosted", *arguments)
        self._window: WindowProcess[DeskState, FromDesk] = WindowProcess(command or watch, DESK, "desk")
        self._shown = ""
        self._refused = ""
        self._news = asyncio.Event()
        study.changed = self._news.set

    async def run(self) -> None:
        """Keep the desk open until the researcher closes it; cancel it to close it.

        Raises:
            DeskFailed: it crashes whenever it is opened.
        """
        async with self._window.opened():
            tasks = asyncio.create_task(self._ask()), asyncio.create_task(self._inform())
            try:
                done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            finally:
                for task in tasks:
                    task.cancel()
                await asyncio.gather(*tasks, return_exceptions=True)
            for task in done:
                task.result()
        if self._window.given_up:
            raise DeskFailed("it crashes whenever it is opened")

    async def _inform(self) -> None:
        while True:
            self._news.clear()
            await self._window.send(await asyncio.to_thread(self._state))
            with suppress(TimeoutError):
                await asyncio.wait_for(self._news.wait(), RENEWED)
            await asyncio.sleep(GATHERED)

    def _state(self) -> DeskState:
        self._source.poll()
        troubles = (*self._study.troubles, *self._troubles(), *((self._refused,) if self._refused else ()))
        return self._source.state(self._shown, self._study.kiosk, troubles)

    async def _ask(self) -> None:
        while not isinstance(request := await self._window.next_request(), DeskClosed):
            if isinstance(request, ShowRun):
                self._shown = request.participant
            else:
                self._refused = self._asked(request)
            self._news.set()

    def _asked(self, request: NextParticipant | WriteNote | ExcludeRun | EndRun | WithdrawRun) -> str:
        """Do what is asked for; return why that cannot be, or nothing."""
        study = self._study
        try:
            match request:
                case NextParticipant():
                    return study.admit_next() or ""
                case WriteNote(text, participant):
                    return study.note(text, participant) or ""
                case ExcludeRun(participant, reason):
                    return study.exclude(participant, reason) or ""
                case EndRun(participant, reason):
                    return study.end_run(participant, reason) or ""
                case WithdrawRun(participant):
                    return study.busy_with(participant) or self._withdraw(participant)
        except BadFile as error:
            return str(error)

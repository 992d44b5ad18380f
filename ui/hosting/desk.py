"""Host of the researcher's desk in a running study: sends the study's state to the desk, and carries out requests."""

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
"""Seconds for which events are collected before one update."""
RENEWED = 20.0
"""After this number of seconds, the state is sent again even without events, as the desk shows times in minutes."""


class DeskFailed(Exception):  # noqa: N818 - it is shown as a sentence
    """The desk cannot be kept open."""


class StudyUnderWay(Protocol):
    """Interface of a running study for its desk.

    Methods that handle a request return a sentence if they refuse the request, otherwise None.

    Attributes:
        changed: function that is called after each event of the log, and when `kiosk` or `troubles` change.
    """

    changed: Callable[[], None]

    @property
    def kiosk(self) -> str:
        """Description of the page that the kiosk shows."""

    @property
    def troubles(self) -> tuple[str, ...]:
        """Sentences about problems that a person must look at."""

    def admit_next(self) -> str | None:
        """Allow the next person to begin at the kiosk."""

    def note(self, text: str, participant: str) -> str | None:
        """Record a note about a person. If `participant` is empty, the note is about the study."""

    def exclude(self, participant: str, reason: str) -> str | None:
        """Exclude a participant's run from the data."""

    def end_run(self, participant: str, reason: str) -> str | None:
        """End a participant's run at the current step."""

    def busy_with(self, participant: str) -> str | None:
        """Return a sentence if a participant cannot withdraw now, otherwise None."""


class Desk:
    """Desk of one study.

    Args:
        study: study to show; its `changed` is set here.
        folder: folder of the study, with its log.
        arguments: arguments for the window's command line.
        troubles: function that returns sentences about other problems, such as problems with markers.
        command: command that opens the window. If None, the command of the desk's own window.
        withdraw: function that deletes all data of a participant, and returns sentences about remaining tasks.

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
        """Keep the desk open until the researcher closes it. Cancelling this coroutine also closes the desk.

        Raises:
            DeskFailed: the window crashes each time it is opened.
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
            raise DeskFailed("it crashes each time it is opened")

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
        """Carry out a request; return a sentence if this is not possible, otherwise an empty text."""
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

"""Pages of the kiosk, which the person sees one after the other. Messages of the window are logged at once."""

import asyncio
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractAsyncContextManager
from typing import Protocol, TypeAlias

from msgspec import structs

from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import EventKind, JsonValue, RunState
from ui.hosting.kiosk import words
from ui.hosting.kiosk.games import KioskStopped
from ui.model.kiosk import (
    Answer,
    AnswerKept,
    BeginNext,
    ConsentToAsk,
    FocusNews,
    FormToFill,
    FromKiosk,
    GamePrepared,
    GameRecorded,
    GameToJoin,
    InstructionsNews,
    KioskClosed,
    MessageClosed,
    StoppedTakingPart,
    StudyProgress,
    TextToRead,
    ToKiosk,
    TurnToAwait,
    WentOn,
)


class WindowOfKiosk(Protocol):
    """Kiosk's window, implemented by `WindowProcess`."""

    async def send(self, message: ToKiosk) -> None:
        """Send a message."""

    async def next_request(self) -> FromKiosk:
        """Wait for the next message of the window."""

    def opened(self) -> AbstractAsyncContextManager[None]:
        """Keep the window open inside this context."""

    def leave_open(self) -> None:
        """Leave the window open after the context of `opened`."""


class RunOver(Exception):  # noqa: N818 - nothing went wrong with the program
    """The run of the person at the window has ended or is excluded."""


class StepOver(Exception):  # noqa: N818 - nothing went wrong with the program
    """The person's step has ended meanwhile, and the log has its end."""


class Woken:
    """Message about a change outside the window."""


Page: TypeAlias = TextToRead | ConsentToAsk | FormToFill | GamePrepared | TurnToAwait | GameToJoin | GameRecorded


class KioskPages:
    """Pages of the kiosk, and the window's messages about them.

    Args:
        conductor: conductor of the study.
        window: window that shows the pages.
        texts: texts of the study.

    Attributes:
        changed: function that is called when another page is shown, and when the lag changes.
        person: id of the participant at the kiosk; empty if no participant is there.
        number: number of the shown page.
        shown: description of the shown page.
        lag: time by which the game is behind real time, whole seconds.
        looks_away: True while keys and clicks go to another window.
        admits: True after the researcher has allowed the next person to begin.
        closed: True after the window was closed on purpose.
    """

    def __init__(self, conductor: Conductor, window: WindowOfKiosk, texts: Texts) -> None:
        self.changed: Callable[[], None] = lambda: None
        self.window = window
        self.texts = texts
        self.person = self.shown = ""
        self.number = self.lag = 0
        self.admits = self.looks_away = self.closed = False
        self._conductor = conductor
        self._messages: asyncio.Queue[FromKiosk | Woken] = asyncio.Queue()

    @property
    def run(self) -> Run:
        """Run of the person at the kiosk."""
        return self._conductor.progress.runs[self.person]

    def note_lag(self, lag: float) -> None:
        """Set the lag that the researcher sees, in whole seconds."""
        if int(lag) != self.lag:
            self.lag = int(lag)
            self.changed()

    def wake(self) -> None:
        """Make `next` return a message about a change outside the window."""
        self._messages.put_nowait(Woken())

    async def listen(self) -> None:
        """Receive messages of the window until cancelled."""
        while True:
            self._messages.put_nowait(await self.window.next_request())

    async def show(self, page: Page) -> None:
        """Show a page."""
        await self.window.send(self.numbered(page))

    def numbered(self, page: Page) -> Page:
        """Return a page with the next page number and the person's progress."""
        self.number += 1
        self.shown = words.page(page)
        self.changed()
        return structs.replace(page, page=self.number, progress=self.progress)

    @property
    def progress(self) -> StudyProgress:
        """Number of the person's current step, and number of all steps of the person."""
        run = self._conductor.progress.runs.get(self.person)
        if run is None or run.state is not RunState.UNDER_WAY:
            return StudyProgress()
        return StudyProgress(*self._conductor.progress.step_count(self.person))

    async def kept(self, item: str, answer: Answer, *, timed_out: bool = False) -> None:
        """Inform the window that an answer on its page is now in the log."""
        await self.window.send(AnswerKept(self.number, item, answer, timed_out))

    async def read(self, page: TextToRead | GameRecorded) -> None:
        """Show a page until the person continues."""
        await self.show(page)
        while not isinstance(await self.next_of_run(), WentOn):
            pass

    async def next(self) -> FromKiosk | Woken:
        """Wait for a message about the shown page, or a change outside the window."""
        while True:
            message = self._taken(await self._messages.get())
            if message is not None:
                return message

    async def next_of_run(self) -> FromKiosk | Woken:
        """Wait like `next`; raise RunOver if the person's run has ended."""
        message = await self.next()
        self.check()
        return message

    def check(self) -> None:
        """Raise RunOver if the person's run has ended."""
        if self.run.state is not RunState.UNDER_WAY:
            raise RunOver

    def waiting(self) -> Iterator[FromKiosk | Woken]:
        """Yield all messages that `next` can return without waiting."""
        while not self._messages.empty():
            message = self._taken(self._messages.get_nowait())
            if message is not None:
                yield message

    def _taken(self, message: FromKiosk | Woken) -> FromKiosk | Woken | None:
        """Handle a message that does not depend on the page, and return None.

        Return other messages unchanged; return None for a message about another page.
        """
        match message:
            case KioskClosed():
                self.closed = True
                raise KioskStopped
            case FocusNews(has_focus, window_ns):
                self.looks_away = not has_focus
                if self.person:
                    kind = EventKind.FOCUS_REGAINED if has_focus else EventKind.FOCUS_LOST
                    self.tell(kind, {"window_ns": window_ns})
                return None
            case InstructionsNews(is_open, window_ns):
                if self.person:
                    kind = EventKind.INSTRUCTIONS_OPENED if is_open else EventKind.INSTRUCTIONS_CLOSED
                    self.tell(kind, {"window_ns": window_ns})
                return None
            case MessageClosed():
                if self.person:
                    self.tell(EventKind.MESSAGE_CLOSED, {})
                return None
            case StoppedTakingPart():
                if self.person and self.run.state is RunState.UNDER_WAY:
                    self._conductor.leave(self.person, "stopped taking part")
                return Woken()
            case BeginNext() | Woken():
                return message
            case _:
                return message if message.page == self.number else None

    def tell(self, kind: EventKind, data: Mapping[str, JsonValue]) -> None:
        """Record an action of the person, in the current step if there is one."""
        step = self._conductor.progress.next_step(self.person) if self.run.under_way else None
        if step is None:
            self._conductor.tell_of_run(kind, self.person, data, "participant")
        else:
            self._conductor.tell(kind, self.person, step, data, "participant")

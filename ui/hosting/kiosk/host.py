"""The host of the kiosk: shows people one page after the other, and has all that they do in the log at once.

It knows nothing that the log does not know. After a crash it goes on with the same person where they were.
"""

import asyncio
import contextlib
import hashlib
import math
import secrets
import time
from collections.abc import Callable, Coroutine, Mapping
from contextlib import AbstractAsyncContextManager
from pathlib import Path
from typing import Protocol, TypeAlias, TypeVar

from msgspec import structs

from thbridge.app.compose.setting import texts_of
from thbridge.app.consent import ParticipantDeclined
from thbridge.batch.settings import SettingCache
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor, unfinished
from thbridge.experiment.design.experiment_file import ExperimentDesign, WhoBegins
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import PracticeTerm, ResumeRule, StepKind
from thbridge.experiment.progress import Progress, Run, options_shown, resumes
from thbridge.experiment.questionnaires.form import Form, Item
from thbridge.experiment.store.events import Actor, Clocks, EventKind, JsonValue, RunState, StepOutcome
from thbridge.experiment.trials import PracticeCount, results_of
from thbridge.files.disk.text_files import read_bytes, read_text, text_of
from thbridge.files.errors import BadFile
from thbridge.roles.shared.notices import GameTexts
from thbridge.sockets.addresses import ListeningAddress
from thbridge.timing.wall_clock import utc_now
from ui.hosting.kiosk import words
from ui.hosting.kiosk.answers import form_item, is_answer, to_answer, to_json
from ui.hosting.kiosk.games import GameWatcher, KioskStopped
from ui.hosting.lobby import WILDCARD_ADDRESSES
from ui.model.kiosk import (
    AnswerKept,
    BeginNext,
    CloseKiosk,
    ConsentReply,
    ConsentToAsk,
    FocusNews,
    FormItem,
    FormToFill,
    FromKiosk,
    GameNews,
    GamePrepared,
    GameRecorded,
    GameSeenOver,
    GameToJoin,
    HostStops,
    InstructionsNews,
    InstructionsSoFar,
    InstructionText,
    ItemNews,
    KioskClosed,
    StoppedTakingPart,
    StudyProgress,
    StudyTexts,
    TextToRead,
    ToKiosk,
    WentBack,
    WentOn,
)


class WindowOfKiosk(Protocol):
    """The window, as `WindowProcess` has it."""

    async def send(self, message: ToKiosk) -> None:
        """Send a message."""

    async def next_request(self) -> FromKiosk:
        """Wait for its next message."""

    def opened(self) -> AbstractAsyncContextManager[None]:
        """Keep it open inside this context."""

    def leave_open(self) -> None:
        """Leave it as it is after that context."""


class GamesOfStudy(Protocol):
    """Player of games, as `StudyGames` does."""

    async def practise(self, run: Run, step: PlannedStep, watcher: GameWatcher) -> PracticeCount:
        """Play the practice game; return what was done in it."""

    async def play(
        self, run: Run, step: PlannedStep, watcher: GameWatcher, *, goes_on: bool
    ) -> dict[str, JsonValue] | None:
        """Play a person's game; what the log keeps of it, or None where it did not come to its end."""


class StudyClock:
    """The clocks of a study's events.

    Attributes:
        simulated: seconds of simulated time while a game is played; None outside of games.
    """

    def __init__(self) -> None:
        self.simulated: float | None = None

    def __call__(self) -> Clocks:
        """Return the times now."""
        return Clocks(utc_now(), time.monotonic_ns(), self.simulated)


class _RunOver(Exception):  # noqa: N818 - nothing went wrong with the program
    """The run of the person at the window has ended, or is excluded."""


class _Woken:
    """Something changed without the window."""


PlayedT = TypeVar("PlayedT")
MOST_PRACTICE = 3
"""Practice games, at most, of a person who does not do in them what the step asks for."""

_Page: TypeAlias = TextToRead | ConsentToAsk | FormToFill | GamePrepared | GameToJoin | GameRecorded


class KioskHost:
    """Takes one person after the other through a study.

    Args:
        design: the study.
        conductor: of its log; its clocks are `clock`.
        window: in which people go through it; opened here.
        games: plays its games.
        clock: of its events.

    Raises:
        BadFile: the texts of the study's language cannot be read.

    Attributes:
        changed: called after each event of the log, and when another page is shown.
    """

    def __init__(
        self,
        design: ExperimentDesign,
        conductor: Conductor,
        window: WindowOfKiosk,
        games: GamesOfStudy,
        clock: StudyClock,
    ) -> None:
        self.changed: Callable[[], None] = _ignore
        self._design = design
        self._texts = texts_of(design.study, design.beside)
        self._conductor = conductor
        self._window = window
        self._games = games
        self._clock = clock
        self._token = secrets.token_hex(8)
        self._heard: asyncio.Queue[FromKiosk | _Woken] = asyncio.Queue()
        self._person = ""
        self._page = 0
        self._lag = 0
        self._admits = self._looks_away = self._closed = False
        self._shown = ""
        self._instructions: tuple[PlannedStep, ...] = ()
        conductor.listeners.append(lambda _event: self.changed())

    # For the researcher's desk: see `StudyUnderWay`

    @property
    def progress(self) -> Progress:
        """Places and steps of everybody."""
        return self._conductor.progress

    @property
    def kiosk(self) -> str:
        """The page that is shown, in words."""
        return f"{self._person}: {self._shown}" if self._person else self._shown

    @property
    def troubles(self) -> tuple[str, ...]:
        """Sentences about what somebody has to look at."""
        troubles = []
        if self._looks_away and self._person:
            troubles.append("At the kiosk, keys and clicks go to another window.")
        if self._lag:
            troubles.append(words.LAGS.format(self._lag))
        return tuple(troubles)

    def admit_next(self) -> str | None:
        """Begin the run of the next person; else return why that cannot be."""
        if under_way := unfinished(self.progress):
            return f"{under_way[0].participant} is still under way."
        if isinstance(place := self.progress.next_place(), NoPlace):
            return words.NO_PLACE_TOLD[place]
        self._admits = True
        self._wake()
        return None

    def note(self, text: str, participant: str) -> str | None:
        """Take down words of the researcher."""
        self._conductor.note(text, participant)
        return None

    def exclude(self, participant: str, reason: str) -> str | None:
        """Decide that a run does not count; whoever is in it is told that it ends."""
        if participant not in self.progress.runs:
            return f"Nobody is called {participant}."
        if self.progress.runs[participant].state is RunState.EXCLUDED:
            return f"{participant} is excluded already."
        if other := self._other_in(reason, participant):
            return words.NAMES_OTHER.format(other)
        self._conductor.exclude(participant, reason)
        self._wake()
        return None

    def end_run(self, participant: str, reason: str) -> str | None:
        """End a run: the person went, or cannot go on."""
        run = self.progress.runs.get(participant)
        if run is None or run.state is not RunState.UNDER_WAY:
            return f"{participant} is not under way."
        if other := self._other_in(reason, participant):
            return words.NAMES_OTHER.format(other)
        self._conductor.leave(participant, reason, actor="experimenter")
        self._wake()
        return None

    def busy_with(self, participant: str) -> str | None:
        """Return why a participant cannot withdraw now: they are still at the kiosk."""
        run = self.progress.runs.get(participant)
        if participant == self._person or (run is not None and run.state is RunState.UNDER_WAY):
            return f"{participant} is still at the kiosk. End the run first, and let the last page be left."
        return None

    def _other_in(self, reason: str, participant: str) -> str | None:
        """Return who else is named in a reason, which stays when they withdraw."""
        return next((other for other in self.progress.runs if other in reason and other != participant), None)

    def _note_lag(self, lag: float) -> None:
        """Show the researcher each whole second by which the game is behind real time."""
        if int(lag) != self._lag:
            self._lag = int(lag)
            self.changed()

    def _wake(self) -> None:
        self._heard.put_nowait(_Woken())

    # The whole study

    async def run(self) -> None:
        """Take people through the study until the window is closed, or the program stopped.

        Raises:
            BadFile: the log or a recording cannot be written, or a text cannot be read.
        """
        await self._host(self._people())

    async def preview(self, participant: str, last: int) -> None:
        """Have a person go through their steps up to the one of this number, and close the window.

        Raises:
            BadFile: as for `run`.
        """
        await self._host(self._steps_until(participant, last))

    async def _host(self, people: Coroutine[object, object, None]) -> None:
        """Keep the window open while people go through something."""
        async with self._window.opened():
            await self._window.send(StudyTexts(GameTexts.of(self._texts)))
            listening = asyncio.create_task(self._listen())
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
            await self._go_through(await self._next_run())

    async def _steps_until(self, participant: str, last: int) -> None:
        self._person = participant
        with contextlib.suppress(_RunOver):
            while self._run.step <= last and await self._begin():
                pass
        self._closed = True

    async def _end(self, *, failed: bool) -> None:
        """Have the window close; where somebody is in the middle of the study, it stays and says so instead."""
        if self._closed or not self._person or self._run.state is not RunState.UNDER_WAY:
            await self._window.send(CloseKiosk())
            return
        text = self._texts.text("kiosk.failed_text" if failed else "kiosk.stopped_text")
        await self._window.send(HostStops(self._texts.text("kiosk.pauses"), text))
        self._window.leave_open()

    async def _listen(self) -> None:
        while True:
            self._heard.put_nowait(await self._window.next_request())

    async def _resume(self) -> None:
        """Go on with whoever was under way when an earlier program died."""
        runs = list(self.progress.runs.values())
        for run in unfinished(self.progress):
            self._person = run.participant
            with contextlib.suppress(_RunOver):
                await self._read(TextToRead(0, *words.headed(self._texts, "restarted")))
            await self._go_through(run.participant, again=True)
        if runs and runs[-1].state is not RunState.UNDER_WAY and not runs[-1].farewell_read:
            self._person = runs[-1].participant
            await self._part(self._person)

    async def _next_run(self) -> str:
        """Wait until the next person begins; their id."""
        await self._send_instructions(None)
        while True:
            place = self.progress.next_place()
            if isinstance(place, NoPlace):
                await self._show(TextToRead(0, *words.no_place(self._texts, place), button="", anew=True))
            elif self._design.file.begins is WhoBegins.RESEARCHER:
                text = self._texts.text("kiosk.welcome_wait")
                await self._show(TextToRead(0, self._texts.text("kiosk.welcome"), text, button="", anew=True))
            else:
                begin = self._texts.text("kiosk.begin")
                await self._show(TextToRead(0, *words.headed(self._texts, "welcome"), button=begin, anew=True))
            message: FromKiosk | _Woken | None = None
            while not (self._admits or isinstance(message, WentOn | BeginNext | _Woken)):
                message = await self._next()
            begins, self._admits = self._admits or not isinstance(message, _Woken), False
            if begins and not isinstance(admitted := self._conductor.admit(), NoPlace):
                return admitted.participant

    async def _go_through(self, participant: str, *, again: bool = False) -> None:
        """Have a person go through all the steps that they have left; `again`: after an earlier program died."""
        self._person = participant
        with contextlib.suppress(_RunOver):
            await self._ask_recruiting_code(again=again)
            while await self._begin():
                pass
        await self._part(participant)

    async def _begin(self) -> bool:
        """Go through the next step; False: there is none."""
        self._check()
        before = self._run
        if before.last_outcome is StepOutcome.FAILED and not before.under_way:
            await self._tell_of_repetition(before)
        ahead = self.progress.next_step(self._person)
        how = resumes(before, ahead) if before.under_way and ahead is not None else None
        step = self._conductor.begin(self._person)
        if step is not None:
            await self._send_instructions(step)
            await self._do(step, how)
            self._conductor.end(self._person, step)
        return step is not None

    async def _send_instructions(self, now: PlannedStep | None) -> None:
        """Send the instructions that the person has read so far, if they are others than before.

        Args:
            now: the step under way, in which instructions for other conditions would mislead; None: nobody takes part.
        """
        read: tuple[PlannedStep, ...] = ()
        if now is not None:
            run = self._run
            read = tuple(
                step
                for step in run.plan
                if step.entry.step is StepKind.INSTRUCTIONS
                and step.number in run.begun
                and step.number != now.number
                and (None in {step.condition, now.condition} or step.condition == now.condition)
                and self.progress.wants(run.participant, step)
            )
        if read != self._instructions:
            self._instructions = read
            await self._window.send(InstructionsSoFar(tuple(InstructionText(*self._text_of(step)) for step in read)))

    async def _do(self, step: PlannedStep, how: ResumeRule | None) -> None:
        """Have a person do what a step asks for; `how` it goes on after a crash, None where it begins."""
        match step.entry.step:
            case StepKind.CONSENT:
                await self._consent(step)
            case StepKind.PRACTICE:
                await self._practice(step)
            case StepKind.TRIAL:
                await self._trial(step, how)
            case StepKind.CHECK | StepKind.FORM:
                await self._form(step)
            case StepKind.INSTRUCTIONS | StepKind.PAUSE | StepKind.DEBRIEF:
                await self._text(step)

    @property
    def _run(self) -> Run:
        return self.progress.runs[self._person]

    async def _part(self, participant: str) -> None:
        """Show the last pages until the person has gone."""
        await self._debrief()
        heading, text = words.farewell(self._texts, self.progress.runs[participant])
        code = self.progress.runs[participant].code
        await self._read_last(TextToRead(0, heading, text, self._texts.text("kiosk.finish"), code=code))
        by: Actor = "experimenter" if self._admits else "participant"
        self._person = ""
        self._conductor.tell_of_run(EventKind.FAREWELL_READ, participant, {}, by)

    async def _debrief(self) -> None:
        """Have a person who left or was excluded read what the study was about."""
        run = self._run
        if self.progress.next_debriefing(self._person) is None:
            return
        if not run.debriefs:
            await self._read_last(TextToRead(0, *words.before_debriefing(self._texts, run)))
        while not self._admits and (step := self._conductor.debrief(self._person)) is not None:
            text, markdown = self._text_of(step)
            heading = self._texts.text("kiosk.before_you_go")
            if await self._read_last(TextToRead(0, heading, text, markdown=markdown)):
                self._conductor.end(self._person, step)

    async def _read_last(self, page: TextToRead) -> bool:
        """Show a page after the end of a run until the person goes on from it; False: the researcher did, for them."""
        if not self._admits:
            await self._show(page)
        message: FromKiosk | _Woken | None = None
        while not (self._admits or isinstance(message, WentOn)):
            message = await self._next()
        return not self._admits

    # Pages

    async def _show(self, page: _Page) -> None:
        """Show a page."""
        await self._window.send(self._numbered(page))

    def _numbered(self, page: _Page) -> _Page:
        """Return a page with the next number, and the person's progress."""
        self._page += 1
        self._shown = words.page(page)
        self.changed()
        return structs.replace(page, page=self._page, progress=self._way)

    @property
    def _way(self) -> StudyProgress:
        run = self.progress.runs.get(self._person)
        if run is None or run.state is not RunState.UNDER_WAY:
            return StudyProgress()
        return StudyProgress(*self.progress.step_count(self._person))

    async def _read(self, page: TextToRead | GameRecorded) -> None:
        """Show a page until the person goes on from it."""
        await self._show(page)
        while not isinstance(await self._next_of_run(), WentOn):
            pass

    async def _next(self) -> FromKiosk | _Woken:
        """Wait for what is said of the page shown, or what changed without the window."""
        while True:
            message = self._taken(await self._heard.get())
            if message is not None:
                return message

    async def _next_of_run(self) -> FromKiosk | _Woken:
        """Wait likewise; raises _RunOver once the person's run has ended."""
        message = await self._next()
        self._check()
        return message

    def _check(self) -> None:
        if self._run.state is not RunState.UNDER_WAY:
            raise _RunOver

    def _taken(self, message: FromKiosk | _Woken) -> FromKiosk | _Woken | None:
        """Take what is the same on all pages; return the rest, but None for what is said of another page."""
        match message:
            case KioskClosed():
                self._closed = True
                raise KioskStopped
            case FocusNews(has_focus, window_ns):
                self._looks_away = not has_focus
                if self._person:
                    kind = EventKind.FOCUS_REGAINED if has_focus else EventKind.FOCUS_LOST
                    self._tell(kind, {"window_ns": window_ns})
                return None
            case InstructionsNews(is_open, window_ns):
                if self._person:
                    kind = EventKind.INSTRUCTIONS_OPENED if is_open else EventKind.INSTRUCTIONS_CLOSED
                    self._tell(kind, {"window_ns": window_ns})
                return None
            case StoppedTakingPart():
                if self._person and self._run.state is RunState.UNDER_WAY:
                    self._conductor.leave(self._person, "stopped taking part")
                return _Woken()
            case BeginNext() | _Woken():
                return message
            case _:
                return message if message.page == self._page else None

    def _tell(self, kind: EventKind, data: Mapping[str, JsonValue]) -> None:
        """Take down what a person did, in the step under way if there is one."""
        step = self.progress.next_step(self._person) if self._run.under_way else None
        if step is None:
            self._conductor.tell_of_run(kind, self._person, data, "participant")
        else:
            self._conductor.tell(kind, self._person, step, data, "participant")

    # Steps

    async def _ask_recruiting_code(self, *, again: bool) -> None:
        ask = self._design.file.recruiting.ask
        if not ask or self._run.recruiting_code is not None:
            return
        asked = FormItem("code", ask, "text", one_line=True)
        instructions = self._texts.text("kiosk.code_not_kept") if again else ""
        page = FormToFill(0, self._texts.text("kiosk.recruiting"), instructions, (asked,))
        await self._show(page)
        code = ""
        while True:
            match await self._next_of_run():
                case ItemNews(what="changed" | "given", answer=answer):
                    code = answer.strip() if isinstance(answer, str) else ""
                    # Where the window crashes, the one that is opened in its place has it.
                    await self._window.send(AnswerKept(self._page, asked.id, answer))
                case WentOn() if code:
                    break
                case WentOn():
                    await self._show(structs.replace(page, missing=(asked.id,)))
        self._conductor.tell_of_run(EventKind.RECRUITING_CODE, self._person, {"code": code}, "participant")

    async def _tell_of_repetition(self, run: Run) -> None:
        """Tell somebody who failed a check that it comes again; nothing where it does not."""
        check = next((step for step in run.plan[run.step - 1 :] if step.number in run.attempts), None)
        if check is None or check.number in run.failed:
            return
        named = run.plan[run.step - 1]
        first = None if named.number == check.number else named.entry.step
        text = words.repetition(self._texts, first, check.entry.attempts - run.attempts[check.number])
        await self._read(TextToRead(0, self._texts.text("kiosk.once_more"), text))

    async def _text(self, step: PlannedStep) -> None:
        text, markdown = self._text_of(step)
        heading = "" if markdown else words.step_heading(self._texts, step.entry.step)
        await self._read(TextToRead(0, heading, text, markdown=markdown))

    def _text_of(self, step: PlannedStep) -> tuple[str, bool]:
        """Return what is read in a step, and whether it is Markdown."""
        if step.entry.text is None:
            return self._texts.text("kiosk.pause_text"), False
        path = self._design.path.parent / step.entry.text
        text = read_text(path)
        if step.entry.step is StepKind.DEBRIEF and step.entry.results:
            games = results_of(self._design, SettingCache(self._design.beside), self._run)
            text = "\n\n".join(filter(None, (text.rstrip(), words.results(self._texts, games))))
        return text, path.suffix == ".md"

    async def _consent(self, step: PlannedStep) -> None:
        if self._run.agrees is None:
            path = self._design.path.parent / (step.entry.text or Path())
            content = read_bytes(path)
            await self._show(ConsentToAsk(0, text_of(path, content), path.suffix == ".md"))
            message: FromKiosk | _Woken | None = None
            while not isinstance(message, ConsentReply):
                message = await self._next_of_run()
            version = hashlib.sha256(content).hexdigest()
            data: dict[str, JsonValue] = {"agrees": message.agrees, "version": version, "window_ns": message.window_ns}
            self._tell(EventKind.CONSENT_ANSWERED, data)
        if not self._run.agrees:
            self._conductor.leave(self._person, "did not agree", declined=True)
            raise _RunOver

    async def _form(self, step: PlannedStep) -> None:
        """Have a form filled in, from the first page that is not; people go back as far as its first page.

        Nobody comes back to an item with a time limit: it is closed once they have left it.
        """
        form = self._conductor.form(step)
        pages = list(form.pages(self._design.file.seed, self._person))
        part = next((part for part, items in enumerate(pages, start=1) if self._is_open(items)), len(pages) + 1)
        while part <= len(pages):
            items = pages[part - 1]
            before = next((page for page in range(part - 1, 0, -1) if not _is_limited(pages[page - 1])), 0)
            is_closed = _is_limited(items) and not self._is_open(items)
            if is_closed or await self._fill_in(form, items, part, len(pages), back=before > 0):
                part += 1
            else:
                part = before
                self._tell(EventKind.WENT_BACK, {"page": part})

    def _is_open(self, items: tuple[Item, ...]) -> bool:
        """Return True where something of a page is not answered, or changed and not given since."""
        given, drafts = self._run.given, self._run.drafts
        return any(item.id not in given or item.id in drafts or self._is_missing(item) for item in items)

    def _is_missing(self, item: Item) -> bool:
        """Return True where an item still has to be answered."""
        run = self._run
        return item.required and run.given.get(item.id) is None and item.id not in run.timed_out

    async def _fill_in(self, form: Form, items: tuple[Item, ...], part: int, parts: int, *, back: bool) -> bool:
        """Have a page of a form filled in; False: the person goes back to the one before, whatever is answered here.

        What nobody need answer gets no answer in the end, which is one, too.
        """
        shown, missing = tuple(map(form_item, items)), tuple[str, ...]()
        leaves = (WentOn, WentBack) if back else (WentOn,)
        while True:
            kept = {**self._run.given, **self._run.drafts}
            answers = {item.id: to_answer(kept[item.id]) for item in items if item.id in kept}
            closed = tuple(item.id for item in items if item.id in self._run.timed_out)
            page = FormToFill(0, form.title, form.instructions, shown, answers, closed, missing, part, parts, back=back)
            await self._show(page)
            while not isinstance(message := await self._next_of_run(), leaves):
                if isinstance(message, ItemNews):
                    await self._take(items, message)
            for item in items:
                if item.id in self._run.drafts:
                    self._tell(EventKind.ITEM_GIVEN, {"item": item.id, "answer": self._run.drafts[item.id]})
            if isinstance(message, WentBack):
                return False
            missing = tuple(item.id for item in items if self._is_missing(item))
            if not missing:
                for item in items:
                    if item.id not in self._run.given:
                        self._tell(EventKind.ITEM_GIVEN, {"item": item.id, "answer": None})
                return True

    async def _take(self, items: tuple[Item, ...], news: ItemNews) -> None:
        """Take down what happened with an item."""
        item = next((item for item in items if item.id == news.item), None)
        if item is None or item.id in self._run.timed_out:
            return
        if news.what in {"changed", "given", "timed out"} and not is_answer(item, news.answer):
            return
        data: dict[str, JsonValue] = {"item": item.id, "window_ns": news.window_ns}
        run, answer = self._run, to_json(news.answer)
        match news.what:
            case "shown":
                self._tell(EventKind.ITEM_SHOWN, {**data, **options_shown(item)})
            case "touched":
                self._tell(EventKind.ITEM_TOUCHED, data)
            case "pasted":
                self._tell(EventKind.TEXT_PASTED, {**data, "characters": news.characters})
            case "changed":
                if answer != {**run.given, **run.drafts}.get(item.id):
                    self._tell(EventKind.ITEM_CHANGED, {**data, "answer": answer})
                await self._window.send(AnswerKept(self._page, item.id, news.answer))
            case "given":
                if item.id in run.drafts or answer != run.given.get(item.id):
                    self._tell(EventKind.ITEM_GIVEN, {**data, "answer": answer})
                await self._window.send(AnswerKept(self._page, item.id, news.answer))
            case "timed out" if item.seconds > 0.0:
                self._tell(EventKind.ITEM_TIMED_OUT, {**data, "answer": answer})
                await self._window.send(AnswerKept(self._page, item.id, news.answer, timed_out=True))

    async def _practice(self, step: PlannedStep) -> None:
        """Have practice played until all is done that its step asks for, or it was played often enough."""
        for game in range(MOST_PRACTICE):
            await self._show(GamePrepared(0, self._texts.text("kiosk.practice_comes")))
            visit = _Visit(self, practice=True)
            done = await self._at_game(visit, self._games.practise(self._run, step, visit))
            self._conductor.tell(EventKind.PRACTICE_PLAYED, self._person, step, done.data, "program")
            if not visit.went_on:
                ended = self._texts.text("kiosk.practice_ended")
                await self._read_result(visit, GameRecorded(0, ended, words.result(self._texts, None)))
            if not done.missing:
                return
            if game + 1 < MOST_PRACTICE:
                text = words.practice_again(self._texts, words.to_do(self._texts, done.missing))
                await self._read(TextToRead(0, self._texts.text("kiosk.once_more"), text))

    async def _trial(self, step: PlannedStep, how: ResumeRule | None) -> None:
        visit = _Visit(self, practice=False)
        if self._run.game is None:
            goes_on = how is ResumeRule.EXACT
            told = "kiosk.game_comes_back" if goes_on else "kiosk.game_comes"
            await self._show(GamePrepared(0, self._texts.text(told)))
            game = await self._at_game(visit, self._games.play(self._run, step, visit, goes_on=goes_on))
            if game is not None:
                self._conductor.tell(EventKind.GAME_PLAYED, self._person, step, game, "program")
        if not visit.went_on:
            text = words.result(self._texts, self._run.game)
            await self._read_result(visit, GameRecorded(0, self._texts.text("kiosk.game_ended"), text))

    async def _at_game(self, visit: "_Visit", game: Coroutine[object, object, PlayedT]) -> PlayedT:
        """Play a game to its end, unless the run or the program ends before."""
        try:
            played = await game
        except ParticipantDeclined as declined:
            visit.check()
            if declined.answered:
                self._conductor.leave(self._person, "did not agree", declined=True)
            raise _RunOver from None
        finally:
            self._clock.simulated = None
            self._note_lag(0.0)
            await visit.done()
        visit.check()
        return played

    async def _read_result(self, visit: "_Visit", result: GameRecorded) -> None:
        """Show that a game has ended until the person goes on; the window may show its end already, on its page."""
        if visit.page != self._page or visit.page == 0:
            await self._read(result)
            return
        await self._window.send(structs.replace(result, page=self._page, progress=self._way))
        while not isinstance(await self._next_of_run(), WentOn):
            pass


class _Visit:
    """A person at one game; see `GameWatcher` for the methods."""

    def __init__(self, host: KioskHost, practice: bool) -> None:
        self._host = host
        self._practice = practice
        self._sending: list[asyncio.Task[None]] = []
        self._stopped: KioskStopped | None = None
        self._seen_end = False
        self._news = GameNews(0, -1)
        self._to_do: tuple[str, ...] = ()
        self.page = 0
        """Number of the game's page; 0: it was not shown."""
        self.went_on = False
        """True once the person has gone on from the game."""

    def ready(self, where: ListeningAddress) -> None:
        host = self._host
        agreed_at = "" if self._practice else host._run.agreed_at
        address = WILDCARD_ADDRESSES.get(where.host, where.host)
        self.page = self._send(
            GameToJoin(0, address, where.port, host._token, self._practice, agreed_at, to_do=self._to_do)
        )

    def passed(self, seconds: float, lag: float, left: float) -> None:
        self._host._clock.simulated = None if self._practice else seconds
        self._host._note_lag(lag)
        news = GameNews(self.page, max(math.ceil(left), 0), self._to_do)
        if self.page != 0 and news != self._news:
            self._news = news
            self._say(news)

    def still_to_do(self, missing: Mapping[PracticeTerm, float]) -> None:
        self._to_do = words.to_do(self._host._texts, missing)

    def time_is_up(self) -> None:
        self._send(GamePrepared(0, self._host._texts.text("kiosk.time_is_up")))

    def has_left(self) -> bool:
        host = self._host
        try:
            while not host._heard.empty():
                match host._taken(host._heard.get_nowait()):
                    case GameSeenOver():
                        self._seen_end = True
                    case WentOn():
                        self.went_on = self._seen_end or not self._to_do
        except KioskStopped as stopped:
            self._stopped = stopped
        return self.went_on or self._stopped is not None or host._run.state is not RunState.UNDER_WAY

    def has_seen_end(self) -> bool:
        return self._seen_end

    def broken_off(self, bag: Path | None) -> None:
        name = None if bag is None else bag.name
        self._host._tell(EventKind.GAME_BROKEN_OFF, {"bag": name})

    def cut_off(self, bag: Path) -> None:
        if bag.name not in self._host._run.cut_off:
            self._host._tell(EventKind.RECORDING_CUT_OFF, {"bag": bag.name})

    def check(self) -> None:
        """Raise what has ended more than the game."""
        if self._stopped is not None:
            raise self._stopped
        self._host._check()

    async def done(self) -> None:
        """Wait until all is sent."""
        await asyncio.gather(*self._sending, return_exceptions=True)

    def _send(self, page: _Page) -> int:
        """Show a page soon; its number, which counts at once."""
        shown = self._host._numbered(page)
        self._say(shown)
        return shown.page

    def _say(self, message: ToKiosk) -> None:
        self._sending = [task for task in self._sending if not task.done()]
        self._sending.append(asyncio.get_running_loop().create_task(self._host._window.send(message)))


def _is_limited(items: tuple[Item, ...]) -> bool:
    """Return True for the page of an item with a time limit."""
    return any(item.seconds > 0.0 for item in items)


def _ignore() -> None:
    """Do nothing."""

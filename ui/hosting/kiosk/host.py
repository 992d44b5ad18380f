"""Host of the kiosk: shows pages one after the other, and logs all actions of the person at once.

The host's only state is the log. After a crash, the host resumes with the same person at the same step.
"""

import asyncio
import contextlib
from collections.abc import Coroutine

from msgspec import structs

from thbridge.app.compose.setting import texts_of
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor, unfinished
from thbridge.experiment.design.experiment_file import ExperimentDesign, WhoBegins
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import ResumeRule, StepKind
from thbridge.experiment.progress import Run, resumes
from thbridge.experiment.store.events import Actor, EventKind, RunState, StepOutcome
from thbridge.files.errors import BadFile
from thbridge.roles.shared.notices import GameTexts
from ui.hosting.kiosk import words
from ui.hosting.kiosk.form_steps import FormSteps
from ui.hosting.kiosk.game_steps import GamesOfStudy, GameSteps, StudyClock
from ui.hosting.kiosk.games import KioskStopped
from ui.hosting.kiosk.hosted_study import HostedStudy
from ui.hosting.kiosk.pages import KioskPages, RunOver, WindowOfKiosk, Woken
from ui.hosting.kiosk.text_steps import TextSteps
from ui.model.kiosk import (
    BeginNext,
    CloseKiosk,
    FormItem,
    FormToFill,
    FromKiosk,
    HostStops,
    ItemNews,
    StudyTexts,
    TextToRead,
    WentOn,
)


class KioskHost:
    """Host that leads one person after the other through a study.

    Args:
        design: design of the study.
        conductor: conductor of the study, which uses `clock`.
        window: window of the kiosk; it is opened here.
        games: player of the games.
        clock: clock of the log's events.

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
    ) -> None:
        self._design = design
        self._texts = texts_of(design.study, design.beside)
        self._conductor = conductor
        self._window = window
        self._pages = KioskPages(conductor, window, self._texts)
        self._text_steps = TextSteps(design, conductor, self._pages)
        self._form_steps = FormSteps(design, self._pages)
        self._game_steps = GameSteps(conductor, self._pages, games, clock)
        self.study = HostedStudy(conductor, self._pages)

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
            await self._go_through(await self._next_run())

    async def _steps_until(self, participant: str, last: int) -> None:
        self._pages.person = participant
        with contextlib.suppress(RunOver):
            while self._pages.run.step <= last and await self._begin():
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
        """Resume the run that was in progress when an earlier program crashed."""
        runs = list(self._conductor.progress.runs.values())
        for run in unfinished(self._conductor.progress):
            self._pages.person = run.participant
            with contextlib.suppress(RunOver):
                await self._pages.read(TextToRead(0, *words.headed(self._texts, "restarted")))
            await self._go_through(run.participant, again=True)
        if runs and runs[-1].state is not RunState.UNDER_WAY and not runs[-1].farewell_read:
            self._pages.person = runs[-1].participant
            await self._part(self._pages.person)

    async def _next_run(self) -> str:
        """Wait until the next person begins; return their id."""
        await self._text_steps.send_instructions(None)
        while True:
            place = self._conductor.progress.next_place()
            if isinstance(place, NoPlace):
                await self._pages.show(TextToRead(0, *words.no_place(self._texts, place), button="", anew=True))
            elif self._design.file.begins is WhoBegins.RESEARCHER:
                text = self._texts.text("kiosk.welcome_wait")
                await self._pages.show(TextToRead(0, self._texts.text("kiosk.welcome"), text, button="", anew=True))
            else:
                begin = self._texts.text("kiosk.begin")
                await self._pages.show(TextToRead(0, *words.headed(self._texts, "welcome"), button=begin, anew=True))
            message: FromKiosk | Woken | None = None
            while not (self._pages.admits or isinstance(message, WentOn | BeginNext | Woken)):
                message = await self._pages.next()
            begins, self._pages.admits = self._pages.admits or not isinstance(message, Woken), False
            if begins and not isinstance(admitted := self._conductor.admit(), NoPlace):
                return admitted.participant

    async def _go_through(self, participant: str, *, again: bool = False) -> None:
        """Lead a person through all remaining steps; `again` is True after a crash of an earlier program."""
        self._pages.person = participant
        with contextlib.suppress(RunOver):
            await self._ask_recruiting_code(again=again)
            while await self._begin():
                pass
        await self._part(participant)

    async def _begin(self) -> bool:
        """Run the next step; return False if no step is left."""
        self._pages.check()
        before = self._pages.run
        if before.last_outcome is StepOutcome.FAILED and not before.under_way:
            await self._show_repetition(before)
        ahead = self._conductor.progress.next_step(self._pages.person)
        how = resumes(before, ahead) if before.under_way and ahead is not None else None
        step = self._conductor.begin(self._pages.person)
        if step is not None:
            await self._text_steps.send_instructions(step)
            await self._do(step, how)
            self._conductor.end(self._pages.person, step)
        return step is not None

    async def _do(self, step: PlannedStep, how: ResumeRule | None) -> None:
        """Run a step. After a crash, `how` is the rule for resuming the step; if None, begin the step."""
        match step.entry.step:
            case StepKind.CONSENT:
                await self._text_steps.consent(step)
            case StepKind.PRACTICE:
                await self._game_steps.practise(step)
            case StepKind.TRIAL:
                await self._game_steps.play(step, how)
            case StepKind.CHECK | StepKind.FORM:
                await self._form_steps.fill_in(step)
            case StepKind.INSTRUCTIONS | StepKind.PAUSE | StepKind.DEBRIEF:
                await self._text_steps.read(step)

    async def _part(self, participant: str) -> None:
        """Show the last pages, and record that the person has left."""
        await self._debrief()
        heading, text = words.farewell(self._texts, self._conductor.progress.runs[participant])
        code = self._conductor.progress.runs[participant].code
        await self._read_last(TextToRead(0, heading, text, self._texts.text("kiosk.finish"), code=code))
        by: Actor = "experimenter" if self._pages.admits else "participant"
        self._pages.person = ""
        self._conductor.tell_of_run(EventKind.FAREWELL_READ, participant, {}, by)

    async def _debrief(self) -> None:
        """Show the debriefing to a person who left or was excluded."""
        run = self._pages.run
        if self._conductor.progress.next_debriefing(self._pages.person) is None:
            return
        if not run.debriefs:
            await self._read_last(TextToRead(0, *words.before_debriefing(self._texts, run)))
        while not self._pages.admits and (step := self._conductor.debrief(self._pages.person)) is not None:
            text, markdown = self._text_steps.content(step)
            heading = self._texts.text("kiosk.before_you_go")
            if await self._read_last(TextToRead(0, heading, text, markdown=markdown)):
                self._conductor.end(self._pages.person, step)

    async def _read_last(self, page: TextToRead) -> bool:
        """Show a page after the end of a run. Return True if the person continued, False if the researcher did."""
        if not self._pages.admits:
            await self._pages.show(page)
        message: FromKiosk | Woken | None = None
        while not (self._pages.admits or isinstance(message, WentOn)):
            message = await self._pages.next()
        return not self._pages.admits

    async def _ask_recruiting_code(self, *, again: bool) -> None:
        ask = self._design.file.recruiting.ask
        if not ask or self._pages.run.recruiting_code is not None:
            return
        asked = FormItem("code", ask, "text", one_line=True)
        instructions = self._texts.text("kiosk.code_not_kept") if again else ""
        page = FormToFill(0, self._texts.text("kiosk.recruiting"), instructions, (asked,))
        await self._pages.show(page)
        code = ""
        while True:
            match await self._pages.next_of_run():
                case ItemNews(what="changed" | "given", answer=answer):
                    code = answer.strip() if isinstance(answer, str) else ""
                    # If the window crashes, the new window receives the answer from here.
                    await self._pages.kept(asked.id, answer)
                case WentOn() if code:
                    break
                case WentOn():
                    await self._pages.show(structs.replace(page, missing=(asked.id,)))
        self._conductor.tell_of_run(EventKind.RECRUITING_CODE, self._pages.person, {"code": code}, "participant")

    async def _show_repetition(self, run: Run) -> None:
        """If a failed check is repeated, inform the person about this. Otherwise, do nothing."""
        check = next((step for step in run.plan[run.step - 1 :] if step.number in run.attempts), None)
        if check is None or check.number in run.failed:
            return
        named = run.plan[run.step - 1]
        first = None if named.number == check.number else named.entry.step
        text = words.repetition(self._texts, first, check.entry.attempts - run.attempts[check.number])
        await self._pages.read(TextToRead(0, self._texts.text("kiosk.once_more"), text))

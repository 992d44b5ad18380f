"""Course of a person through a study: page by page, from the first step to the last page."""

import contextlib

from msgspec import structs

from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.recruiting import ending_of
from thbridge.experiment.design.steps import ResumeRule, StepKind
from thbridge.experiment.progress import Run, resumes
from thbridge.experiment.store.events import Actor, EventKind, StepOutcome
from ui.hosting.kiosk import words
from ui.hosting.kiosk.form_steps import FormSteps
from ui.hosting.kiosk.game_steps import GamesOfStudy, GameSteps, StudyClock
from ui.hosting.kiosk.pages import KioskPages, RunOver, StepOver, Woken
from ui.hosting.kiosk.text_steps import TextSteps
from ui.model.kiosk import FormItem, FormToFill, FromKiosk, ItemNews, TextToRead, WentOn


class StudyCourse:
    """Program that takes a person through the steps of a study; at the kiosk, one person after the other.

    Args:
        design: design of the study.
        conductor: conductor of the study, which uses `clock`.
        pages: pages of the person's window.
        games: player of the games.
        clock: clock of the log's events.

    Attributes:
        text_steps: steps with texts.
    """

    def __init__(
        self, design: ExperimentDesign, conductor: Conductor, pages: KioskPages, games: GamesOfStudy, clock: StudyClock
    ) -> None:
        self._design = design
        self._texts: Texts = pages.texts
        self._conductor = conductor
        self._pages = pages
        self.text_steps = TextSteps(design, conductor, pages)
        self._form_steps = FormSteps(design, pages)
        self._game_steps = GameSteps(conductor, pages, games, clock)

    async def go_through(self, participant: str, *, again: bool = False) -> None:
        """Take a person through all remaining steps; `again` is True after an earlier program crashed."""
        self._pages.person = participant
        with contextlib.suppress(RunOver):
            await self._ask_recruiting_code(again=again)
            while await self.begin():
                pass
        await self.part(participant)

    async def begin(self) -> bool:
        """Run the next step; return False if there is none."""
        self._pages.check()
        before = self._pages.run
        if before.last_outcome is StepOutcome.FAILED and not before.under_way:
            await self._show_repetition(before)
        ahead = self._conductor.progress.next_step(self._pages.person)
        how = resumes(before, ahead) if before.under_way and ahead is not None else None
        step = self._conductor.begin(self._pages.person)
        if step is not None:
            await self.text_steps.send_instructions(step)
            with contextlib.suppress(StepOver):
                await self._do(step, how)
                self._conductor.end(self._pages.person, step)
        return step is not None

    async def _do(self, step: PlannedStep, how: ResumeRule | None) -> None:
        """Run a step. After a crash, `how` says how the step resumes; if None, the step begins."""
        match step.entry.step:
            case StepKind.CONSENT:
                await self.text_steps.consent(step)
            case StepKind.PRACTICE:
                await self._game_steps.practise(step)
            case StepKind.TRIAL:
                await self._game_steps.play(step, how)
            case StepKind.CHECK | StepKind.FORM:
                await self._form_steps.fill_in(step)
            case StepKind.INSTRUCTIONS | StepKind.PAUSE | StepKind.DEBRIEF:
                await self.text_steps.read(step)

    async def part(self, participant: str) -> None:
        """Show the last pages, and record that the person has left."""
        await self._debrief()
        run = self._conductor.progress.runs[participant]
        finish, ending = self._texts.text("kiosk.finish"), self.ending(run)
        await self._read_last(TextToRead(0, *words.farewell(self._texts, run), finish, code=run.code, ending=ending))
        by: Actor = "experimenter" if self._pages.admits else "participant"
        self._pages.person = ""
        self._conductor.tell_of_run(EventKind.FAREWELL_READ, participant, {}, by)

    def ending(self, run: Run) -> str:
        """Return the address or the completion code of the recruiting service for an ended run; may be empty."""
        return "" if run.ending is None else ending_of(self._design.file.recruiting, run.ending, run.parameters)

    async def _debrief(self) -> None:
        """Show the debriefing to a person who left or was excluded."""
        run = self._pages.run
        if self._conductor.progress.next_debriefing(self._pages.person) is None:
            return
        if not run.debriefs:
            await self._read_last(TextToRead(0, *words.before_debriefing(self._texts, run)))
        while not self._pages.admits and (step := self._conductor.debrief(self._pages.person)) is not None:
            text, markdown = self.text_steps.content(step)
            heading = self._texts.text("kiosk.before_you_go")
            if await self._read_last(TextToRead(0, heading, text, markdown=markdown)):
                self._conductor.end(self._pages.person, step)

    async def _read_last(self, page: TextToRead) -> bool:
        """Show a page after the end of a run. Return True if the person continued, and False if the researcher did."""
        if not self._pages.admits:
            await self._pages.show(page)
        message: FromKiosk | Woken | None = None
        while not (self._pages.admits or isinstance(message, WentOn)):
            message = await self._pages.next()
        return not self._pages.admits

    async def _ask_recruiting_code(self, *, again: bool) -> None:
        ask = self._design.file.recruiting.ask
        run = self._pages.run
        if not ask or run.recruiting_code is not None or run.external_id:
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
        """Show a person who failed a check that the check is repeated; do nothing if it is not."""
        check = next((step for step in run.plan[run.step - 1 :] if step.number in run.attempts), None)
        if check is None or check.number in run.failed:
            return
        named = run.plan[run.step - 1]
        first = None if named.number == check.number else named.entry.step
        text = words.repetition(self._texts, first, check.entry.attempts - run.attempts[check.number])
        await self._pages.read(TextToRead(0, self._texts.text("kiosk.once_more"), text))

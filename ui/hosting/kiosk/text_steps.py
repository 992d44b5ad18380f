"""Steps of a study in which people read texts at the kiosk; the texts are in files of the study."""

import hashlib
from pathlib import Path

from thbridge.batch.settings import SettingCache
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.store.events import EventKind, JsonValue
from thbridge.experiment.trials import results_of
from thbridge.files.disk.text_files import read_bytes, read_text, text_of
from ui.hosting.kiosk import words
from ui.hosting.kiosk.pages import KioskPages, RunOver, Woken
from ui.model.kiosk import (
    ConsentReply,
    ConsentToAsk,
    FromKiosk,
    InstructionsSoFar,
    InstructionText,
    TextToRead,
)


class TextSteps:
    """Steps in which the person at the kiosk reads texts.

    Args:
        design: design of the study.
        conductor: conductor of the study.
        pages: pages of the kiosk.
    """

    def __init__(self, design: ExperimentDesign, conductor: Conductor, pages: KioskPages) -> None:
        self._design = design
        self._conductor = conductor
        self._pages = pages
        self._instructions: tuple[PlannedStep, ...] = ()

    async def read(self, step: PlannedStep) -> None:
        """Show the text of a step until the person continues."""
        text, markdown = self.content(step)
        heading = "" if markdown else words.step_heading(self._pages.texts, step.entry.step)
        await self._pages.read(TextToRead(0, heading, text, markdown=markdown))

    def content(self, step: PlannedStep) -> tuple[str, bool]:
        """Return the text of a step, and True if it is Markdown."""
        if step.entry.text is None:
            return self._pages.texts.text("kiosk.pause_text"), False
        path = self._design.path.parent / step.entry.text
        text = read_text(path)
        if step.entry.step is StepKind.DEBRIEF and step.entry.results:
            games = results_of(self._design, SettingCache(self._design.beside), self._pages.run)
            text = "\n\n".join(filter(None, (text.rstrip(), words.results(self._pages.texts, games))))
        return text, path.suffix == ".md"

    async def consent(self, step: PlannedStep) -> None:
        """Show a consent text until the person answers; raise RunOver if the person does not agree."""
        if self._pages.run.agrees is None:
            path = self._design.path.parent / (step.entry.text or Path())
            content = read_bytes(path)
            await self._pages.show(ConsentToAsk(0, text_of(path, content), path.suffix == ".md"))
            message: FromKiosk | Woken | None = None
            while not isinstance(message, ConsentReply):
                message = await self._pages.next_of_run()
            version = hashlib.sha256(content).hexdigest()
            data: dict[str, JsonValue] = {"agrees": message.agrees, "version": version, "window_ns": message.window_ns}
            self._pages.tell(EventKind.CONSENT_ANSWERED, data)
        if not self._pages.run.agrees:
            self._conductor.leave(self._pages.person, "did not agree", declined=True)
            raise RunOver

    async def send_instructions(self, now: PlannedStep | None) -> None:
        """Send the instructions that the person has read so far, if they changed.

        Args:
            now: current step. Instructions for other conditions are left out, because they would mislead. If None, no
                person takes part.
        """
        read: tuple[PlannedStep, ...] = ()
        if now is not None:
            run = self._pages.run
            read = tuple(
                step
                for step in run.plan
                if step.entry.step is StepKind.INSTRUCTIONS
                and step.number in run.begun
                and step.number != now.number
                and (None in {step.condition, now.condition} or step.condition == now.condition)
                and self._conductor.progress.wants(run.participant, step)
            )
        if read != self._instructions:
            self._instructions = read
            await self._pages.window.send(
                InstructionsSoFar(tuple(InstructionText(*self.content(step)) for step in read))
            )

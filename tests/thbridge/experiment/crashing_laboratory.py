"""A laboratory whose program dies now and then."""

import itertools
import random
from pathlib import Path

from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.events import Clocks, EventKind


class CrashingLaboratory:
    """A laboratory in which programs die now and then."""

    def __init__(self, design: ExperimentDesign, path: Path, seed: int) -> None:
        self._design, self._path = design, path
        self._ticks = itertools.count()
        self.chance = random.Random(seed)
        self.restart()

    def restart(self) -> None:
        """A new program opens the log; what the one before has said is on the disk."""
        self.log = ExperimentLog(self._path)
        self.conductor = Conductor(self._design, self.log, self._now, self.chance.randrange)

    def _now(self) -> Clocks:
        return Clocks("2026-01-02T12:00:00Z", next(self._ticks))

    def crash(self) -> None:
        self.log.close()
        self.restart()

    def answer(self, participant: str, step) -> None:
        """Answer the items of a form that have no answer yet, with crashes between."""
        for item in self.conductor.form(step).order(self._design.file.seed, participant):
            if item.id in self.conductor.progress.runs[participant].given:
                continue
            right = item.correct or (item.options[0] if item.options else float(item.least))
            answer = right if self.chance.random() < 0.6 else "they"
            self.conductor.tell(EventKind.ITEM_SHOWN, participant, step, {"item": item.id}, "program")
            self.conductor.tell(
                EventKind.ITEM_GIVEN, participant, step, {"item": item.id, "answer": answer}, "participant"
            )
            if self.chance.random() < 0.05:
                self.crash()

    def run(self, participant: str) -> None:
        while (step := self.conductor.begin(participant)) is not None:
            if self.chance.random() < 0.1:
                self.crash()
                continue
            if step.entry.step in {StepKind.FORM, StepKind.CHECK}:
                self.answer(participant, step)
                if self.conductor.progress.runs[participant].step != step.number:
                    continue
            if step.entry.step is StepKind.TRIAL and self.chance.random() < 0.05:
                self.conductor.leave(participant, "went home")
                return
            self.conductor.end(participant, step)

"""Rehearsals: simulated people go through a whole experiment, with answers, errors and drop-outs drawn from a seed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim.numerics import noise
from thbridge.app.compose.recording import build_writer
from thbridge.batch.hunt import play_hunt
from thbridge.batch.settings import SettingCache
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.progress import EventKind, Run
from thbridge.experiment.questionnaires.form import MEASURED, Item, Scale
from thbridge.experiment.questionnaires.scoring import NOT_APPLICABLE
from thbridge.experiment.store.events import JsonValue
from thbridge.experiment.trials import played, setting_of_trial


@dataclass(frozen=True, slots=True)
class Rehearsed:
    """Character of simulated people.

    Attributes:
        drop_out: probability that a person leaves in a step.
        wrong: probability of a wrong answer in a check.
        not_applicable: probability of answering so, where an item allows it.
        spread: standard deviation of answers, as a share of their scale.
        effects: shift of scores, as a share of their scale, by the names of subscale and condition.
        plays: True when games are played; else trials end at once.
    """

    drop_out: float = 0.02
    wrong: float = 0.15
    not_applicable: float = 0.02
    spread: float = 0.15
    effects: Mapping[tuple[str, str], float] = field(default_factory=dict)
    plays: bool = True


class Rehearsal:
    """A rehearsal of one experiment.

    Args:
        design: the experiment.
        people: what they are like.
        seed: all that they do follows from it.
        bag_of: place for the recording of a person's step.
        root: the folder that paths of recordings are relative to.
    """

    def __init__(
        self,
        design: ExperimentDesign,
        people: Rehearsed,
        seed: int,
        bag_of: Callable[[str, int], Path],
        root: Path,
    ) -> None:
        self._design = design
        self._people = people
        self._seed = seed
        self._stream = noise.key(seed, "experiment", "rehearsal")
        self._drawn = 0
        self._bag_of = bag_of
        self._root = root
        self._settings = SettingCache(design.beside)

    def run(self, conductor: Conductor) -> NoPlace:
        """Have people take part until there is no place left; return why there is none."""
        conductor.rehearse(self._seed)
        while True:
            # Whoever was under way when an earlier program died comes first.
            for run in list(conductor.progress.runs.values()):
                self.take_part(conductor, run)
            admitted = conductor.admit()
            if isinstance(admitted, NoPlace):
                return admitted

    def take_part(self, conductor: Conductor, run: Run) -> None:
        """Go through all steps that a person has left."""
        person = run.participant
        while (step := conductor.begin(person)) is not None:
            if self._draw() < self._people.drop_out:
                conductor.leave(person, "left in a rehearsal")
                return
            if step.entry.step in {StepKind.FORM, StepKind.CHECK}:
                self._fill_in(conductor, person, step)
            elif step.entry.step in {StepKind.TRIAL, StepKind.PRACTICE} and self._people.plays:
                self._play(conductor, person, step)
            conductor.end(person, step)

    def _fill_in(self, conductor: Conductor, person: str, step: PlannedStep) -> None:
        form = conductor.form(step)
        # People have manners of their own, which they keep from condition to condition.
        manner = _normal(noise.key(self._seed, "experiment", "manner", person, step.name))
        for item in form.order(self._design.file.seed, person):
            if item.id in conductor.progress.runs[person].given:
                continue
            named: dict[str, JsonValue] = {"item": item.id}
            conductor.tell(EventKind.ITEM_SHOWN, person, step, named, "program")
            conductor.tell(EventKind.ITEM_TOUCHED, person, step, named, "participant")
            answer = self._answer(item, self._condition(step), manner)
            conductor.tell(EventKind.ITEM_GIVEN, person, step, {**named, "answer": answer}, "participant")

    def _answer(self, item: Item, condition: str, manner: float) -> JsonValue:
        people = self._people
        if item.correct is not None and self._draw() >= people.wrong:
            return item.correct
        if item.not_applicable and self._draw() < people.not_applicable:
            return NOT_APPLICABLE
        match item.scale:
            case Scale.CHOICE:
                return item.options[int(self._draw() * len(item.options))]
            case Scale.TEXT:
                return "an answer of a rehearsal"
        width = item.greatest - item.least
        shift = people.effects.get((item.subscale, condition), 0.0)
        # Items within a person differ as much as people do.
        self._drawn += 1
        own = _normal(self._stream, self._drawn)
        share = 0.5 + shift + people.spread * 0.7071 * (manner + own)
        value = item.least + width * min(1.0, max(0.0, share))
        if item.reverse:
            value = item.least + item.greatest - value
        step = item.step if item.scale in {Scale.ANALOGUE, Scale.NUMBER} else 1.0
        steps = round((value - item.least) / step) if step > 0.0 else 0
        return item.least + steps * step if item.scale in MEASURED and step > 0.0 else value

    def _play(self, conductor: Conductor, person: str, step: PlannedStep) -> None:
        setting = setting_of_trial(self._design, self._settings, conductor.progress.runs[person], step)
        if setting is None:
            return
        bag = self._bag_of(person, step.number)
        bag.parent.mkdir(parents=True, exist_ok=True)
        bag.unlink(missing_ok=True)
        with build_writer(setting, bag) as writer:
            measures = play_hunt(setting, step.entry.max_seconds, [writer])
        data = played(measures, bag, self._root)
        conductor.tell(EventKind.GAME_PLAYED, person, step, data, "program")

    def _condition(self, step: PlannedStep) -> str:
        return "" if step.condition is None else self._design.conditions[step.condition].name

    def _draw(self) -> float:
        self._drawn += 1
        return float(noise.uniform(self._stream, self._drawn, 0))


def _normal(stream: np.uint64, tick: int = 0) -> float:
    """A number whose mean is 0 and variance 1: the sum of twelve draws, less six (Irwin and Hall)."""
    return sum(float(noise.uniform(stream, tick, index)) for index in range(12)) - 6.0

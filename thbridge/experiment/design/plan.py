"""The steps of one person: the steps of the file, repeated for each condition in the person's order."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from thbridge.experiment.allocation.places import Place
from thbridge.experiment.design.experiment_file import ExperimentDesign, name_of
from thbridge.experiment.design.steps import StepEntry, StepKind
from thbridge.study.study_file import Study


@dataclass(frozen=True, slots=True)
class PlannedStep:
    """A step in the plan of a person.

    Attributes:
        number: number of the step in the person's order, from 1.
        index: index of the step in the file.
        entry: the step in the file.
        name: name of the step in the file.
        condition: index of the step's condition. If None, the step belongs to no condition.
        trial: number of trials before this trial. If None, the step is not a trial.
    """

    number: int
    index: int
    entry: StepEntry
    name: str
    condition: int | None = None
    trial: int | None = None


def plan_of(design: ExperimentDesign, place: Place) -> tuple[PlannedStep, ...]:
    """Return the steps of the person at a place."""
    planned: list[PlannedStep] = []
    trials = itertools.count()

    def plan(index: int, entry: StepEntry, condition: int | None) -> None:
        trial = next(trials) if entry.step is StepKind.TRIAL else None
        planned.append(PlannedStep(len(planned) + 1, index, entry, name_of(index, entry), condition, trial))

    entries = enumerate(design.file.steps)
    for each, block in itertools.groupby(entries, key=lambda numbered: numbered[1].each_condition):
        steps = list(block)
        for condition in design.orders[place.order] if each else (None,):
            for index, entry in steps:
                plan(index, entry, condition if each else _only(design, entry))
    return tuple(planned)


def _only(design: ExperimentDesign, entry: StepEntry) -> int | None:
    """Return the condition of a step without `each_condition`: for a trial, the only condition; otherwise None."""
    return 0 if entry.step is StepKind.TRIAL and len(design.conditions) == 1 else None


def repeated_from(plan: Sequence[PlannedStep], check: PlannedStep) -> int:
    """Return the number of the step to which a person returns after failing a check.

    This is the last step before the check with the name in `repeat`, or the check itself if there is no such step.
    """
    named = (step.number for step in reversed(plan[: check.number]) if step.name == check.entry.repeat)
    return next(named, check.number)


def study_of_game(design: ExperimentDesign, place: Place, step: PlannedStep) -> Study | None:
    """Return the study of a trial or practice game, without its random seed. Return None for other steps."""
    if step.entry.step is StepKind.PRACTICE:
        first = design.orders[place.order][0] if step.condition is None else step.condition
        return design.practices[step.index][place.cell][first]
    return None if step.condition is None or step.trial is None else design.cells[place.cell].studies[step.condition]


def seats_of_game(design: ExperimentDesign, place: Place, step: PlannedStep) -> tuple[str, ...]:
    """Return the names of the seats of a step's game; empty for games with one participant, and for other steps."""
    study = study_of_game(design, place, step)
    return () if study is None else tuple(seat.name for seat in study.seats)

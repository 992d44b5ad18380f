"""Previews of single steps: a separate log in which a person has already reached the step."""

import itertools
from collections.abc import Mapping, Sequence

from thbridge.experiment.allocation.places import Place
from thbridge.experiment.design.experiment_file import Cell, ExperimentCondition, ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep, plan_of
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.events import Clocks, EventKind, JsonValue, NewEvent, StepOutcome

PARTICIPANT = "P-PREVIEW"
"""Id of the person in a preview."""


class NoSuchStep(Exception):  # noqa: N818 - people read it as a sentence
    """Request for a preview of a step, condition or group that the study does not have."""


def place_of(design: ExperimentDesign, step: str, condition: str, group: str) -> tuple[Place, PlannedStep]:
    """Return a place whose person reaches a step in a condition, and the step in the plan of this person.

    Args:
        design: the study.
        step: name of the step, or its number in the file; if empty, the first step.
        condition: levels within people, such as `dialogue.condition=supervisor` or `supervisor`; if empty, the first
            condition.
        group: levels between people, in the same notation; if empty, the first group.

    Raises:
        NoSuchStep: the study has no such step, condition or group.
    """
    cell = _index("group", group, design.cells)
    wanted = _index("condition", condition, design.conditions)
    places = map(design.allocation.place, itertools.count())
    for place in itertools.islice(places, design.allocation.size * len(design.orders)):
        if place.cell != cell:
            continue
        plan = plan_of(design, place)
        named = [planned for planned in plan if step in {"", planned.name, str(planned.index + 1)}]
        if not named:
            names = ", ".join(dict.fromkeys(planned.name for planned in plan))
            raise NoSuchStep(f"the study has no step {step}. Write one of {names}, or the step's number in the file")
        fitting = [planned for planned in named if planned.condition in {None, wanted}]
        # A step outside of conditions is shown to a person whose first condition is the wanted condition.
        if fitting and (fitting[0].condition is not None or design.orders[place.order][0] == wanted):
            return place, fitting[0]
    raise NoSuchStep(f"the condition {condition} does not have the step {step}")


def _index(what: str, words: str, among: Sequence[Cell | ExperimentCondition]) -> int:
    """Return the index of a condition or group. `words` are all its levels in words, or only one level."""
    for index, each in enumerate(among):
        if words in {"", each.name} or words in each.levels.values():
            return index
    raise NoSuchStep(f"the study has no {what} {words}. {_one_of([each.name for each in among])}")


def _one_of(names: Sequence[str]) -> str:
    return f"Write one of: {'; '.join(names)}" if any(names) else "The study has only one, without a name"


def arrive(design: ExperimentDesign, log: ExperimentLog, place: Place, step: PlannedStep, now: Clocks) -> None:
    """Write events into an empty log so that a person has reached a step. All earlier steps are skipped."""

    def event(kind: EventKind, number: int, data: Mapping[str, JsonValue]) -> NewEvent:
        return NewEvent(kind, "program", now, PARTICIPANT, number, data=data)

    events = [event(EventKind.RUN_BEGUN, 0, {"place": place.number})]
    for before in plan_of(design, place)[: step.number - 1]:
        events.append(event(EventKind.STEP_BEGUN, before.number, {"name": before.name}))
        events.append(event(EventKind.STEP_ENDED, before.number, {"outcome": StepOutcome.PASSED_OVER}))
    log.append(events)

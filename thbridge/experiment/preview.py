"""Previews: a log of its own in which somebody has come to a step, so that it can be shown without the steps before."""

import itertools
from collections.abc import Mapping, Sequence

from thbridge.experiment.allocation.places import Place
from thbridge.experiment.design.experiment_file import Cell, ExperimentCondition, ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep, plan_of
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.events import Clocks, EventKind, JsonValue, NewEvent, StepOutcome

PARTICIPANT = "P-PREVIEW"
"""Id of the person of a preview."""


class NoSuchStep(Exception):  # noqa: N818 - it is shown as a sentence
    """A preview of something that the study does not have."""


def place_of(design: ExperimentDesign, step: str, condition: str, group: str) -> tuple[Place, PlannedStep]:
    """Return a place at which somebody comes to a step in a condition, and the step in their order.

    Args:
        design: the study.
        step: name of the step, or its number in the file; empty: the first.
        condition: levels within people, such as `dialogue.condition=supervisor` or `supervisor`; empty: the first.
        group: levels between people, likewise.

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
            raise NoSuchStep(f"there is no step {step}. Name one of {names}, or its number in the file")
        fitting = [planned for planned in named if planned.condition in {None, wanted}]
        # A step outside of conditions is shown to somebody who meets this condition first.
        if fitting and (fitting[0].condition is not None or design.orders[place.order][0] == wanted):
            return place, fitting[0]
    raise NoSuchStep(f"{step} does not come in the condition {condition}")


def _index(what: str, words: str, among: Sequence[Cell | ExperimentCondition]) -> int:
    """Return the index of a condition or group by its levels in words, or by one level alone."""
    for index, each in enumerate(among):
        if words in {"", each.name} or words in each.levels.values():
            return index
    raise NoSuchStep(f"there is no {what} {words}. {_one_of([each.name for each in among])}")


def _one_of(names: Sequence[str]) -> str:
    return f"Name one of: {'; '.join(names)}" if any(names) else "There is only one, without a name"


def arrive(design: ExperimentDesign, log: ExperimentLog, place: Place, step: PlannedStep, now: Clocks) -> None:
    """Write into an empty log how somebody came to a step: all steps before it are passed over."""

    def event(kind: EventKind, number: int, data: Mapping[str, JsonValue]) -> NewEvent:
        return NewEvent(kind, "program", now, PARTICIPANT, number, data=data)

    events = [event(EventKind.RUN_BEGUN, 0, {"place": place.number})]
    for before in plan_of(design, place)[: step.number - 1]:
        events.append(event(EventKind.STEP_BEGUN, before.number, {"name": before.name}))
        events.append(event(EventKind.STEP_ENDED, before.number, {"outcome": StepOutcome.PASSED_OVER}))
    log.append(events)

"""Progress of an experiment: the present step of each person, the runs that count, and the free places.

The progress depends only on the events in the log. So a program that restarts after a crash only needs to read the log.
"""

import dataclasses
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from thbridge.experiment.allocation.places import NoPlace, Place
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep, plan_of, repeated_from, seats_of_game
from thbridge.experiment.design.recruiting import Ending
from thbridge.experiment.design.steps import Failed, ResumeRule, StepKind
from thbridge.experiment.groups import CHANGES_GROUPS, BadSeat, GroupGame, GroupSeat, game_after
from thbridge.experiment.questionnaires.form import Item
from thbridge.experiment.store.events import (
    EventKind,
    JsonValue,
    LogEntry,
    LoggedEvent,
    NewEvent,
    RunState,
    StepOutcome,
)
from thbridge.files.errors import BadFile


@dataclass(frozen=True, slots=True)
class Run:
    """Progress of one person through an experiment.

    Attributes:
        participant: id of the person.
        place: place of the run.
        plan: planned steps of the person.
        state: state of the run.
        reason: reason why the person left or was excluded; otherwise empty.
        step: number of the current or next step. After the last step, the number of steps plus 1.
        under_way: True if `step` has begun.
        begun: number of times that each step has begun, by the step's number in the plan.
        attempts: number of attempts at each check, by the check's number in the plan.
        failed: numbers of the checks with a failed last attempt.
        answers: the last answer to each item, by `STEP.ITEM`.
        given: the answers given in the current step, by the item's id.
        drafts: answers of the current step that the person has changed but not yet given.
        timed_out: items of the current step that were closed by their time limits.
        game: the log's data about the current step's game, or None if the game has no recording yet.
        agrees: True if the person gave consent in the current step, False if they declined, None before the answer.
        last_outcome: outcome of the last finished step, or None.
        code: completion code; empty until the run is complete.
        external_id: code of the person's link, or the person's id at a recruiting service; empty if there is none.
        parameters: parameters of the person's link.
        front_end: program in which the person takes part; empty for simulated people and in logs of earlier releases.
        absent: True if the run ended because the person was absent for too long.
        recruiting_code: code of a recruiting service that the person entered, or None before the answer.
        agreed_at: wall time at which the person agreed to take part; empty before the consent.
        message: message of the experimenter that the person has not closed; empty if there is none.
        farewell_read: True after the person has closed the last page.
        cut_off: files of incomplete recordings.
        scores: score of each recorded game, by the number of the game's step.
        lags: largest lag of each game behind real time, s, by the number of the game's step in the plan. Games of
            rehearsals and of earlier releases are not in this mapping.
        debriefs: debriefings shown after the run ended early, by their numbers in the plan. True if the person has read
            the debriefing.
        seats: the person's seat in each game of several people, by the number of the game's step.
        missed: numbers of the games that were skipped because a person of the group had left.
        unmatched: True if the run ended because the person waited in vain for other people.
    """

    participant: str
    place: Place
    plan: tuple[PlannedStep, ...]
    state: RunState = RunState.UNDER_WAY
    reason: str = ""
    step: int = 1
    under_way: bool = False
    begun: Mapping[int, int] = field(default_factory=dict)
    attempts: Mapping[int, int] = field(default_factory=dict)
    failed: frozenset[int] = frozenset()
    answers: Mapping[str, JsonValue] = field(default_factory=dict)
    given: Mapping[str, JsonValue] = field(default_factory=dict)
    drafts: Mapping[str, JsonValue] = field(default_factory=dict)
    timed_out: frozenset[str] = frozenset()
    game: Mapping[str, JsonValue] | None = None
    agrees: bool | None = None
    last_outcome: StepOutcome | None = None
    code: str = ""
    external_id: str = ""
    parameters: Mapping[str, str] = field(default_factory=dict)
    front_end: str = ""
    absent: bool = False
    recruiting_code: str | None = None
    agreed_at: str = ""
    message: str = ""
    farewell_read: bool = False
    cut_off: frozenset[str] = frozenset()
    lags: Mapping[int, float] = field(default_factory=dict)
    scores: Mapping[int, int] = field(default_factory=dict)
    debriefs: Mapping[int, bool] = field(default_factory=dict)
    seats: Mapping[int, GroupSeat] = field(default_factory=dict)
    missed: frozenset[int] = frozenset()
    unmatched: bool = False

    @property
    def lag(self) -> float | None:
        """Largest lag of all games behind real time, s, or None if no lag is known."""
        return max(self.lags.values(), default=None)

    @property
    def slowest(self) -> tuple[PlannedStep, float] | None:
        """Step of the game with the largest lag, and this lag in s. None if no lag is known."""
        if not self.lags:
            return None
        number = max(self.lags, key=self.lags.__getitem__)
        return self.plan[number - 1], self.lags[number]

    @property
    def takes_part(self) -> bool:
        """True if the person has agreed to take part, or if no step asks for consent."""
        asked = next((step for step in self.plan if step.entry.step is StepKind.CONSENT), None)
        return asked is None or bool(self.agreed_at) or self.step > asked.number

    @property
    def ending(self) -> Ending | None:
        """Ending of the run, or None before the end. A code proves that the person completed the study."""
        match self.state:
            case RunState.UNDER_WAY:
                return None
            case _ if self.unmatched:
                return Ending.NO_GROUP
            case _ if self.code:
                return Ending.COMPLETE
            case RunState.DECLINED:
                return Ending.DECLINED
            case RunState.EXCLUDED if self.last_outcome is StepOutcome.FAILED:
                return Ending.FAILED_CHECK
            case _:
                return Ending.TIMED_OUT if self.absent else Ending.ENDED_EARLY

    @property
    def holds_place(self) -> bool:
        """True if no other person can get the run's place."""
        return self.state in {RunState.UNDER_WAY, RunState.COMPLETE}


class BadHistory(BadFile):
    """A log that does not match the experiment's files, because the files were changed after people took part."""

    def __init__(self, path: Path, problem: str) -> None:
        remedy = "Restore the files with which people took part; for changed files start another study"
        super().__init__(path, f"{_UNFIT}{problem}", remedy)

    def __reduce__(self) -> tuple[type["BadHistory"], tuple[Path, str]]:  # type: ignore[override]  # as built
        return (type(self), (self.path, self.problem.removeprefix(_UNFIT)))


_UNFIT = "does not fit what is in the log: "


def failure(check: PlannedStep) -> str:
    """Return the reason for excluding a person who failed a check."""
    return f"failed {check.name}"


class _CannotFollowError(ValueError):
    """An event that is not possible after the earlier events."""


@dataclass(frozen=True, slots=True)
class Progress:
    """State of an experiment after some events.

    Attributes:
        design: the experiment.
        runs: run of each person, by the person's id.
        sequence: number of the last event.
        admits: False while admission is closed.
        groups: games of several people, by the id of the group and the number of the step.
    """

    design: ExperimentDesign
    runs: Mapping[str, Run] = field(default_factory=dict)
    sequence: int = 0
    admits: bool = True
    groups: Mapping[tuple[str, int], GroupGame] = field(default_factory=dict)

    @property
    def valid(self) -> frozenset[int]:
        """Numbers of the places of runs that count."""
        return frozenset(run.place.number for run in self.runs.values() if run.state is RunState.COMPLETE)

    @property
    def under_way(self) -> frozenset[int]:
        """Numbers of the places of unfinished runs. These runs may count later."""
        return frozenset(run.place.number for run in self.runs.values() if run.state is RunState.UNDER_WAY)

    def run_of(self, external_id: str) -> Run | None:
        """Return the run of the person with this code or id at a recruiting service, if there is one."""
        return next((run for run in self.runs.values() if external_id and run.external_id == external_id), None)

    def next_place(self) -> Place | NoPlace:
        """Return the place for the next person."""
        grouped = {run.place.number for run in self.runs.values() if run.holds_place and run.seats}
        place = self.design.allocation.next(self.valid, self.under_way, grouped)
        return place if self.admits or place is NoPlace.FULL else NoPlace.CLOSED

    def next_step(self, participant: str) -> PlannedStep | None:
        """Return the person's current step, or None if all steps are done or the run has ended."""
        run = self.runs[participant]
        return run.plan[run.step - 1] if run.state is RunState.UNDER_WAY and run.step <= len(run.plan) else None

    def next_debriefing(self, participant: str) -> PlannedStep | None:
        """Return the next debriefing of a person who left or was excluded, or None.

        People who never agreed to take part get no debriefing. Each debriefing is shown only until it is read.
        """
        run = self.runs[participant]
        if run.state not in {RunState.LEFT, RunState.EXCLUDED} or not run.takes_part:
            return None
        ahead = (step for step in run.plan[run.step - 1 + run.under_way :] if step.entry.step is StepKind.DEBRIEF)
        return next(
            (
                step
                for step in ahead
                if step.entry.when_leaving and self.wants(participant, step) and not run.debriefs.get(step.number)
            ),
            None,
        )

    def wants(self, participant: str, step: PlannedStep) -> bool:
        """Return True if a step applies to a person's condition and answers."""
        run = self.runs[participant]
        return self._at_levels(run, step) and all(
            run.answers.get(item) == wanted for item, wanted in step.entry.when.items()
        )

    def steps_shown(self, participant: str) -> list[PlannedStep]:
        """Return the steps of a person's plan, without steps for other conditions."""
        run = self.runs[participant]
        return [step for step in run.plan if self._at_levels(run, step)]

    def step_count(self, participant: str) -> tuple[int, int]:
        """Return the number of a person's step, from 1, and the number of their steps. Skipped steps do not count."""
        numbers = [step.number for step in self.steps_shown(participant)]
        return sum(number <= self.runs[participant].step for number in numbers), len(numbers)

    def _at_levels(self, run: Run, step: PlannedStep) -> bool:
        """Return True if a step applies to a person's condition."""
        levels = self.design.levels_at(run.place.cell, step.condition)
        return all(levels.get(factor) == level for factor, level in step.entry.only_at.items())

    def after(self, entries: Iterable[LogEntry]) -> "Progress":
        """Return the state after further entries of the log.

        Raises:
            BadHistory: an event is not possible after the earlier events.
        """
        runs, sequence, admits, groups = dict(self.runs), self.sequence, self.admits, self.groups
        for entry in entries:
            sequence = entry.sequence
            if isinstance(entry, LoggedEvent):
                if entry.event.kind in {EventKind.ADMISSION_CLOSED, EventKind.ADMISSION_OPENED}:
                    admits = entry.event.kind == EventKind.ADMISSION_OPENED
                try:
                    self._take(runs, entry.event)
                    if entry.event.kind in CHANGES_GROUPS and (game := game_after(groups, entry.event)) is not None:
                        groups = {**groups, (game.group, game.step): game}
                except (_CannotFollowError, BadSeat) as fault:
                    raise BadHistory(self.design.path, str(fault)) from None
        return dataclasses.replace(self, runs=runs, sequence=sequence, admits=admits, groups=groups)

    def group_game(self, participant: str, step: PlannedStep) -> GroupGame | None:
        """Return the game of several people in which a person has a seat in a step, or None."""
        taken = self.runs[participant].seats.get(step.number)
        return None if taken is None else self.groups[taken.group, step.number]

    def incomplete_game(self, participant: str) -> PlannedStep | None:
        """Return the step of a person's first trial with an empty seat or a program in a seat, or None."""
        run = self.runs[participant]
        trials = (step for step in run.plan if step.entry.step is StepKind.TRIAL)
        games = ((step, self.group_game(participant, step)) for step in trials)
        return next((step for step, game in games if game is not None and game.incomplete), None)

    def _take(self, runs: dict[str, Run], event: NewEvent) -> None:
        data, person = event.data or {}, event.participant
        if event.kind == EventKind.RUN_BEGUN:
            number = data["place"]
            taken = {run.place.number for run in runs.values() if run.holds_place}
            if person in runs or not isinstance(number, int) or number in taken:
                raise _CannotFollowError(f"{person} begins at place {number}, which is taken, or begins twice")
            place = self.design.allocation.place(number)
            if (data.get("cell", place.cell), data.get("order", place.order)) != (place.cell, place.order):
                raise _CannotFollowError(f"place {number} had other conditions, or another order of conditions")
            runs[person] = Run(
                person,
                place,
                plan_of(self.design, place),
                external_id=str(data.get("external_id", "")),
                parameters=_texts(data.get("parameters")),
                front_end=str(data.get("front_end", "")),
            )
            return
        run = runs.get(person)
        if run is None:
            return
        # Events after the end of a run are checked, too, because they are rows of exported tables.
        self._check(run, event, data)
        if event.kind == EventKind.RUN_EXCLUDED:
            runs[person] = dataclasses.replace(run, state=RunState.EXCLUDED, reason=str(data["reason"]))
        elif event.kind == EventKind.FAREWELL_READ:
            runs[person] = dataclasses.replace(run, farewell_read=True)
        elif run.state is RunState.UNDER_WAY:
            runs[person] = _gone_on(run, event, data)
        elif event.kind in {EventKind.STEP_BEGUN, EventKind.STEP_ENDED}:
            debriefs = {**run.debriefs, event.step: event.kind == EventKind.STEP_ENDED}
            runs[person] = dataclasses.replace(run, debriefs=debriefs)

    def _check(self, run: Run, event: NewEvent, data: Mapping[str, JsonValue]) -> None:
        """Raise _CannotFollowError if the step of an event differs from the person's plan."""
        if event.step == 0:
            return
        if event.step > len(run.plan):
            raise _CannotFollowError(f"{run.participant} is in step {event.step} of {len(run.plan)}")
        step = run.plan[event.step - 1]
        if event.kind == EventKind.STEP_BEGUN:
            condition = "" if step.condition is None else self.design.conditions[step.condition].name
            if (was := str(data.get("name", step.name))) != step.name:
                raise _CannotFollowError(f"step {event.step} of {run.participant} was {was}, and is {step.name}")
            if event.condition and event.condition != condition:
                problem = f"in step {event.step}, {run.participant} met {event.condition}"
                raise _CannotFollowError(f"{problem}, which is now {condition or 'none'}")
        if event.kind == EventKind.GROUP_FORMED:
            seats, taken = seats_of_game(self.design, run.place, step), data["seats"]
            if not isinstance(taken, dict) or tuple(taken) != seats:
                raise _CannotFollowError(f"{step.name} had the seats {taken}, and has {', '.join(seats) or 'none'}")
        if "item" in data:
            form = self.design.forms.get(step.index)
            if form is not None and all(item.id != data["item"] for item in form.items):
                raise _CannotFollowError(f"{run.participant} was asked {data['item']}, which {step.name} does not have")


def _gone_on(run: Run, event: NewEvent, data: Mapping[str, JsonValue]) -> Run:
    """Return the state of a run in progress after a further event."""
    match event.kind:
        case EventKind.STEP_BEGUN:
            if event.step != run.step or run.under_way:
                raise _CannotFollowError(f"{run.participant} begins step {event.step}, but step {run.step} is next")
            begun = {**run.begun, event.step: run.begun.get(event.step, 0) + 1}
            run = _emptied(run)
            return dataclasses.replace(run, under_way=True, begun=begun, game=None, agrees=None)
        case EventKind.STEP_RESUMED if data.get("from") == ResumeRule.BEGINNING:
            return _emptied(run)
        case EventKind.ITEM_CHANGED if run.under_way and "answer" in data:
            return dataclasses.replace(run, drafts={**run.drafts, str(data["item"]): data["answer"]})
        case EventKind.ITEM_GIVEN | EventKind.ITEM_TIMED_OUT if event.step > 0:
            name = run.plan[event.step - 1].name
            item, answer = str(data["item"]), data["answer"]
            answers, given = {**run.answers, f"{name}.{item}": answer}, {**run.given, item: answer}
            drafts = {other: draft for other, draft in run.drafts.items() if other != item}
            timed_out = run.timed_out | {item} if event.kind == EventKind.ITEM_TIMED_OUT else run.timed_out - {item}
            return dataclasses.replace(run, answers=answers, given=given, drafts=drafts, timed_out=timed_out)
        case EventKind.GAME_PLAYED:
            lag = data.get("most_lag_seconds")
            lags = {**run.lags, event.step: float(lag)} if isinstance(lag, int | float) else run.lags
            score = data.get("score")
            scores = {**run.scores, event.step: score} if isinstance(score, int) else run.scores
            return dataclasses.replace(run, game=data, lags=lags, scores=scores)
        case EventKind.GROUP_FORMED:
            taken = GroupSeat(str(data["group"]), str(data["seat"]))
            return dataclasses.replace(run, seats={**run.seats, event.step: taken})
        case EventKind.STEP_ENDED:
            if data.get("unmatched") is True:
                run = dataclasses.replace(run, missed=run.missed | {event.step})
            return _ended(run, event.step, StepOutcome(str(data["outcome"])))
        case EventKind.RUN_ENDED:
            state, reason = RunState(str(data["outcome"])), str(data.get("reason", ""))
            if "excluded" in data:
                state, reason = RunState.EXCLUDED, str(data["excluded"])
            code, absent = str(data.get("code", "")), data.get("absent") is True
            unmatched = data.get("unmatched") is True
            return dataclasses.replace(run, state=state, reason=reason, code=code, absent=absent, unmatched=unmatched)
        case EventKind.RECORDING_CUT_OFF | EventKind.GAME_BROKEN_OFF:
            return dataclasses.replace(run, cut_off=run.cut_off | {str(data["bag"])})
        case EventKind.MESSAGE_SENT:
            return dataclasses.replace(run, message=str(data["text"]))
        case EventKind.MESSAGE_CLOSED:
            return dataclasses.replace(run, message="")
        case EventKind.RECRUITING_CODE:
            return dataclasses.replace(run, recruiting_code=str(data["code"]))
        case EventKind.CONSENT_ANSWERED:
            agreed_at = event.clocks.wall if data["agrees"] else run.agreed_at
            return dataclasses.replace(run, agreed_at=agreed_at, agrees=bool(data["agrees"]))
        case _:
            return run


def _texts(data: JsonValue) -> dict[str, str]:
    return {name: str(value) for name, value in data.items()} if isinstance(data, dict) else {}


def _emptied(run: Run) -> Run:
    return dataclasses.replace(run, given={}, drafts={}, timed_out=frozenset())


def _ended(run: Run, number: int, outcome: StepOutcome) -> Run:
    if number != run.step:
        raise _CannotFollowError(f"{run.participant} ends step {number}, but is in step {run.step}")
    step, run = run.plan[number - 1], dataclasses.replace(run, last_outcome=outcome)
    if outcome is StepOutcome.LOST:
        reason = f"{step.name} could not go on"
        return dataclasses.replace(run, state=RunState.EXCLUDED, reason=reason, under_way=False)
    following = dataclasses.replace(run, step=number + 1, under_way=False)
    if step.entry.step is not StepKind.CHECK or outcome is StepOutcome.PASSED_OVER:
        return following
    tried = run.attempts.get(number, 0) + 1
    following = dataclasses.replace(following, attempts={**run.attempts, number: tried})
    if outcome is not StepOutcome.FAILED:
        return following
    if tried < step.entry.attempts:
        return dataclasses.replace(following, step=repeated_from(run.plan, step))
    if step.entry.failed is Failed.GO_ON:
        return dataclasses.replace(following, failed=run.failed | {number})
    return dataclasses.replace(following, state=RunState.EXCLUDED, reason=failure(step))


def options_shown(item: Item) -> dict[str, JsonValue]:
    """Return the data of an `ITEM_SHOWN` about the order of answers; empty if all participants see the same order.

    Args:
        item: item with its answers in the participant's order.
    """
    return {"options": list(item.options)} if item.shuffle else {}


def resumes(run: Run, step: PlannedStep) -> ResumeRule:
    """Return the rule for resuming the step that was in progress when the program ended."""
    return step.entry.resume if run.under_way else ResumeRule.BEGINNING


def lag_words(progress: Progress) -> Iterator[str]:
    """Yield a sentence about the lag of games behind real time. Yield nothing if no game was measured."""
    measured = [run for run in progress.runs.values() if run.lags]
    if not measured:
        return
    games = sum(len(run.lags) for run in measured)
    bound, most = progress.design.file.most_lag, max(run.lag or 0.0 for run in measured)
    rule = "most_lag is not set" if bound is None else f"most_lag is {bound:g} s"
    yield f"Games were at most {most:.1f} s behind real time; games measured: {games}; {rule}."

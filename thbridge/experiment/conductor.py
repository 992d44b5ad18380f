"""The conductor of an experiment: it assigns people to places and steps, and logs each event before the next event.

Its complete state is in the log. A program can later open the same log, after a crash or on another machine. Then it
continues after the last event in the log.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import ResumeRule, StepKind
from thbridge.experiment.groups import GROUP, GroupGame
from thbridge.experiment.lobby import FormedGroup, WaitEnded
from thbridge.experiment.progress import Progress, Run, resumes
from thbridge.experiment.questionnaires.form import Form
from thbridge.experiment.questionnaires.scoring import is_right
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.events import (
    Actor,
    Clocks,
    EventKind,
    FrontEnd,
    JsonValue,
    LogEntry,
    LoggedEvent,
    NewEvent,
    RunState,
    StepOutcome,
)

LETTERS = "23456789ABCDEFGHJKMNPQRSTVWXYZ"
"""Letters and digits of ids and codes. Characters that look alike are not included."""

Draw = Callable[[int], int]
"""Function that returns a random whole number from 0 to n - 1, where n is its argument."""


class Conductor:
    """Runner of an experiment: it assigns places, begins and ends steps, and logs all events.

    Args:
        design: the experiment.
        log: log of the experiment.
        clocks: function that returns the current time outside of a trial.
        draw: source of random ids and codes, which must not depend on the experiment's seed.

    Raises:
        BadFile: the log cannot be read.
    """

    def __init__(self, design: ExperimentDesign, log: ExperimentLog, clocks: Callable[[], Clocks], draw: Draw) -> None:
        self._design = design
        self._log = log
        self._clocks = clocks
        self._draw = draw
        self.progress = Progress(design).after(log.read())
        """Progress of all people."""
        self.listeners: list[Callable[[LoggedEvent], None]] = []
        """Functions that receive each event after it was added to the log and to `progress`."""

    @property
    def entries(self) -> Sequence[LogEntry]:
        """All entries of the log; each call reads the whole log."""
        return self._log.read()

    def admit(
        self,
        external_id: str = "",
        parameters: Mapping[str, str] | None = None,
        front_end: FrontEnd | None = None,
    ) -> Run | NoPlace:
        """Begin the run of the next person if a place is free; otherwise return the reason.

        Args:
            external_id: code of the person's link, or the person's id at a recruiting service; may be empty.
            parameters: parameters of the person's link; None if there are none.
            front_end: program in which the person takes part; None for simulated people.
        """
        place = self.progress.next_place()
        if isinstance(place, NoPlace):
            return place
        while (participant := f"P-{_word(self._draw, 5)}") in self.progress.runs:
            pass
        data: dict[str, JsonValue] = {"place": place.number, "cell": place.cell, "order": place.order}
        if external_id:
            data["external_id"] = external_id
        if parameters:
            data["parameters"] = dict(parameters)
        if front_end is not None:
            data["front_end"] = str(front_end)
        self._append(EventKind.RUN_BEGUN, "program", participant, data=data)
        return self.progress.runs[participant]

    def begin(self, participant: str) -> PlannedStep | None:
        """Begin a person's next step, or resume the current step. Return None if all steps are done.

        Steps that need another condition or other answers are skipped. If a step must not resume after a crash, the run
        ends.
        """
        while (step := self.progress.next_step(participant)) is not None:
            run = self.progress.runs[participant]
            if run.under_way:
                how = resumes(run, step)
                if how is ResumeRule.NEVER:
                    self._end(participant, step, StepOutcome.LOST)
                    continue
                self._of_step(EventKind.STEP_RESUMED, "program", participant, step, {"from": str(how)})
                return step
            self._of_step(EventKind.STEP_BEGUN, "program", participant, step, {"name": step.name})
            if self.progress.wants(participant, step):
                return step
            self._end(participant, step, StepOutcome.PASSED_OVER)
        run = self.progress.runs[participant]
        if run.state is RunState.UNDER_WAY:
            data: dict[str, JsonValue] = {"outcome": RunState.COMPLETE, "code": _word(self._draw, 8)}
            if (why := _too_slow(run, self._design.file.most_lag) or self._incomplete(run)) is not None:
                data["excluded"] = why
            self._append(EventKind.RUN_ENDED, "program", participant, data=data)
        return None

    def debrief(self, participant: str) -> PlannedStep | None:
        """Begin or resume the next debriefing of a person who left or was excluded.

        Return None if the person needs no further debriefing.
        """
        step = self.progress.next_debriefing(participant)
        if step is not None and step.number in self.progress.runs[participant].debriefs:
            self._of_step(EventKind.STEP_RESUMED, "program", participant, step, {"from": str(ResumeRule.BEGINNING)})
        elif step is not None:
            self._of_step(EventKind.STEP_BEGUN, "program", participant, step, {"name": step.name})
        return step

    def tell(
        self, kind: EventKind, participant: str, step: PlannedStep, data: Mapping[str, JsonValue], actor: Actor
    ) -> LoggedEvent:
        """Log an event of a step, for example that an item was shown, changed or answered."""
        return self._of_step(kind, actor, participant, step, data)

    def tell_of_run(self, kind: EventKind, participant: str, data: Mapping[str, JsonValue], actor: Actor) -> None:
        """Log an event of a person's run that does not belong to a step."""
        self._append(kind, actor, participant, data=data)

    def end(self, participant: str, step: PlannedStep) -> StepOutcome:
        """End a step that a person has finished. Return its outcome, which depends on the answers for a check."""
        outcome = StepOutcome.DONE
        if step.entry.step is StepKind.CHECK and not self._passed(participant, step):
            outcome = StepOutcome.FAILED
        self._end(participant, step, outcome)
        return outcome

    def form_group(self, formed: FormedGroup, step: PlannedStep) -> GroupGame:
        """Log that a group got its seats, all people at once. Return its game.

        Args:
            formed: the group.
            step: step of the game, which is the same for all people.
        """
        people = list(formed.people.values())
        known = {
            taken.group
            for person in people
            for number, taken in self.progress.runs[person].seats.items()
            if number < step.number
        }
        if self._design.file.lobby.same_group and known:
            (group,) = known
        else:
            taken_ids = {group for group, _ in self.progress.groups}
            while (group := f"{GROUP}{_word(self._draw, 5)}") in taken_ids:
                pass
        seats: dict[str, JsonValue] = {seat: str(holder) for seat, holder in formed.seats.items()}
        self._append_all(
            [
                self._event_of_step(
                    EventKind.GROUP_FORMED,
                    "program",
                    person,
                    step,
                    {"group": group, "seat": seat, "seats": seats, "waited_s": round(formed.waited[person], 3)},
                )
                for seat, person in formed.people.items()
            ]
        )
        return self.progress.groups[group, step.number]

    def change_seat(self, kind: EventKind, game: GroupGame, seat: str, simulated: float | None = None) -> GroupGame:
        """Log that a person left a seat, that a program took it, or that the person resumed it. Return the game.

        Args:
            kind: `SEAT_LEFT`, `SEAT_FILLED` or `SEAT_RESUMED`.
            game: game of the group.
            seat: name of the seat.
            simulated: simulated time of the game, s. If None, the time of the clocks applies.
        """
        clocks = self._clocks()
        clocks = clocks if simulated is None else replace(clocks, simulated=simulated)
        data: dict[str, JsonValue] = {"group": game.group, "seat": seat}
        self._append_all([NewEvent(kind, "program", clocks, "", game.step, data=data)])
        return self.progress.groups[game.group, game.step]

    def end_group_game(self, game: GroupGame, data: Mapping[str, JsonValue]) -> None:
        """Log the finished game of a group for each person who holds a seat, all people at once.

        If all people have left, there is nothing to log.

        Args:
            game: game of the group.
            data: data of the `GAME_PLAYED` events.
        """
        seats = {person: seat for seat, person in game.people.items()}
        runs = [self.progress.runs[person] for person in self.progress.groups[game.group, game.step].present]
        events = [
            self._event_of_step(
                EventKind.GAME_PLAYED,
                "program",
                run.participant,
                run.plan[game.step - 1],
                {**data, "group": game.group, "seat": seats[run.participant]},
            )
            for run in runs
            if run.state is RunState.UNDER_WAY
        ]
        if events:
            self._append_all(events)

    def end_wait(self, participant: str, step: PlannedStep, outcome: WaitEnded) -> None:
        """Log the end of a wait without a game: the step is skipped, or the run ends with a completion code."""
        if outcome.is_skipped:
            ended: dict[str, JsonValue] = {"outcome": str(StepOutcome.PASSED_OVER), "unmatched": True}
            self._of_step(EventKind.STEP_ENDED, "program", participant, step, ended)
            return
        data: dict[str, JsonValue] = {
            "outcome": RunState.COMPLETE,
            "code": _word(self._draw, 8),
            "excluded": f"{step.name} had no complete group after {outcome.waited:.0f} s",
            "unmatched": True,
        }
        self._append(EventKind.RUN_ENDED, "program", participant, data=data)

    def leave(
        self,
        participant: str,
        reason: str,
        *,
        declined: bool = False,
        absent: bool = False,
        actor: Actor = "participant",
        author: str = "",
    ) -> None:
        """End a run early.

        Args:
            participant: id of the person.
            reason: reason for the log and for researchers.
            declined: True if the person did not agree to take part.
            absent: True if the person was absent for too long.
            actor: cause of the end.
            author: name of the experimenter who ends the run; may be empty.
        """
        outcome = RunState.DECLINED if declined else RunState.LEFT
        data: dict[str, JsonValue] = {"outcome": outcome, "reason": reason}
        if absent:
            data["absent"] = True
        if author:
            data["author"] = author
        self._append(EventKind.RUN_ENDED, actor, participant, data=data)

    def exclude(self, participant: str, reason: str, author: str = "") -> None:
        """Exclude a run: it no longer counts, and its place becomes free.

        Args:
            participant: id of the person.
            reason: reason for the log.
            author: name of the experimenter; may be empty.
        """
        data: dict[str, JsonValue] = {"reason": reason, **({"author": author} if author else {})}
        self._append(EventKind.RUN_EXCLUDED, "experimenter", participant, data=data)

    def set_admission(self, is_open: bool, author: str) -> None:
        """Open or close admission; an experimenter's name is the author."""
        kind = EventKind.ADMISSION_OPENED if is_open else EventKind.ADMISSION_CLOSED
        self._append(kind, "experimenter", "", data={"author": author})

    def rehearse(self, seed: int) -> None:
        """Log that simulated people take part from now on, with their random seed."""
        self._append(EventKind.REHEARSED, "program", "", data={"seed": seed})

    def note(self, text: str, participant: str = "") -> None:
        """Log a note of the experimenter."""
        self._append(EventKind.NOTE, "experimenter", participant, data={"text": text})

    def withdraw(self, participant: str) -> None:
        """Delete all events of a person from the log, and all notes that contain the person's id.

        All other events stay unchanged. For example, if a person withdraws, excluded runs of other people stay
        excluded.
        """
        self._log.delete(sequences_of(self._log.read(), participant), self._clocks())
        entries = self._log.read()
        self.progress = Progress(self._design).after(entries)
        self._notify(entries[-1])

    def form(self, step: PlannedStep) -> Form:
        """Return the form of a step. The step must have a form."""
        return self._design.forms[step.index]

    def _passed(self, participant: str, step: PlannedStep) -> bool:
        run = self.progress.runs[participant]
        levels = self._design.levels_at(run.place.cell, step.condition)
        judged = [is_right(item, run.given.get(item.id), levels) for item in self.form(step).items]
        asked = [right for right in judged if right is not None]
        return sum(asked) >= (len(asked) if step.entry.right is None else step.entry.right)

    def _incomplete(self, run: Run) -> str | None:
        """Return the reason not to count a run if one of its trials had a seat without a person, or None."""
        if self._design.file.lobby.incomplete_counts:
            return None
        if (step := self.progress.incomplete_game(run.participant)) is not None:
            return f"a seat of {step.name} was empty or was taken by a program"
        missed = [step.name for step in run.plan if step.number in run.missed and step.entry.step is StepKind.TRIAL]
        return f"{missed[0]} could not be played, because a person of the group had left" if missed else None

    def _end(self, participant: str, step: PlannedStep, outcome: StepOutcome) -> None:
        self._of_step(EventKind.STEP_ENDED, "program", participant, step, {"outcome": str(outcome)})

    def _of_step(
        self, kind: EventKind, actor: Actor, participant: str, step: PlannedStep, data: Mapping[str, JsonValue]
    ) -> LoggedEvent:
        return self._append_all([self._event_of_step(kind, actor, participant, step, data)])

    def _event_of_step(
        self, kind: EventKind, actor: Actor, participant: str, step: PlannedStep, data: Mapping[str, JsonValue]
    ) -> NewEvent:
        condition = "" if step.condition is None else self._design.conditions[step.condition].name
        return NewEvent(kind, actor, self._clocks(), participant, step.number, condition, data=data)

    def _append(
        self, kind: EventKind, actor: Actor, participant: str, data: Mapping[str, JsonValue] | None = None
    ) -> LoggedEvent:
        return self._append_all([NewEvent(kind, actor, self._clocks(), participant, data=data)])

    def _append_all(self, events: Sequence[NewEvent]) -> LoggedEvent:
        """Add events to the log, all or none of them. Return the last one."""
        # An event that is invalid at this point must not enter the log.
        numbered = [LoggedEvent(number, event) for number, event in enumerate(events, start=self.progress.sequence + 1)]
        progress = self.progress.after(numbered)
        logged = self._log.append(events)
        self.progress = progress
        for each in logged:
            self._notify(each)
        return logged[-1]

    def _notify(self, logged: LogEntry) -> None:
        if isinstance(logged, LoggedEvent):
            for listener in self.listeners:
                listener(logged)


def _word(draw: Draw, length: int) -> str:
    return "".join(LETTERS[draw(len(LETTERS))] for _ in range(length))


def _too_slow(run: Run, most_lag: float | None) -> str | None:
    """Return the reason to exclude a run if the machine was too slow for one of its games, or None."""
    if most_lag is None or run.slowest is None:
        return None
    step, lag = run.slowest
    if lag <= most_lag:
        return None
    return f"{step.name} was {lag:.1f} s behind real time; most_lag is {most_lag:g} s"


def sequences_of(entries: Iterable[LogEntry], participant: str) -> list[int]:
    """Return the numbers of all events of a participant, and of all notes that contain the participant's id."""
    return [
        entry.sequence
        for entry in entries
        if isinstance(entry, LoggedEvent)
        and (
            entry.event.participant == participant
            or (entry.event.kind == EventKind.NOTE and participant.upper() in repr(entry.event.data).upper())
        )
    ]


def unfinished(progress: Progress) -> Sequence[Run]:
    """Return the runs that can be resumed."""
    return [run for run in progress.runs.values() if run.state is RunState.UNDER_WAY]

"""Events of an experiment's log."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

JsonValue = None | bool | int | float | str | list["JsonValue"] | dict[str, "JsonValue"]

Actor = Literal["participant", "experimenter", "robot", "program"]


@dataclass(frozen=True, slots=True)
class Clocks:
    """Times of an event by all available clocks.

    Wall clocks jump, and simulated time restarts with each trial, so only the sequence orders events.

    Attributes:
        wall: date and time of day, ISO 8601 in UTC.
        monotonic_ns: nanoseconds of the clock of the process that logged the event.
        simulated: seconds of simulated time, or None outside of a trial.
        lsl: seconds of the Lab Streaming Layer's `local_clock()`, or None if no markers are sent.
    """

    wall: str
    monotonic_ns: int
    simulated: float | None = None
    lsl: float | None = None


@dataclass(frozen=True, slots=True)
class NewEvent:
    """An event, before it is in the log.

    Attributes:
        kind: name of its kind, such as "item-given".
        actor: who caused it.
        clocks: times of the event.
        participant: id of the person of the run; empty if it belongs to no person.
        step: number of the step of that run, from 1; 0 if it belongs to no step.
        condition: name of the condition of that step; may be empty.
        cause: sequence number of the event that caused it; 0 if there is none.
        data: further data.
    """

    kind: str
    actor: Actor
    clocks: Clocks
    participant: str = ""
    step: int = 0
    condition: str = ""
    cause: int = 0
    data: Mapping[str, JsonValue] | None = None


@dataclass(frozen=True, slots=True)
class LoggedEvent:
    """An event of the log.

    Attributes:
        sequence: number in the log, from 1, without gaps.
        event: the event.
    """

    sequence: int
    event: NewEvent


@dataclass(frozen=True, slots=True)
class Tombstone:
    """An event that was deleted by a withdrawal.

    Attributes:
        sequence: number of the deleted event.
    """

    sequence: int


LogEntry = LoggedEvent | Tombstone


class EventKind(StrEnum):
    """Kinds of events that change the progress of a run; a log may have other kinds."""

    RUN_BEGUN = "run-begun"
    """Data: place."""
    STEP_BEGUN = "step-begun"
    STEP_RESUMED = "step-resumed"
    """A program resumed a step that another one had begun. Data: from, a `ResumeRule`."""
    ITEM_SHOWN = "item-shown"
    """Data: item, and options, the answers of a choice in the order shown, if it differs between participants."""
    ITEM_TOUCHED = "item-touched"
    """A person has begun to answer an item. Data: item."""
    ITEM_CHANGED = "item-changed"
    """Data: item, answer."""
    ITEM_GIVEN = "item-given"
    """An answer is final for now: the person continued. Data: item, answer."""
    ITEM_TIMED_OUT = "item-timed-out"
    """The time limit of an item has closed it. Data: item, and answer, the answer so far or null."""
    WENT_BACK = "went-back"
    """A person went back to an earlier page of the current form. Data: page, its number from 1."""
    GAME_PLAYED = "game-played"
    """A trial has its recording. Data: bag, sha256, and measures of the game."""
    PRACTICE_PLAYED = "practice-played"
    """A practice game has ended. Data: amounts by `PracticeTerm`, and missing, the unmet requirements."""
    STEP_ENDED = "step-ended"
    """Data: outcome."""
    RECRUITING_CODE = "recruiting-code"
    """A person has entered the code from a recruiting service. Data: code."""
    CONSENT_ANSWERED = "consent-answered"
    """Data: agrees, and version, the SHA-256 of the text's bytes."""
    TEXT_PASTED = "text-pasted"
    """Text was pasted into a free answer, so the person may not have written it. Data: item, and characters, their
    number."""
    FOCUS_LOST = "focus-lost"
    """Another window took the keyboard focus: the person looked at something else."""
    FOCUS_REGAINED = "focus-regained"
    """The study's window has the keyboard focus again."""
    INSTRUCTIONS_OPENED = "instructions-opened"
    """A participant opened the instructions again; in a game, with its rules and keys."""
    INSTRUCTIONS_CLOSED = "instructions-closed"
    """A participant closed the instructions."""
    GAME_BROKEN_OFF = "game-broken-off"
    """A game was abandoned after its program died, and another game begins instead. Data: bag, the incomplete recording
    next to the person's other files, or none."""
    RECORDING_CUT_OFF = "recording-cut-off"
    """The recording of a game was cut off with its program. The game resumes, and another file records all of it. Data:
    bag, the file next to the person's other files."""
    FAREWELL_READ = "farewell-read"
    """A person has left the last page, with the completion code or the reason why the run ended."""
    RUN_ENDED = "run-ended"
    """Data: outcome and reason; for a complete run, its completion code; and excluded, the reason why a run that
    reached its end does not count."""
    RUN_EXCLUDED = "run-excluded"
    """The experimenter excluded a run. Data: reason."""
    REHEARSED = "rehearsed"
    """Simulated people take part from now on. Data: seed."""
    NOTE = "note"
    """Text from the experimenter. Data: text."""


class StepOutcome(StrEnum):
    """Outcome of a step."""

    DONE = "done"
    FAILED = "failed"
    """A check that was not passed."""
    PASSED_OVER = "passed over"
    """A step that the person's condition or answers do not call for."""
    LOST = "lost"
    """A step that could not resume after a crash, and must not restart."""


class RunState(StrEnum):
    """State of a person's run."""

    UNDER_WAY = "under way"
    COMPLETE = "complete"
    DECLINED = "declined"
    LEFT = "left"
    EXCLUDED = "excluded"


WITHDRAWN = "withdrawn"
"""Kind of the event by which rows were deleted; its data has their numbers and no names."""

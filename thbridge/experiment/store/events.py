"""Events of an experiment's log."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

JsonValue = None | bool | int | float | str | list["JsonValue"] | dict[str, "JsonValue"]

Actor = Literal["participant", "experimenter", "robot", "program"]


@dataclass(frozen=True, slots=True)
class Clocks:
    """The times at which something happened, by all clocks that there are.

    Wall clocks jump, and simulated time begins anew with each trial: events are ordered by their sequence alone.

    Attributes:
        wall: date and time of day, ISO 8601 in UTC.
        monotonic_ns: nanoseconds of the clock of the process that saw it.
        simulated: seconds of simulated time; None outside of a trial.
        lsl: seconds of the Lab Streaming Layer's `local_clock()`; None where no markers are sent.
    """

    wall: str
    monotonic_ns: int
    simulated: float | None = None
    lsl: float | None = None


@dataclass(frozen=True, slots=True)
class NewEvent:
    """Something that happened, before it is in the log.

    Attributes:
        kind: its name, such as "answer-given".
        actor: who did it.
        clocks: the times at which it happened.
        participant: id of the person whose run it belongs to; empty: nobody's.
        step: number of the step of that run, from 1; 0: no step's.
        condition: name of the condition of that step; empty: none.
        cause: sequence number of the event from which it follows; 0: from none.
        data: what else there is to say.
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
        sequence: its number, from 1, without gaps.
        event: what happened.
    """

    sequence: int
    event: NewEvent


@dataclass(frozen=True, slots=True)
class Tombstone:
    """An event that was deleted because somebody withdrew.

    Attributes:
        sequence: the number that it had.
    """

    sequence: int


LogEntry = LoggedEvent | Tombstone


class EventKind(StrEnum):
    """Kinds of events by which a run goes on; there are others."""

    RUN_BEGUN = "run-begun"
    """Data: place."""
    STEP_BEGUN = "step-begun"
    STEP_RESUMED = "step-resumed"
    """A program went on with a step that another one had begun."""
    ITEM_SHOWN = "item-shown"
    """Data: item, and options, the answers of a choice in the order shown, where it differs between participants."""
    ITEM_TOUCHED = "item-touched"
    """A person has begun to answer an item. Data: item."""
    ITEM_CHANGED = "item-changed"
    """Data: item, answer."""
    ITEM_GIVEN = "item-given"
    """An answer is final for now: the person went on from it. Data: item, answer."""
    ITEM_TIMED_OUT = "item-timed-out"
    """The time limit of an item was over: it is closed with the answer so far. Data: item, answer, null without one."""
    WENT_BACK = "went-back"
    """A person has gone back to an earlier page of the form that they fill in. Data: page, its number from 1."""
    GAME_PLAYED = "game-played"
    """A trial has its recording. Data: bag, sha256, and measures of the game."""
    PRACTICE_PLAYED = "practice-played"
    """A practice game has ended. Data: what was done in it, by `PracticeTerm`, and missing, the terms not met."""
    STEP_ENDED = "step-ended"
    """Data: outcome."""
    RECRUITING_CODE = "recruiting-code"
    """A person has told the code that a recruiting service gave them. Data: code."""
    CONSENT_ANSWERED = "consent-answered"
    """Data: agrees, and version, the SHA-256 of the text's bytes."""
    TEXT_PASTED = "text-pasted"
    """Text was pasted into a free answer, which may have been written by somebody or something else. Data: item,
    characters, their number."""
    FOCUS_LOST = "focus-lost"
    """Keys and clicks went to another window from here on: the person looked at something else."""
    FOCUS_REGAINED = "focus-regained"
    """Keys and clicks come to the study's window again."""
    INSTRUCTIONS_OPENED = "instructions-opened"
    """A participant opened the instructions to read them again; in a game, with its rules and keys."""
    INSTRUCTIONS_CLOSED = "instructions-closed"
    """They closed them."""
    GAME_BROKEN_OFF = "game-broken-off"
    """A game whose program died was not gone on with; another begins in its place. Data: bag, the file beside the
    person's others that is left of its recording, or none."""
    RECORDING_CUT_OFF = "recording-cut-off"
    """The recording of a game ended with its program. The game goes on, and is recorded whole in another file. Data:
    bag, the file beside the person's others."""
    FAREWELL_READ = "farewell-read"
    """A person has left the last page, with the completion code or the reason why the run ended."""
    RUN_ENDED = "run-ended"
    """Data: outcome, reason, and of a complete run its completion code; excluded, the reason why a run that came to its
    end does not count."""
    RUN_EXCLUDED = "run-excluded"
    """The experimenter decides that a run does not count. Data: reason."""
    REHEARSED = "rehearsed"
    """From here on simulated people take part. Data: seed."""
    NOTE = "note"
    """Words of the experimenter. Data: text."""


class StepOutcome(StrEnum):
    """Ways in which a step ends."""

    DONE = "done"
    FAILED = "failed"
    """A check that was not passed."""
    PASSED_OVER = "passed over"
    """The answers given do not ask for it."""
    LOST = "lost"
    """It could not continue after a crash, and was not to restart."""


class RunState(StrEnum):
    """States of a person's run."""

    UNDER_WAY = "under way"
    COMPLETE = "complete"
    DECLINED = "declined"
    LEFT = "left"
    EXCLUDED = "excluded"


WITHDRAWN = "withdrawn"
"""Kind of the event by which rows were deleted; its data names them and nobody."""

"""Events of an experiment's log."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

JsonValue = None | bool | int | float | str | list["JsonValue"] | dict[str, "JsonValue"]

Actor = Literal["participant", "experimenter", "robot", "program"]


@dataclass(frozen=True, slots=True)
class Clocks:
    """Times of an event, from all available clocks.

    Only the sequence number gives the order of events, because wall clocks may jump and simulated time restarts with
    each trial.

    Attributes:
        wall: date and time of day, ISO 8601 in UTC.
        monotonic_ns: nanoseconds of the clock of the process that logged the event.
        simulated: seconds of simulated time, or None outside of a trial.
        lsl: time of the Lab Streaming Layer's `local_clock()`, s. None if no markers are sent.
    """

    wall: str
    monotonic_ns: int
    simulated: float | None = None
    lsl: float | None = None


@dataclass(frozen=True, slots=True)
class NewEvent:
    """An event that is not yet in the log.

    Attributes:
        kind: kind of the event, such as "item-given".
        actor: the participant, experimenter, robot or program that caused the event.
        clocks: times of the event.
        participant: id of the person; empty if the event belongs to no person.
        step: number of the step in the person's run, from 1; 0 if the event belongs to no step.
        condition: name of the step's condition; may be empty.
        cause: sequence number of the event that caused this event; 0 if there is none.
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
        sequence: number of the event in the log, from 1, without gaps.
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


class FrontEnd(StrEnum):
    """Program in which a person takes part."""

    WINDOW = "window"
    """The window of the kiosk."""
    BROWSER = "browser"


class EventKind(StrEnum):
    """Kinds of events, with the keys of their data. A log may have further kinds."""

    RUN_BEGUN = "run-begun"
    """Data: `place`; `front_end`: a `FrontEnd`; for people with a link also `external_id`: the code or the first
    parameter of the link, and `parameters`: all kept parameters of the link."""
    STEP_BEGUN = "step-begun"
    STEP_RESUMED = "step-resumed"
    """A program resumed a step that another program had begun. Data: `from`: a `ResumeRule`."""
    ITEM_SHOWN = "item-shown"
    """Data: `item`; for a shuffled choice also `options`: the answers in the order shown."""
    ITEM_TOUCHED = "item-touched"
    """A person has begun to answer an item. Data: `item`."""
    ITEM_CHANGED = "item-changed"
    """Data: `item`, `answer`."""
    ITEM_GIVEN = "item-given"
    """A person has given an answer and continued. Data: `item`, `answer`."""
    ITEM_TIMED_OUT = "item-timed-out"
    """An item was closed at its time limit. Data: `item`; `answer`: the present answer or null."""
    WENT_BACK = "went-back"
    """A person went back to an earlier page of the current form. Data: `page`: the number of this page from 1."""
    GAME_PLAYED = "game-played"
    """The game of a trial was played and recorded. Data: `bag`, `sha256`, and measures of the game. In a game of
    several people, each person of the game has this event, also with `group` and `seat`."""
    PRACTICE_PLAYED = "practice-played"
    """A practice game has ended. Data: amounts by `PracticeTerm`; `missing`: the unmet requirements."""
    GROUP_FORMED = "group-formed"
    """A person got a seat in a game of several people. The log gets these events of all people of a group at once.
    Data: `group`: id of the group; `seat`; `seats`: for each seat of the game, its holder (person, program or empty);
    `waited_s`: time in the lobby."""
    SEAT_LEFT = "seat-left"
    """A person left a game of several people, or was absent from it for too long. Their seat is empty. The event does
    not name the person. Data: `group`, `seat`."""
    SEAT_FILLED = "seat-filled"
    """A program took a seat that a person had left. Data: `group`, `seat`."""
    SEAT_RESUMED = "seat-resumed"
    """A person came back to their seat. Data: `group`, `seat`."""
    STEP_ENDED = "step-ended"
    """Data: `outcome`. For a game that was skipped because a person of the group had left, also `unmatched`: true."""
    RECRUITING_CODE = "recruiting-code"
    """A person has entered the code from a recruiting service. Data: `code`."""
    CONSENT_ANSWERED = "consent-answered"
    """Data: `agrees`; `version`: the SHA-256 of the text's bytes."""
    TEXT_PASTED = "text-pasted"
    """Text was pasted into a free answer, so the person may not have written it. Data: `item`; `characters`: the number
    of pasted characters."""
    FOCUS_LOST = "focus-lost"
    """Another window has the keyboard focus, so the person may look at something else."""
    FOCUS_REGAINED = "focus-regained"
    """The study's window has the keyboard focus again."""
    INSTRUCTIONS_OPENED = "instructions-opened"
    """A participant opened the instructions again. In a game, they include rules and keys."""
    INSTRUCTIONS_CLOSED = "instructions-closed"
    """A participant closed the instructions."""
    CONNECTION_MEASURED = "connection-measured"
    """State of the connection to a browser. Data: `round_trip_ms`: last measured time from the server to the browser
    and back; `greatest_round_trip_ms`: largest value since the last event of this kind."""
    ABSENT = "absent"
    """A person in a browser is absent. Data: `seconds`: duration of the absence so far; `connected`: true if the page
    is connected and hidden, false without a connection; `round_trip_ms`."""
    PRESENT = "present"
    """An absent person is present again. Data: `seconds`: duration of the absence; `round_trip_ms`."""
    ACTED = "acted"
    """A person acted in a game in a browser. Data: `act`: kind of the act; `view_age_ms`: time from the moment at which
    the server sent the page on which the person acted to the arrival of the act."""
    GAME_BROKEN_OFF = "game-broken-off"
    """A game was abandoned after a crash of its program, and another game starts instead. Data: `bag`: the incomplete
    recording in the person's folder, or null."""
    RECORDING_CUT_OFF = "recording-cut-off"
    """The recording of a game is incomplete after a crash of its program. The game resumes, and another file records
    the complete game. Data: `bag`: the incomplete file in the person's folder."""
    FAREWELL_READ = "farewell-read"
    """A person has closed the last page, which shows the completion code or the reason why the run ended."""
    RUN_ENDED = "run-ended"
    """Data: `outcome`, `reason`. For a complete run, also `code`: the completion code. For a complete run that does not
    count, also `excluded`: the reason. For a person who was absent for too long, also `absent`: true. For a person who
    waited in vain for other people, also `unmatched`: true.
    If the experimenter ended the run and is known, also `author`."""
    RUN_EXCLUDED = "run-excluded"
    """The experimenter excluded a run. Data: `reason`; `author` if it is known."""
    REHEARSED = "rehearsed"
    """Simulated people take part from now on. Data: `seed`."""
    ADMISSION_CLOSED = "admission-closed"
    """The experimenter has closed admission: no new person can begin. Data: `author`."""
    ADMISSION_OPENED = "admission-opened"
    """The experimenter has opened admission again. Data: `author`."""
    MESSAGE_SENT = "message-sent"
    """The experimenter has sent a message to a person. Data: `text`, `author`."""
    MESSAGE_CLOSED = "message-closed"
    """A person has closed a message of the experimenter."""
    NOTE = "note"
    """Note of the experimenter. Data: `text`."""


class StepOutcome(StrEnum):
    """Outcome of a step."""

    DONE = "done"
    FAILED = "failed"
    """The person did not pass the check."""
    PASSED_OVER = "passed over"
    """The step was skipped, because it is for another condition or other answers."""
    LOST = "lost"
    """The step could not resume after a crash, and must not restart."""


class RunState(StrEnum):
    """State of a person's run."""

    UNDER_WAY = "under way"
    COMPLETE = "complete"
    DECLINED = "declined"
    LEFT = "left"
    EXCLUDED = "excluded"


WITHDRAWN = "withdrawn"
"""Kind of the event that lists deleted rows. Its data contain only the numbers of these rows."""

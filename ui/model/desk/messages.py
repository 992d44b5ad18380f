"""Messages between the program that runs a study with people (host) and the researcher's window (desk).

Each `DeskState` contains everything that the desk shows, and replaces all earlier states. The docstring of each
message begins with the sender of the message.
"""

from typing import TypeAlias

import msgspec

from ui.model.shared.window_protocol import WindowProtocol


class DeskCell(msgspec.Struct, frozen=True):
    """Cell: a combination of levels of the factors between people.

    Attributes:
        name: the levels in words.
        planned: number of planned runs that count.
        counted: number of runs that count so far.
        under_way: number of runs in progress that can still count.
    """

    name: str
    planned: int
    counted: int
    under_way: int


class DeskRun(msgspec.Struct, frozen=True):
    """Run of a person.

    Attributes:
        participant: id of the person.
        cell: name of the person's cell.
        order: the person's conditions in words, in the order of the games.
        state: state of the run, as in `RunState`.
        reason: reason why the run was excluded or the person left.
        step: number of the next or current step, from 1; after the end, the number of the last step.
        steps: number of the person's steps; steps that their condition skips do not count.
        step_name: name of the step; empty after the last step.
        step_kind: kind of the step; empty after the last step.
        under_way: True during the step.
        since: date and time at which the step began or the run ended; ISO 8601 in UTC.
        minutes: minutes from the beginning of the run until its end or, during the run, until now.
        missing: ids of required items of the current form that have no answer.
        lag: largest lag of the person's games behind real time in seconds; None if unknown.
        front_end: program in which the person takes part, as in `Run`; empty if it is unknown.
        group: id of the person's latest group in a game of several people; empty if there is none.
        seat: words for the person's seat in this game.
    """

    participant: str
    cell: str
    order: tuple[str, ...]
    state: str
    reason: str
    step: int
    steps: int
    step_name: str
    step_kind: str
    under_way: bool
    since: str
    minutes: float
    missing: tuple[str, ...] = ()
    lag: float | None = None
    front_end: str = ""
    group: str = ""
    seat: str = ""


class DeskSeat(msgspec.Struct, frozen=True):
    """Seat in a game of several people.

    Attributes:
        label: words for the seat.
        holder: its present holder: person, program or empty.
        participant: id of the person whose seat it is; empty if it has none, or if the person withdrew.
    """

    label: str
    holder: str
    participant: str


class DeskGroup(msgspec.Struct, frozen=True):
    """Game of several people.

    Attributes:
        group: id of the group.
        step_name: name of the game's step.
        seats: seats of the game.
        played: True after the game has ended.
    """

    group: str
    step_name: str
    seats: tuple[DeskSeat, ...]
    played: bool


class DeskEvent(msgspec.Struct, frozen=True):
    """Event of the log in words; answers of people are omitted.

    Attributes:
        sequence: number of the event in the log.
        wall: date and time of day, ISO 8601 in UTC.
        actor: person or program that caused the event.
        words: the event in words for people.
    """

    sequence: int
    wall: str
    actor: str
    words: str


class DeskNote(msgspec.Struct, frozen=True):
    """Note of the experimenter.

    Attributes:
        wall: date and time of day, ISO 8601 in UTC.
        participant: id of the person that the note is about; empty for a note on the study.
        text: the note.
    """

    wall: str
    participant: str
    text: str


class DeskMessage(msgspec.Struct, frozen=True):
    """Message of an experimenter to a person.

    Attributes:
        wall: date and time of day, ISO 8601 in UTC.
        participant: id of the person.
        author: name of the experimenter.
        text: the message.
        closed: True if the person has closed the message.
    """

    wall: str
    participant: str
    author: str
    text: str
    closed: bool


class DeskState(msgspec.Struct, frozen=True, tag=True):
    """Host: the contents of the desk.

    Attributes:
        title: title of the study.
        planned: number of planned runs that count.
        counted: number of runs that count so far.
        cells: combinations of levels, with their numbers of runs.
        changed: sentences about changes since the study was frozen. If None, the study is not frozen.
        runs: runs in the order in which they began.
        kiosk: description of the page that the kiosk shows now; empty if unknown.
        troubles: sentences about problems that need attention.
        notes: notes of the experimenter, in the order of writing.
        messages: messages to people, in the order of sending.
        shown: id of the person whose events are listed; empty if there is none.
        events: events of that person, in the order of time.
        no_next: reason why the next person cannot begin now; empty if the next person can begin.
        rehearsal: True if the people are simulated.
        read_only: reason why the desk cannot send requests; empty if requests are possible.
        pace: sentence on the lag of games behind real time; empty if no game runs in real time.
        groups: games of several people, in the order in which they began. If None, the study has no such games.
    """

    title: str
    planned: int
    counted: int
    cells: tuple[DeskCell, ...] = ()
    changed: tuple[str, ...] | None = None
    runs: tuple[DeskRun, ...] = ()
    kiosk: str = ""
    troubles: tuple[str, ...] = ()
    notes: tuple[DeskNote, ...] = ()
    messages: tuple[DeskMessage, ...] = ()
    shown: str = ""
    events: tuple[DeskEvent, ...] = ()
    no_next: str = ""
    rehearsal: bool = False
    read_only: str = ""
    pace: str = ""
    groups: tuple[DeskGroup, ...] | None = None


class NextParticipant(msgspec.Struct, frozen=True, tag=True):
    """Desk: let the next person begin at the kiosk."""


class ShowRun(msgspec.Struct, frozen=True, tag=True):
    """Desk: show the events of this person."""

    participant: str


class WriteNote(msgspec.Struct, frozen=True, tag=True):
    """Desk: write a note about a person or, if `participant` is empty, about the study."""

    text: str
    participant: str = ""


class ExcludeRun(msgspec.Struct, frozen=True, tag=True):
    """Desk: exclude a run, with the given reason."""

    participant: str
    reason: str


class EndRun(msgspec.Struct, frozen=True, tag=True):
    """Desk: end a run at its present step, with the given reason."""

    participant: str
    reason: str


class WithdrawRun(msgspec.Struct, frozen=True, tag=True):
    """Desk: delete all data of a participant who withdraws."""

    participant: str


class MessagePeople(msgspec.Struct, frozen=True, tag=True):
    """Desk: send a message to a person or, if `participant` is empty, to all people in the study."""

    text: str
    participant: str = ""


class SetAdmission(msgspec.Struct, frozen=True, tag=True):
    """Desk: open or close admission."""

    is_open: bool


class WatchRun(msgspec.Struct, frozen=True, tag=True):
    """Desk: make the game of this person ready for `thbridge watch`."""

    participant: str


class DeskClosed(msgspec.Struct, frozen=True, tag=True):
    """Desk: the researcher closed the desk on purpose; the study continues."""


FromDesk: TypeAlias = NextParticipant | ShowRun | WriteNote | ExcludeRun | EndRun | WithdrawRun | DeskClosed

FromDeskPage: TypeAlias = ExcludeRun | EndRun | MessagePeople | SetAdmission | WatchRun
"""Requests of the desk in a browser."""

DESK: WindowProtocol[DeskState, FromDesk] = WindowProtocol(
    msgspec.json.Decoder(DeskState), msgspec.json.Decoder(FromDesk), DeskClosed(), lambda _, state: (state,)
)
"""Messages between host and desk."""

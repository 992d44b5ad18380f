"""Messages between the program that runs a study with people (host) and the researcher's window beside it (desk).

A `DeskState` is a level: it says all that is to be seen, and the latest counts.
"""

from typing import TypeAlias

import msgspec

from ui.model.shared.window_protocol import WindowProtocol


class DeskCell(msgspec.Struct, frozen=True):
    """A combination of levels between people.

    Attributes:
        name: its levels in words.
        planned: runs that are to count.
        counted: runs that count.
        under_way: runs that may yet count.
    """

    name: str
    planned: int
    counted: int
    under_way: int


class DeskRun(msgspec.Struct, frozen=True):
    """A person's run.

    Attributes:
        participant: their id.
        cell: the name of their cell.
        order: their conditions in words, in their order.
        state: how far the run is, as `RunState` has it.
        reason: for being excluded, or for leaving.
        step: number of the step that comes next or is under way, from 1; that of the last when all are done.
        steps: number of the person's steps, without those that are passed over in their condition.
        step_name: its name; empty beyond the last.
        step_kind: its kind; empty beyond the last.
        under_way: True while it is.
        since: date and time of day at which that began, or the run ended; ISO 8601 in UTC.
        minutes: from the beginning of the run until now, or until its end.
        missing: ids of the items of the form under way that must be answered and are not.
        lag: largest lag of the person's games behind real time in seconds; None if none is known.
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


class DeskEvent(msgspec.Struct, frozen=True):
    """An event of the log in words; an answer itself is not among them.

    Attributes:
        sequence: its number in the log.
        wall: date and time of day, ISO 8601 in UTC.
        actor: who did it.
        words: for people.
    """

    sequence: int
    wall: str
    actor: str
    words: str


class DeskNote(msgspec.Struct, frozen=True):
    """A note of the experimenter.

    Attributes:
        wall: date and time of day, ISO 8601 in UTC.
        participant: id of the person that it is about; empty: nobody's.
        text: the note.
    """

    wall: str
    participant: str
    text: str


class DeskState(msgspec.Struct, frozen=True, tag=True):
    """Host: all that the desk shows.

    Attributes:
        title: of the study.
        planned: runs that are to count.
        counted: runs that count.
        cells: by combinations of levels between people.
        changed: what has changed since the study was frozen, in sentences; None: it is not frozen.
        runs: in the order in which they began.
        kiosk: what people see at the kiosk now, in words; empty: it is not known.
        troubles: sentences about what somebody has to look at.
        notes: the experimenter's, in their order.
        shown: id of the person whose events are told; empty: nobody's.
        events: of that person, in their order.
        no_next: why nobody can begin now; empty: somebody can.
        rehearsal: True when the people are simulated.
        read_only: why nothing can be asked from here; empty: it can.
        pace: sentence on how far games were behind real time; empty: no game has a real time.
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
    shown: str = ""
    events: tuple[DeskEvent, ...] = ()
    no_next: str = ""
    rehearsal: bool = False
    read_only: str = ""
    pace: str = ""


class NextParticipant(msgspec.Struct, frozen=True, tag=True):
    """Desk: let the next person begin at the kiosk."""


class ShowRun(msgspec.Struct, frozen=True, tag=True):
    """Desk: tell the events of this person."""

    participant: str


class WriteNote(msgspec.Struct, frozen=True, tag=True):
    """Desk: take down a note, about a person unless `participant` is empty."""

    text: str
    participant: str = ""


class ExcludeRun(msgspec.Struct, frozen=True, tag=True):
    """Desk: this run does not count, for this reason."""

    participant: str
    reason: str


class EndRun(msgspec.Struct, frozen=True, tag=True):
    """Desk: this run ends where it is, for this reason."""

    participant: str
    reason: str


class WithdrawRun(msgspec.Struct, frozen=True, tag=True):
    """Desk: delete everything of this participant, who withdraws."""

    participant: str


class DeskClosed(msgspec.Struct, frozen=True, tag=True):
    """Desk: the researcher closed it on purpose; the study goes on."""


FromDesk: TypeAlias = NextParticipant | ShowRun | WriteNote | ExcludeRun | EndRun | WithdrawRun | DeskClosed

DESK: WindowProtocol[DeskState, FromDesk] = WindowProtocol(
    msgspec.json.Decoder(DeskState), msgspec.json.Decoder(FromDesk), DeskClosed(), lambda _, state: (state,)
)
"""The messages of the desk."""

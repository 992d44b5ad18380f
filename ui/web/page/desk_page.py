"""Page of the researcher's desk in a browser, with all its words."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from thbridge.dialogue.wording.texts import Texts
from ui.model.desk.messages import DeskRun, DeskState
from ui.model.desk.rows import local_time, ordered_runs

UNDER_WAY = "under way"
"""State of a run in progress, as in `RunState`."""

PEOPLE = (
    "participant",
    "state",
    "step",
    "since",
    "front_end",
    "connection",
    "round_trip",
    "lag",
    "cell",
    "actions",
)
"""Columns of the table of people."""


@dataclass(frozen=True, slots=True)
class PersonNow:
    """Browser of a person at present.

    Attributes:
        connection: `here`, `away` (the page is hidden) or `gone` (not connected).
        round_trip: last round-trip time in milliseconds; None before the first.
        lag: time by which the person's game is behind real time, seconds.
        plays: True if the person has a game.
        watch: command with which the researcher watches the game; empty before it was requested.
        watch_host: machine on which to run this command; empty for the machine of the study.
        game: name of the person's game of several people; empty without one.
        seat: words for the person's seat in this game.
        waited: seconds for which the person has waited in the lobby; None outside it.
    """

    connection: str
    round_trip: float | None
    lag: int
    plays: bool
    watch: str = ""
    watch_host: str = ""
    game: str = ""
    seat: str = ""
    waited: int | None = None


@dataclass(frozen=True, slots=True)
class DeskNow:
    """All data of the page except the study's state.

    Attributes:
        people: browsers of people, by their ids.
        playing: number of games.
        free: number of games that can still start.
        admits: True if new people can begin.
        may_act: True if the researcher's key allows actions.
        told: answer to the researcher's last request; empty if there is none.
    """

    people: Mapping[str, PersonNow]
    playing: int
    free: int
    admits: bool
    may_act: bool
    told: str


@dataclass(frozen=True, slots=True)
class DeskAction:
    """Button that opens a dialog or acts at once.

    Attributes:
        label: short label.
        spoken: label for screen readers.
        request: request that the button sends; a dialog adds the text of its field.
        field: name of the request's field that the dialog asks for; empty without a dialog.
        title: title of the dialog.
        note: explanation in the dialog.
        question: label of the dialog's field.
        yes: label of the button that confirms.
    """

    label: str
    spoken: str
    request: Mapping[str, str | bool]
    field: str = ""
    title: str = ""
    note: str = ""
    question: str = ""
    yes: str = ""


@dataclass(frozen=True, slots=True)
class DeskRow:
    """Row of a table: its key, the texts of its cells, its buttons, and a command below them.

    Attributes:
        key: key of the row.
        cells: texts of the cells.
        actions: buttons.
        mark: state for the look of the row; empty for the normal look.
        note: explanation of the command.
        command: command to copy; empty if there is none.
    """

    key: str
    cells: tuple[str, ...]
    actions: tuple[DeskAction, ...] = ()
    mark: str = ""
    note: str = ""
    command: str = ""


@dataclass(frozen=True, slots=True)
class DeskTable:
    """Table of the page.

    Attributes:
        heading: heading.
        columns: names of the columns.
        rows: rows.
        empty: sentence if there are no rows.
    """

    heading: str
    columns: tuple[str, ...]
    rows: tuple[DeskRow, ...]
    empty: str = ""


@dataclass(frozen=True, slots=True)
class DeskPage:
    """The page.

    Attributes:
        language: language of the page.
        title: title.
        sentences: sentences about runs, games and admission.
        problems: sentences about problems; one sentence if there are none.
        has_problems: True if there are problems.
        problems_heading: heading of the problems.
        actions: buttons that concern all people.
        tables: tables.
        told: answer to the last request.
        cancel: label of the button that closes a dialog.
        lost: sentence while the connection is interrupted.
    """

    language: str
    title: str
    sentences: tuple[str, ...]
    problems: tuple[str, ...]
    has_problems: bool
    problems_heading: str
    actions: tuple[DeskAction, ...]
    tables: tuple[DeskTable, ...]
    told: str
    cancel: str
    lost: str


class DeskPageMaker:
    """Maker of the desk's page.

    Args:
        texts: texts of the researcher's language.
    """

    def __init__(self, texts: Texts) -> None:
        self._texts = texts

    def page(self, state: DeskState, now: DeskNow) -> DeskPage:
        """Return the page for a state of the study."""
        texts = self._texts
        under_way = sum(run.state == UNDER_WAY for run in state.runs)
        counts = self._text(
            "counts",
            counted=str(state.counted),
            planned=str(state.planned),
            under_way=str(under_way),
            missing=str(max(state.planned - state.counted, 0)),
        )
        games = self._text("games", playing=str(now.playing), free=str(now.free))
        if state.groups is not None:
            waiting = sum(each.waited is not None for each in now.people.values())
            games = f"{games} {self._text('waiting', people=str(waiting))}"
        admission = self._text("open" if now.admits else "closed")
        view_only = () if now.may_act else (self._text("view_only"),)
        return DeskPage(
            language=texts.language,
            title=self._text("title", study=state.title),
            sentences=(counts, games, admission, *view_only),
            problems=state.troubles or (self._text("no_problems"),),
            has_problems=bool(state.troubles),
            problems_heading=self._text("problems"),
            actions=self._common_actions(now) if now.may_act else (),
            tables=(self._people(state, now), *self._teams(state, now), self._cells(state), self._messages(state)),
            told=now.told,
            cancel=self._text("cancel"),
            lost=self._text("lost"),
        )

    def _common_actions(self, now: DeskNow) -> tuple[DeskAction, ...]:
        label = self._text("close_admission" if now.admits else "open_admission")
        admission = DeskAction(label, label, {"type": "SetAdmission", "is_open": not now.admits})
        return self._message("", self._text("message_to_all"), self._text("message_to_all")), admission

    def _message(self, participant: str, label: str, title: str) -> DeskAction:
        return DeskAction(
            label=label,
            spoken=title,
            request={"type": "MessagePeople", "participant": participant},
            field="text",
            title=title,
            note=self._text("message_note"),
            question=self._text("message_text"),
            yes=self._text("send"),
        )

    def _with_reason(self, name: str, kind: str, participant: str) -> DeskAction:
        title = self._text(f"{name}_who", participant=participant)
        return DeskAction(
            label=self._text(name),
            spoken=title,
            request={"type": kind, "participant": participant},
            field="reason",
            title=title,
            note=self._text(f"{name}_note"),
            question=self._text("reason"),
            yes=self._text(name),
        )

    def _people(self, state: DeskState, now: DeskNow) -> DeskTable:
        rows = (self._person(run, now.people.get(run.participant), may_act=now.may_act) for run in ordered_runs(state))
        return self._table("people", PEOPLE, rows, "no_people")

    def _teams(self, state: DeskState, now: DeskNow) -> Iterator[DeskTable]:
        """Yield the table of games with several people and of the lobby, if there are any."""
        seated = {
            (each.game, each.seat, who): (self._text(each.connection), each.connection)
            for who, each in now.people.items()
            if each.game
        }
        # The log has the seats that programs play, and those that are empty.
        for game in state.groups or ():
            for seat in game.seats:
                if not game.played and seat.holder != "person":
                    seated[game.group, seat.label, seat.participant] = self._text(f"seat_{seat.holder}"), "away"
        rows = [DeskRow(" ".join(key), (*key, words), mark=mark) for key, (words, mark) in sorted(seated.items())]
        waiting = ((each.waited, who, each.connection) for who, each in now.people.items() if each.waited is not None)
        for waited, who, connection in sorted(waiting, reverse=True):
            cells = (self._text("lobby"), "", who, self._text("waits", time=_clock(waited)))
            rows.append(DeskRow(who, cells, mark=connection))
        if rows:
            yield self._table("teams", ("game", "seat", "participant", "state"), rows)

    def _person(self, run: DeskRun, person: PersonNow | None, *, may_act: bool) -> DeskRow:
        is_here = run.state == UNDER_WAY
        connection = round_trip = lag = ""
        if person is not None and is_here:
            connection = self._text(person.connection)
            if person.round_trip is not None:
                round_trip = self._text("milliseconds", number=f"{person.round_trip:.0f}")
            if person.plays:
                lag = self._text("seconds", number=str(person.lag))
        elif is_here:
            connection = self._text("gone")
        actions: list[DeskAction] = []
        who = run.participant
        if may_act and is_here:
            actions.append(self._message(who, self._text("message"), self._text("message_to", participant=who)))
            if person is not None and person.plays and not person.watch:
                spoken = self._text("watch_who", participant=who)
                actions.append(DeskAction(self._text("watch"), spoken, {"type": "WatchRun", "participant": who}))
            actions.append(self._with_reason("stop", "EndRun", who))
        if may_act and run.state != "excluded":
            actions.append(self._with_reason("exclude", "ExcludeRun", who))
        cells = (
            who,
            self._text(f"state_{run.state.replace(' ', '_')}"),
            self._step(run, person) if is_here else run.reason,
            local_time(run.since, "%H:%M"),
            self._text(f"front_{run.front_end}") if run.front_end else "",
            connection,
            round_trip,
            lag,
            self._cell_name(run.cell),
        )
        command = "" if person is None or not is_here else person.watch
        mark = person.connection if person is not None and is_here else run.state
        note = ""
        if person is not None and command:
            there = person.watch_host
            note = self._text("watch_note_elsewhere", host=there) if there else self._text("watch_note")
        return DeskRow(who, cells, tuple(actions), mark, note, command)

    def _step(self, run: DeskRun, person: PersonNow | None) -> str:
        name = run.step_name or self._text("last_page")
        step = self._text("step_of", step=str(run.step), steps=str(run.steps), name=name)
        if person is not None and person.waited is not None:
            return f"{step} · {self._text('waits_for_others', time=_clock(person.waited))}"
        return f"{step} · {person.game}, {person.seat}" if person is not None and person.game else step

    def _cells(self, state: DeskState) -> DeskTable:
        rows = (
            DeskRow(
                cell.name,
                (
                    self._cell_name(cell.name),
                    str(cell.counted),
                    str(cell.planned),
                    str(cell.under_way),
                    str(max(cell.planned - cell.counted, 0)),
                ),
            )
            for cell in state.cells
        )
        return self._table("cells", ("cell", "counted", "planned", "in_progress", "missing"), rows)

    def _cell_name(self, name: str) -> str:
        return self._text("everybody") if name == "everybody" else name

    def _messages(self, state: DeskState) -> DeskTable:
        rows = (
            DeskRow(
                str(number),
                (
                    local_time(message.wall, "%H:%M"),
                    message.participant,
                    message.author,
                    message.text,
                    self._text("read") if message.closed else "",
                ),
            )
            for number, message in reversed([*enumerate(state.messages)])
        )
        return self._table("messages", ("time", "to", "author", "message_text", "state"), rows, "no_messages")

    def _table(self, heading: str, columns: Iterable[str], rows: Iterable[DeskRow], empty: str = "") -> DeskTable:
        shown = tuple(rows)
        none = self._text(empty) if empty and not shown else ""
        return DeskTable(self._text(heading), tuple(map(self._text, columns)), shown, none)

    def _text(self, key: str, **values: str) -> str:
        return self._texts.text(f"desk.{key}", count=None, **values)


def _clock(seconds: int) -> str:
    return f"{seconds // 60}:{seconds % 60:02}"

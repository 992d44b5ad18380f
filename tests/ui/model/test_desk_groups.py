"""The desk's view of a study with games of several people."""

import pytest

from tests.support.studies.group_studies import group_study, rehearsed
from thbridge.experiment.progress import Progress
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import EventKind
from ui.model.desk.messages import DESK, DeskGroup, DeskSeat, DeskState
from ui.model.desk.rows import group_rows, run_rows, run_words
from ui.model.desk.state import ToldToDesk, desk_state


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory):
    folder = rehearsed(tmp_path_factory.mktemp("groups") / "study", group_study(), SimulatedPeople())
    return folder.read(), read_log(folder.log)


def seen(log, length: int) -> DeskState:
    design, entries = log
    entries = entries[:length]
    progress = Progress(design).after(entries)
    return desk_state(design, progress, entries, ToldToDesk(entries[-1].event.clocks.wall))


def test_each_run_has_its_group_and_seat(log) -> None:
    state = seen(log, len(log[1]))
    assert {run.seat for run in state.runs} == {"the driver", "the namer"}
    ((group,),) = ({run.group for run in state.runs},)
    assert [row[3] for row in run_rows(state)] == [f"{group}, {run.seat}" for run in state.runs[::-1]]
    assert f"Group {group}: {state.runs[0].seat}." in run_words(state.runs[0])
    assert DESK.decode_from_host(DESK.encode(state)) == state


def test_a_game_has_the_present_holders_of_its_seats(log) -> None:
    _, entries = log
    formed = [number for number, entry in enumerate(entries, 1) if entry.event.kind == EventKind.GROUP_FORMED]
    begun, ended = seen(log, formed[-1]), seen(log, len(entries))
    assert begun.groups is not None and ended.groups is not None
    assert [(game.played, [seat.holder for seat in game.seats]) for game in begun.groups] == [
        (False, ["person", "person"])
    ]
    assert [game.played for game in ended.groups] == [True]
    assert seen(log, formed[0] - 1).groups == ()


def test_seats_without_their_people_are_named() -> None:
    seats = (
        DeskSeat("the driver", "person", "P-1"),
        DeskSeat("the namer", "program", "P-2"),
        DeskSeat("the judge", "empty", "P-3"),
        DeskSeat("the scout", "program", ""),
        DeskSeat("the guide", "empty", ""),
        DeskSeat("the other", "person", ""),
    )
    games = (DeskGroup("G-1", "trial 1", seats, True), DeskGroup("G-2", "trial 2", seats[:2], False))
    rows = list(group_rows(DeskState("x", 1, 0, groups=games)))
    assert rows == [
        ("G-2", "trial 2", "the driver: P-1; the namer: a program, P-2 is away"),
        (
            "G-1",
            "trial 1 (ended)",
            "the driver: P-1; the namer: a program, P-2 is away; the judge: empty, P-3 is away; "
            "the scout: a program; the guide: empty; the other: a person who withdrew",
        ),
    ]

"""Page of the researcher's desk: complete in each language, for each state of a run."""

import pytest
from msgspec import structs

from thbridge.experiment.store.events import RunState
from thbridge.files.language_texts import shipped_texts
from ui.model.desk.messages import DeskCell, DeskGroup, DeskMessage, DeskRun, DeskSeat, DeskState
from ui.web.page.desk_page import DeskNow, DeskPage, DeskPageMaker, PersonNow
from ui.web.page.patches import patch

NOON = "2026-03-01T12:00:00+00:00"
STATE = DeskState(
    "Arguing",
    planned=4,
    counted=1,
    cells=(DeskCell("everybody", 4, 1, 1),),
    troubles=("The disk is full.",),
    messages=(DeskMessage(NOON, "P-A", "lab", "Hello.", closed=True),),
    runs=tuple(
        DeskRun(
            f"P-{state.name}",
            "everybody",
            (),
            str(state),
            "",
            1,
            9,
            "game",
            "trial",
            True,
            NOON,
            3.0,
            front_end=front_end,
        )
        for state, front_end in zip(RunState, ("browser", "window", "", "browser", "browser"), strict=True)
    ),
)


def now(person: PersonNow, *, may_act: bool = True) -> DeskNow:
    return DeskNow({"P-UNDER_WAY": person}, 1, 7, True, may_act, "")


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("connection", ["here", "away", "gone"])
def test_the_page_has_a_word_for_everything(language: str, connection: str) -> None:
    maker = DeskPageMaker(shipped_texts(language))
    page = maker.page(STATE, now(PersonNow(connection, 41.6, 2, plays=True)))
    people, cells, messages = page.tables
    assert all(len(row.cells) == len(people.columns) - 1 for row in people.rows)
    assert all(len(row.cells) == len(table.columns) for table in (cells, messages) for row in table.rows)
    (person,) = (row for row in people.rows if row.key == "P-UNDER_WAY")
    assert person.cells[6:8] == ("42 ms", "2 s")
    assert cells.rows[0].cells[-1] == "3"
    assert page.has_problems and page.problems == ("The disk is full.",)
    if language == "de":
        assert person.cells[1] == "läuft" and page.sentences[0].startswith("1 von 4 Durchläufen")


def test_a_game_is_watched_by_a_command_and_a_key_that_may_only_watch_has_no_actions() -> None:
    maker = DeskPageMaker(shipped_texts())
    before = maker.page(STATE, now(PersonNow("here", None, 0, plays=True)))
    after = maker.page(STATE, now(PersonNow("here", None, 0, plays=True, watch="thbridge watch 127.0.0.1:7")))
    rows = [next(row for row in page.tables[0].rows if row.key == "P-UNDER_WAY") for page in (before, after)]
    assert [action.label for action in rows[0].actions] == ["Message", "Watch game", "Stop run", "Exclude"]
    assert "Watch game" not in [action.label for action in rows[1].actions]
    assert rows[1].command == "thbridge watch 127.0.0.1:7"
    assert rows[1].note == "Run this command on the machine of the study:"
    remote = PersonNow("here", None, 0, plays=True, watch="thbridge watch 127.0.0.1:7", watch_host="10.0.0.2")
    row = next(row for row in maker.page(STATE, now(remote)).tables[0].rows if row.key == "P-UNDER_WAY")
    assert row.note == "This game runs on another machine. Run this command on 10.0.0.2:"
    difference = patch(before, after)
    assert difference is not None and len(str(difference)) < 1000
    viewed = maker.page(STATE, now(PersonNow("here", None, 0, plays=True), may_act=False))
    assert not viewed.actions and not any(row.actions for row in viewed.tables[0].rows)


def test_people_of_one_game_are_together_with_their_seats_and_the_lobby_follows() -> None:
    people = {
        "P-1": PersonNow("here", None, 0, plays=True, game="G-2", seat="the north"),
        "P-2": PersonNow("gone", None, 0, plays=True, game="G-1", seat="the south"),
        "P-3": PersonNow("here", None, 0, plays=False, waited=9),
        "P-4": PersonNow("here", None, 0, plays=True, game="G-2", seat="the judge"),
        "P-5": PersonNow("away", None, 0, plays=False, waited=75),
        "P-6": PersonNow("here", None, 0, plays=False),
    }
    maker = DeskPageMaker(shipped_texts())
    tables = maker.page(STATE, DeskNow(people, 2, 7, True, True, "")).tables
    assert tables[1].heading == "Games of several people"
    assert [row.cells for row in tables[1].rows] == [
        ("G-1", "the south", "P-2", "not connected"),
        ("G-2", "the judge", "P-4", "present"),
        ("G-2", "the north", "P-1", "present"),
        ("lobby", "", "P-5", "has waited 1:15"),
        ("lobby", "", "P-3", "has waited 0:09"),
    ]
    alone = maker.page(STATE, DeskNow({"P-6": people["P-6"]}, 0, 7, True, True, "")).tables
    assert "Games of several people" not in [table.heading for table in alone]


def test_the_table_of_people_has_groups_seats_and_waits() -> None:
    seats = (DeskSeat("the north", "person", "P-UNDER_WAY"), DeskSeat("the judge", "program", "P-9"))
    guide = DeskSeat("the guide", "empty", "")
    groups = (DeskGroup("G-2", "trial", (*seats, guide), False), DeskGroup("G-1", "trial", seats, True))
    state = structs.replace(STATE, groups=groups)
    maker = DeskPageMaker(shipped_texts())

    def page(person: PersonNow) -> DeskPage:
        return maker.page(state, DeskNow({"P-UNDER_WAY": person}, 1, 5, True, True, ""))

    def step(shown: DeskPage) -> str:
        return next(row for row in shown.tables[0].rows if row.key == "P-UNDER_WAY").cells[2]

    plays = page(PersonNow("here", None, 0, plays=True, game="G-2", seat="the north"))
    assert step(plays).endswith(" · G-2, the north")
    assert "People in the lobby: 0." in plays.sentences[1]
    assert [row.cells for row in plays.tables[1].rows] == [
        ("G-2", "the guide", "", "empty"),
        ("G-2", "the judge", "P-9", "played by a program"),
        ("G-2", "the north", "P-UNDER_WAY", "present"),
    ]
    waits = page(PersonNow("here", None, 0, plays=False, waited=35))
    assert step(waits).endswith(" · waits for others, 0:35")
    assert "People in the lobby: 1." in waits.sentences[1]
    alone = maker.page(STATE, DeskNow({"P-UNDER_WAY": PersonNow("here", None, 0, plays=True)}, 1, 5, True, True, ""))
    assert "·" not in step(alone) and "lobby" not in alone.sentences[1]

"""People of a game with several seats, and the texts that they send each other."""

import math

import pytest

from tests.support.hunts.participant_views import model_of, view
from tests.support.hunts.people_in_a_hunt import HuntOfPeople, PersonAtTerminal
from tests.support.hunts.seated_hunt import SeatedHunt
from thbridge.hunt.events import PersonRead, PersonSaid
from thbridge.hunt.seats import Seat
from thbridge.roles.shared.notices import KEEPER, FloorPlan
from thbridge.roles.shared.team_notices import LONGEST_TEXT
from thbridge.text_protocol.wire.notice_format import encode_notice
from ui.model.playing.keys import act_for
from ui.model.playing.participant import Participant
from ui.model.playing.screen import ChooseAddressee, GoToPeople, MarkReadAct, SayToPeopleAct, WriteText


@pytest.fixture
def hunt():
    playing = HuntOfPeople()
    playing.run()
    return playing


def said(hunt):
    return [entry for entry in hunt.hunt.log.entries if isinstance(entry, PersonSaid)]


def test_one_participant_has_no_panel_and_no_key_for_people():
    screen = model_of(view()).screen(0.0)
    assert screen.people is None
    assert act_for("T", screen) is None


def test_the_panel_shows_who_is_there_and_commands_which_robots(hunt):
    panel = hunt.people["driver"].panel
    assert (panel.own.name, panel.own.commands) == ("You, the driver", "commands robot 1 and robot 2")
    assert [(row.name, row.presence, row.commands) for row in panel.others] == [
        ("the namer", "here", "commands no robot"),
        ("the scout", "here", "commands robot 3"),
    ]
    assert panel.own.may == "May take over robots and end the game early."


def test_the_history_begins_with_who_commands_whom(hunt):
    assert hunt.people["scout"].history[1:4] == [
        "You are the scout. You command robot 3. You may name treasures and end the game early."
        " You may not take over robots.",
        "The driver commands robot 1 and robot 2.",
        "The namer commands no robot.",
    ]


def test_a_text_to_all_shows_at_once_and_then_on_every_panel(hunt):
    driver, namer = hunt.people["driver"], hunt.people["namer"]
    driver.do(SayToPeopleAct("", "I take room 3"))
    assert [(text.text, text.pending) for text in driver.panel.texts] == [("I take room 3", True)]
    hunt.run()
    assert [(text.who, text.text, text.pending) for text in driver.panel.texts] == [("You", "I take room 3", False)]
    assert namer.read == [("The driver", "I take room 3")]
    assert namer.screen.announcement.endswith(" The driver: I take room 3")


def test_a_text_to_one_is_seen_by_no_other_person(hunt):
    hunt.people["driver"].do(SayToPeopleAct("scout", "psst"))
    hunt.run()
    assert hunt.people["scout"].read == [("The driver to you only", "psst")]
    assert hunt.people["driver"].read == [("You to the scout", "psst")]
    assert hunt.people["namer"].read == []


def test_the_addressee_stays_until_another_one_is_chosen(hunt):
    driver = hunt.people["driver"]
    driver.do(ChooseAddressee("scout"))
    assert driver.panel.prompt == "Message to the scout"
    assert driver.panel.send.act == SayToPeopleAct("scout")
    driver.do(ChooseAddressee("nobody"))
    assert driver.panel.to == "scout"


def test_the_record_has_the_time_from_the_first_key_to_sending(hunt):
    driver = hunt.people["driver"]
    driver.do(WriteText("I"))
    hunt.run(50)
    driver.do(WriteText("I go"))
    hunt.run(25)
    driver.do(SayToPeopleAct("", "I go"))
    hunt.run()
    assert [(entry.seat, entry.to, entry.text) for entry in said(hunt)] == [("driver", "", "I go")]
    assert said(hunt)[0].typing == pytest.approx(1.5)


def test_texts_count_as_unread_until_they_were_shown(hunt):
    driver, namer = hunt.people["driver"], hunt.people["namer"]
    driver.do(SayToPeopleAct("", "one"))
    driver.do(SayToPeopleAct("", "two"))
    hunt.run()
    assert (namer.panel.unread, namer.panel.news, driver.panel.unread) == (2, "2 new messages", 0)
    namer.do(namer.panel.read)
    assert (namer.panel.unread, namer.panel.read) == (0, None)
    hunt.run()
    read = [(entry.seat, entry.line) for entry in hunt.hunt.log.entries if isinstance(entry, PersonRead)]
    assert read == [("namer", 2)]
    assert namer.model.requests() == ()  # The keeper knows it, so it is not reported again.


def test_a_text_that_does_not_exist_cannot_be_marked_as_read(hunt):
    namer = hunt.people["namer"]
    namer.do(MarkReadAct(99))
    hunt.run()
    hunt.people["driver"].do(SayToPeopleAct("", "hello"))
    hunt.run()
    assert namer.panel.unread == 1


def test_equal_texts_are_two_texts_and_a_repeated_request_is_one(hunt):
    driver = hunt.people["driver"]
    driver.do(SayToPeopleAct("", "ok"))
    driver.do(SayToPeopleAct("", "ok"))
    hunt.run()
    hunt.run(400)
    assert [entry.text for entry in said(hunt)] == ["ok", "ok"]


def test_texts_written_without_a_connection_arrive_later_once_and_in_their_order(hunt):
    driver = hunt.people["driver"]
    driver.away = True
    for text in ("a", "b", "c"):
        driver.do(SayToPeopleAct("", text))
    hunt.run(100)
    assert said(hunt) == []
    assert [text.pending for text in driver.panel.texts] == [True, True, True]
    driver.away = False
    driver.tabui.connected()
    hunt.run(400)
    assert [entry.text for entry in said(hunt)] == ["a", "b", "c"]
    assert [text.pending for text in driver.panel.texts] == [False, False, False]


def test_a_text_is_sent_once_if_only_its_confirmation_was_lost(hunt):
    driver = hunt.people["driver"]
    driver.do(SayToPeopleAct("", "once"))
    hunt.run(1)  # The request is on its way.
    driver.away = True
    hunt.run(100)
    assert len(said(hunt)) == 1
    assert driver.panel.texts[0].pending
    driver.away = False
    driver.tabui.run = "another run"  # The keeper knows no numbers of requests of this run.
    driver.tabui.poll_player()
    hunt.run(200)
    driver.tabui.connected()
    hunt.run(200)
    assert [entry.text for entry in said(hunt)] == ["once"]
    assert [text.pending for text in driver.panel.texts] == [False]


def test_a_program_that_joins_again_finds_all_texts_and_what_was_read(hunt):
    driver, namer = hunt.people["driver"], hunt.people["namer"]
    for number in range(20):
        driver.do(SayToPeopleAct("", f"text {number}"))
        hunt.run(60)
        if number == 14:
            namer.do(namer.panel.read)
    before = namer.panel
    again = type(namer)("namer")
    namer.model = again.model
    namer.tabui.connected()
    hunt.run()
    assert [text.text for text in namer.panel.texts] == [text.text for text in before.texts]
    assert (namer.panel.unread, len(namer.panel.texts)) == (5, 20)
    assert namer.screen.announcement.count("text") == 0


def test_a_refused_text_returns_to_the_field_with_the_reason(hunt):
    driver = hunt.people["driver"]
    for number in range(11):
        driver.do(SayToPeopleAct("", f"text {number}"))
    driver.do(WriteText("next"))
    hunt.run()
    assert driver.panel.draft == "text 10 next"
    assert driver.panel.restored == 1
    assert driver.history[-1] == "These are too many messages. Wait a little."
    assert len(said(hunt)) == 10


def test_a_text_that_is_too_long_stays_in_the_field(hunt):
    driver = hunt.people["driver"]
    long = "x" * (LONGEST_TEXT + 1)
    driver.do(WriteText(long))
    assert not driver.panel.send.enabled
    assert driver.panel.send.hint == "A message has at most 500 characters. This one has 501."
    driver.do(SayToPeopleAct("", long))
    hunt.run()
    assert (driver.panel.draft, driver.panel.restored, said(hunt)) == (long, 1, [])


def test_talk_opens_and_closes_at_the_times_of_the_study():
    hunt = HuntOfPeople(opens=1.0, closes=3.0)
    hunt.run(20)
    driver = hunt.people["driver"]
    assert not driver.panel.writes
    hunt.run(50)
    assert (driver.panel.writes, driver.panel.closed) == (True, "")
    assert driver.history[-1] == "You can send messages to each other now."
    assert act_for("T", driver.screen) == GoToPeople()
    driver.do(SayToPeopleAct("", "hello"))
    hunt.run(100)
    assert driver.panel.closed == "You cannot send messages at the moment."
    assert driver.history[-1] == "You can no longer send messages to each other."
    driver.do(SayToPeopleAct("", "too late"))
    hunt.run()
    assert [entry.text for entry in said(hunt)] == ["hello"]
    assert driver.panel.draft == "too late"


def test_a_study_without_talk_shows_the_people_but_no_field():
    hunt = HuntOfPeople(opens=math.inf)
    hunt.run()
    assert not hunt.people["driver"].panel.writes
    assert len(hunt.people["driver"].panel.others) == 2


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("<b>bold</b> &amp; <script>alert(1)</script>", "<b>bold</b> &amp; <script>alert(1)</script>"),
        ("a\nThe namer: I quit", "a The namer: I quit"),
        ("\x1b[2Jgone", "\\x1b[2Jgone"),
        ("\u202eneddih", "\\u202eneddih"),
    ],
)
def test_hostile_texts_stay_texts_on_one_line(hunt, text, shown):
    hunt.people["driver"].do(SayToPeopleAct("", text))
    hunt.run()
    assert hunt.people["namer"].read == [("The driver", shown)]
    assert said(hunt)[0].text == text


def test_the_longest_texts_reach_a_program_that_joins_again(hunt):
    driver, namer = hunt.people["driver"], hunt.people["namer"]
    for number in range(10):
        driver.do(SayToPeopleAct("", str(number) + "\U0001f916" * (LONGEST_TEXT - 1)))
    hunt.run()
    namer.model = type(namer)("namer").model
    namer.tabui.connected()
    hunt.run()
    assert len(namer.panel.texts) == 10
    longest = max(len(line.encode()) for line in hunt.hunt.lines)
    assert longest < 64 * 1024


def test_a_person_without_the_map_reads_the_same_names_of_rooms_as_the_others():
    hunt = SeatedHunt((Seat("driver", "the driver", robots=(0, 1)), Seat("blind", "the blind", sees_map=False)))
    for seat in ("driver", "blind"):
        person = Participant()
        for update in hunt.shown[seat]:
            person.receive(update, 0.0)
        assert [tile.name for tile in person.screen(0.0).tiles][:2] == ["Room 1", "Kitchen"]
    assert hunt.view("driver").team.room_names == ()
    assert not any(isinstance(update, FloorPlan) for update in hunt.shown["blind"])
    at_terminal = PersonAtTerminal("blind")
    at_terminal.tabui.step(0, [encode_notice(KEEPER, at_terminal.tabui.name, hunt.view("blind"))])
    at_terminal.type("all")
    assert any("2 (Kitchen)" in line for line in at_terminal.lines)

"""A person at the keyboard, in a hunt without a simulator."""

import re

import pytest

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator, templates
from tests.support.hunts.scripted_hunt import arguing_engine
from thbridge.app.compose.game import known_treasures
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.engine import DialogueEngine
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import shipped_texts
from thbridge.hunt.events import Condition, ConsentGiven, RobotDeparted, TreasureIdentified, TreasuresHidden
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.notices import FloorPlan, RoomOutline
from thbridge.roles.shared.robot_requests import ReleaseCommand, StationSend, TakeCommand
from thbridge.study.built_in import STANDARD
from ui.hosting.terminal_player import TerminalPlayer
from ui.model.consent_words import answer_in
from ui.model.playing.rules_sheet import rules_of

ENGLISH = shipped_texts()
QUESTION = ENGLISH.text("terminal.question")


class Seat:
    def __init__(
        self,
        briefing: Briefing | None = None,
        set_name: str = "original-2016",
        talk: DialogueEngine | None = None,
        texts: Texts = ENGLISH,
    ) -> None:
        self.shown: list[str] = []
        self.person = TerminalPlayer(self.shown.append, lambda: self.hunt.tabui.room_names, lambda: texts)
        self.hunt = HuntWithoutSimulator(
            participant=TabUI(self.person), briefing=briefing, set_name=set_name, talk=talk
        )
        self.hunt.run(6)

    def type(self, line: str, ticks: int = 8) -> list[str]:
        """Type a line; return the lines shown in answer."""
        before = len(self.shown)
        self.person.type(line)
        self.hunt.tabui.poll_player()
        self.hunt.run(ticks)
        return self.shown[before:]


@pytest.fixture
def seat():
    return Seat()


def test_a_person_is_told_how_things_stand(seat):
    assert seat.type("?") == [
        "  Robot 1: in the corridor, energy 100",
        "  Robot 2: in the corridor, energy 100",
        "  Rooms not visited: 1 2 3 4 5 6 7 8. Score 0.",
    ]


def test_questions_of_the_standard_study_are_whole_sentences_with_answers_that_fit():
    seat = Seat(set_name=STANDARD.templates)
    (asked,) = seat.type("1 3")
    assert re.fullmatch(r"Robot 1: [A-Z].* room 3.*\. Shall I go\?   \[g Go, o Not there\]", asked)
    assert seat.type("o") == []
    (asked,) = seat.type("1 4")
    assert "Shall I go?" in asked
    assert seat.type("g", 20)[0].startswith("Robot 1 sets out for room 4")


def test_a_person_hunts_by_keyboard_alone(seat):
    assert seat.type("1 3") == ["Robot 1: It will cost me 17 to go to room 3   [c Continue, s Stop]"]
    assert seat.type("c") == ["Robot 1: Are you sure?   [c Continue, s Stop]"]
    assert seat.type("c", 20)[0] == "Robot 1 sets out for room 3; it has 83 energy left."
    treasure = next(event for event in seat.hunt.log.events if isinstance(event, TreasuresHidden)).treasures[2]
    assert seat.shown[-2:] == [
        "Robot 1 is in room 3.",
        f"Room 3: something {', '.join(treasure.properties.values()).lower()}. n 3 NAME names the treasure.",
    ]
    assert seat.type("p 3") == ["Room 3: a picture is taken. The terminal cannot show it."]
    assert seat.type("names") == ["  Blue Bottle, Orange Bottle, Pink can, Yellow can"]
    assert seat.type("n 3 moon") == ["Type one of these names: Blue Bottle, Orange Bottle, Pink can, Yellow can"]
    assert seat.type(f"n 3 {treasure.name.lower()}") == [
        f"Room 3: {treasure.name} is right, {treasure.points} points won."
    ]
    assert any(isinstance(event, TreasureIdentified) for event in seat.hunt.log.events)


def test_the_name_of_a_room_stands_beside_its_number():
    outlines = tuple(
        RoomOutline(room, "Kitchen" if room == 3 else f"Room {room}", (), (0.0, 0.0, 0.0)) for room in range(1, 9)
    )
    plan = FloorPlan("stage", 0.05, (0.0, 0.0, 0.0), 1, 1, "eJxjAAAAAQAB", outlines, ())
    seat = Seat(Briefing(floor_plan=plan))
    assert "  Rooms not visited: 1 2 3 (Kitchen) 4 5 6 7 8. Score 0." in seat.shown
    for line in ("1 3", "c", "c"):
        seat.type(line, 20)
    assert "Robot 1 sets out for room 3 (Kitchen); it has 83 energy left." in seat.shown
    assert seat.shown[-2] == "Robot 1 is in room 3 (Kitchen)."
    assert seat.shown[-1].startswith("Room 3 (Kitchen): something ")
    assert "  Robot 1: in room 3 (Kitchen), energy 83" in seat.type("?")
    assert seat.type("l 3")[0].startswith("Room 3 (Kitchen): the treasure is left there.")
    assert seat.type("p 5") == ["No robot is in room 5."]


def test_the_rules_are_those_of_the_windows_sheet(seat):
    view = seat.hunt.tabui.view
    assert seat.type("rules") == [f"  {rule}" for rule in rules_of(shipped_texts(), view)]
    assert "  A right name wins the points of the treasure. A wrong name may lose points." in seat.shown


def test_names_of_files_are_read_and_typed_as_words():
    seat = Seat(Briefing(names=("beer_bottle", "beer_bottle_opener", "fuzzy_die")))
    seat.type("1 3")
    seat.type("c")
    seat.type("c", 20)
    assert seat.type("names") == ["  beer bottle, beer bottle opener, fuzzy die"]
    seat.type("n 3 beer bottle")
    assert "Room 3: Beer bottle is wrong" in seat.shown[-1]
    named = next(event for event in seat.hunt.log.events if isinstance(event, TreasureIdentified))
    assert named.name == "beer_bottle", "the journal has the name of the file"


def test_what_is_left_can_be_taken_up_again(seat):
    for line in ("1 3", "c"):
        seat.type(line)
    found = seat.type("c", 40)[-1]
    left = "Room 3: the treasure is left there. u 3 takes up the treasure again, until its robot sets out."
    assert seat.type("l 3") == [left]
    assert seat.type("u 3") == [found]
    assert found.endswith("n 3 NAME names the treasure.")


def test_stop_sends_nobody(seat):
    seat.type("2 ?")
    seat.type("s")
    assert not any(isinstance(event, RobotDeparted) for event in seat.hunt.log.events)


@pytest.mark.parametrize(
    ("typed", "answer"),
    [
        ("hello", "  1 4        talk with robot 1 about going to room 4"),
        ("9 3", "There is no such robot."),
        ("1 77", "There is no such room."),
        ("p 77", "No robot is in room 77."),
        ("n 3 moon", "No treasure has been found yet."),
        ("names", "No treasure has been found yet."),
        ("c", "No robot waits for an answer."),
        ("1 99999999999999999999", "  1 4        talk with robot 1 about going to room 4"),
    ],
)
def test_what_cannot_be_done_is_said(seat, typed, answer):
    assert seat.type(typed)[0].splitlines()[0] == answer


def test_a_person_is_told_of_robots_that_do_not_answer_or_know_where_they_are(seat):
    seat.hunt.puppets.conditions = [Condition.SILENT, Condition.LOST]
    seat.hunt.run(60)
    assert seat.shown[-2:] == ["Robot 1 no longer answers.", "Robot 2 does not know where it is."]
    assert "  Robot 2 does not know where it is." in seat.type("?")
    assert seat.type("1 3") == ["Robot 1 does not answer."]
    assert seat.hunt.view().refusal is None, "like windows, the terminal does not send what is impossible"


def test_a_person_is_told_whose_a_robot_is(seat):
    seat.hunt.session.ask("station", TakeCommand(0, "ground station 255"))
    seat.hunt.run(10)
    assert seat.shown[-1:] == ["Robot 1 is commanded by ground station 255 now."]
    assert "  Robot 1 is commanded by ground station 255." in seat.type("?")
    assert seat.type("1 3")[0].startswith("Robot 1 is commanded by ground station 255. You get it back")
    seat.hunt.session.ask("station", ReleaseCommand(0))
    seat.hunt.run(10)
    assert seat.shown[-1:] == ["Robot 1 is yours again."]


def test_a_person_may_end_the_game(seat):
    assert seat.type("end") == [
        "The game is over. Score 0.",
        "You have ended the game.",
        "0 of 8 rooms visited. No treasures named.",
        "Thank you for playing.",
    ]


def test_what_has_no_effect_is_said(seat):
    assert seat.type("a 1") == ["You command robot 1 yourself."]
    assert seat.type("u 3") == ["No robot is in room 3."]
    for line in ("1 3", "c"):
        seat.type(line)
    seat.type("c", 40)
    assert seat.type("u 3") == ["There is nothing to undo: robot 1 is not at a treasure that you left."]
    seat.hunt.session.ask("station", TakeCommand(0, "ground station 255"))
    seat.hunt.run(10)
    seat.type("a 1")
    assert seat.type("a 1") == ["You have just asked for robot 1. You can ask again in a few seconds."]


def test_what_has_been_done_is_said_and_not_done_again():
    seat = Seat(set_name="four-properties")
    for line in ("1 3", "c", "m 3 weight", "p 3", "c", "t 3 material wood"):
        seat.type(line, 30)
    events = len(seat.hunt.log.events)
    known = [line.strip() for line in seat.type("?") if line.startswith("  Room 3: ")]
    assert seat.type("p 3") == ["Room 3: a picture is taken. The terminal cannot show it."]
    assert seat.type("m 3 weight") == seat.type("t 3 material wood") == known != []
    (left,) = seat.type("l 3")
    assert left.endswith("u 3 takes up the treasure again, until its robot sets out.") and seat.type("l 3") == [left]
    assert seat.type("m 3 weight") == ["This has already been decided."]
    assert len(seat.hunt.log.events) == events + 1


def test_no_picture_is_taken_of_what_is_decided(seat):
    for line in ("1 3", "c"):
        seat.type(line)
    seat.type("c", 40)
    seat.type("l 3")
    assert seat.type("p 3") == ["This has already been decided."]


@pytest.mark.parametrize("asked", ["1 ?", "1 6"])
def test_who_repeats_a_wish_sees_the_dialogue_again(asked):
    seat = arguing()
    seat.type(asked)
    (talk,) = seat.hunt.view().dialogues
    entries = len(seat.hunt.log.entries)
    shown = [line for line in seat.type("?") if line.startswith(("  Robot 1: ", "    "))]
    assert seat.type(f"1 {talk.room}") == [line for line in shown if "energy" not in line]
    if talk.suggested:
        assert seat.type("1 ?") == seat.type(f"1 {talk.room}")
    assert len(seat.hunt.log.entries) == entries and seat.hunt.view().dialogues == (talk,)


def test_a_person_is_told_what_a_robot_that_stops_gets_back(seat):
    for line in ("1 3", "c"):
        seat.type(line)
    seat.type("c")
    stopped = next(line for line in seat.type("b 1", 20) if "stopped" in line)
    assert re.fullmatch(r"Robot 1 has stopped before room 3\. It gets [\d.]+ energy back\.", stopped)


def test_a_person_is_asked_to_take_part_before_anything_else():
    seat = Seat(Briefing(consent="We record\nwhat you do."))
    assert seat.shown == ["We record", "what you do.", QUESTION]
    assert seat.type("1 3") == [QUESTION]
    assert seat.type("Yes")[0] == "Game 1. Type rules for its rules, ? for the state of the game, h for help."
    assert [event.at[-1:] for event in seat.hunt.log.events if isinstance(event, ConsentGiven)] == ["Z"]
    assert seat.type("1 3") == ["Robot 1: It will cost me 17 to go to room 3   [c Continue, s Stop]"]


@pytest.mark.parametrize("word", ["no", " N", "No."])
def test_a_person_may_say_no(word):
    seat = Seat(Briefing(consent="We record you."))
    assert seat.type(word) == []
    assert seat.person.declined


def test_a_person_asks_for_a_robot_and_names_what_a_station_left(seat):
    for request in (TakeCommand(0, "ground station 255"), StationSend(0, 3)):
        seat.hunt.session.ask("station", request)
    seat.hunt.run(20)
    assert seat.type("a 1") == ["You have asked ground station 255 to give robot 1 back."]
    seat.hunt.session.ask("station", StationSend(0, 4))
    seat.hunt.run(3)
    assert any(line.startswith("  Room 3: something") for line in seat.type("?", 2))
    treasure = next(event for event in seat.hunt.log.events if isinstance(event, TreasuresHidden)).treasures[2]
    assert f"Room 3: {treasure.name} is right, {treasure.points} points won." in seat.type(f"n 3 {treasure.name}")
    assert not any(line.startswith("  Room 3") for line in seat.type("?"))


def test_a_person_has_more_sensed_and_tells_what_they_see():
    seat = Seat(set_name="four-properties")
    seat.type("1 3")
    seat.type("c", 20)
    kind = next(event for event in seat.hunt.log.events if isinstance(event, TreasuresHidden)).treasures[2]
    assert "m 3 weight lets the robot sense this property for 2 energy." in seat.shown[-1]
    assert seat.type("m 3 smell") == ["Robots cannot sense a property with this name."]
    assert seat.type("t 3 material wood") == ["Too little is known about the treasure in this room."]
    (line,) = seat.type("m 3 weight")
    assert f"{kind.properties['weight']} to lift" in line
    seat.type("p 3")
    seat.type("c")
    assert "t 3 material VALUE reports what you see: wood, metal, ceramic." in seat.type("?")[2]
    assert seat.type("t 3 age old") == ["People cannot report a property with this name here."]
    (line,) = seat.type("t 3 material Wood")
    assert "made of wood" in line


def arguing(condition: DialogueCondition = DialogueCondition.COLLABORATOR) -> Seat:
    return Seat(Briefing(condition=condition), talk=arguing_engine(condition))


def test_a_person_argues_by_numbers():
    seat = arguing()
    (wish, against, *answers) = seat.type("1 6")
    assert wish.startswith("You: Go to room 6")
    assert against.startswith("Robot 1: ")
    assert answers[1].startswith("  2  Why not room 6")
    asked, reasons, *_ = seat.type("2")
    assert asked.startswith("You: Why not room 6")
    assert reasons.startswith("Robot 1: ")
    assert not any(line.startswith(("You", "Robot")) for line in seat.type("3")), "a look at the questions"
    assert seat.type("9") == ["The answers are 1 to 5."]
    seat.type("5")
    left = seat.shown[-1].split()[0]
    assert seat.type(left)[-1] in {"Robot 1: Then I stay where I am for now.", "Robot 1: Then I wait here for now."}


def test_a_look_at_the_questions_of_a_robot_does_not_look_like_a_sentence():
    seat = arguing(DialogueCondition.SUPERVISOR)
    asked = seat.type("1 ?")[-1]
    question = re.search(r"(\w) I have a question", asked)
    assert asked.startswith("Robot 1: ") and question is not None
    (questions,) = seat.type(question[1])
    sentence, _, answers = questions.partition("   [")
    assert sentence == f"  {asked.partition('   [')[0]}" and "Back." in answers


def test_what_is_agreed_in_the_terminal_is_done_at_once():
    seat = arguing()
    seat.type("1 ?")
    said, *_ = seat.type("1")
    assert said.startswith("You: All right")
    assert any(isinstance(event, RobotDeparted) for event in seat.hunt.log.events)


def test_robots_that_wait_at_once_are_answered_in_any_order():
    seat = arguing()
    seat.type("1 ?")
    assert seat.type("2 ?")[-1].startswith("  2:4  ")
    assert seat.type("1") == ["Several robots wait: type 1:1 to answer the first."]
    assert seat.type("2:1")[-1].startswith("Robot 2 sets out")
    assert seat.type("2:1") == ["This robot waits for no answer."]
    assert seat.type("1:1")[-1].startswith("Robot 1 sets out")
    assert seat.type("1:1:1")[0].startswith("  1 4 ")


def test_what_is_a_persons_own_decision_is_marked():
    assert any(line.endswith("This is your decision.") for line in arguing(DialogueCondition.ADVISER).type("1 6"))


def test_who_does_not_know_what_was_found_asks_a_robot_that_argues():
    chosen = templates()
    names, kinds = tuple(sorted(kind.name for kind in chosen.kinds)), known_treasures(chosen)
    briefing = Briefing(
        names=names, properties=chosen.properties, kinds=kinds, condition=DialogueCondition.COLLABORATOR
    )
    seat = Seat(briefing, talk=arguing_engine(DialogueCondition.COLLABORATOR))
    seat.type("1 ?")
    room = seat.hunt.view().dialogues[0].room
    seat.type("1", ticks=60)
    answer = " ".join(seat.type(f"n {room} ?"))
    assert "I would say the treasure" in answer
    seat.type("1")
    (named,) = [event for event in seat.hunt.log.events if isinstance(event, TreasureIdentified)]
    assert named.name is not None and named.name in answer and named.points > 0


def test_a_person_plays_in_the_games_language():
    german = shipped_texts("de")
    seat = Seat(texts=german)
    assert seat.shown[1] == "  Roboter 1: im Flur, Energie 100"
    help_text = seat.type("hilfe")[0]
    for english, word in (("end", "ende"), ("names", "namen"), ("rules", "regeln")):
        assert f"\n  {word} " in f"\n{help_text}" and word == german.text(f"terminal.word_{english}")
    assert seat.type("Regeln") == seat.type("rules") == [f"  {rule}" for rule in rules_of(german, seat.hunt.view())]
    assert seat.type("namen") == ["Es wurde noch kein Schatz gefunden."]
    seat.type("1 3")
    seat.type("c")
    assert seat.type("c", 20)[0] == "Roboter 1 fährt zu Raum 3; er hat noch 83 Energie."
    assert "Mit „n 3 NAME“ benennen Sie den Schatz." in seat.shown[-1]
    assert seat.type("ende")[0] == "Das Spiel ist zu Ende. Punktestand: 0."


@pytest.mark.parametrize(("typed", "agrees"), [("ja", True), ("Yes.", True), ("Nein", False), ("vielleicht", None)])
def test_an_answer_may_be_in_the_games_language_or_in_english(typed, agrees):
    assert answer_in(shipped_texts("de"), typed) is agrees

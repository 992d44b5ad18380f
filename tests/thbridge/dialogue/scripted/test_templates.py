from pathlib import Path

import pytest

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator, scripted_engine
from thbridge.dialogue.moves import Ask, Dialogue, DialogueTopic, Scenario
from thbridge.dialogue.scripted.reserved_words import WORDS, word_fault, words_of
from thbridge.dialogue.scripted.templates import ScriptedQuestion, Template, TemplatePhrasing
from thbridge.dialogue.sentences import fill
from thbridge.files.language_texts import shipped_texts
from thbridge.hunt.properties import OF_2016, TreasureProperty
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.roles.keeper.dialogues import GameDialogues

ENGLISH, GERMAN = shipped_texts(), shipped_texts("de")


def test_reserved_words_become_what_people_read():
    topic = DialogueTopic(
        Scenario.TAKE_PICTURE, 0, Room(4), 5.0, 82.5, properties={"colour": "Orange", "footprint": "Round and Large"}
    )
    wording = "£robot£: £colour£, £footprint£ in room £room£; £cost£ of £energy£; £5 each"
    assert fill(wording, words_of(topic, ENGLISH)) == "1: orange, round and large in room 4; 5 of 82.5; £5 each"


@pytest.mark.parametrize(("name", "said"), [("Kitchen", "Room 4 (Kitchen)"), ("", "Room 4")])
def test_a_place_is_the_number_of_the_room_with_its_name_if_it_has_one(name, said):
    topic = DialogueTopic(Scenario.DONT_KNOW, 0, Room(4), 5.0, 82.5, room_name=name)
    assert fill("£place£ costs £cost£.", words_of(topic, ENGLISH)) == f"{said} costs 5."


@pytest.mark.parametrize("wording", ["£colour£ it is.", "Look! £colour£ it is.", "A thing. £colour£ it is."])
def test_a_word_that_begins_a_sentence_has_a_capital(wording):
    assert "Orange it is." in fill(wording, {"colour": "orange"})


def test_what_fills_a_word_is_not_filled_again():
    assert fill("£colour£", {"colour": "£room£", "room": "4"}) == "£room£"


@pytest.mark.parametrize("wording", ["£room£ £cost£", "It costs £5", "5£ or 6£", "plain"])
def test_good_wordings_pass(wording):
    assert word_fault(wording, Scenario.DONT_KNOW, OF_2016) is None


@pytest.mark.parametrize(
    ("wording", "scenario", "problem", "remedy"),
    [
        ("go to £romo£", Scenario.DONT_KNOW, "£romo£", "£room£"),
        ("go to £ROOM£", Scenario.DONT_KNOW, "£ROOM£", "£room£"),
        ("go to £xyzzy£", Scenario.DONT_KNOW, "£xyzzy£", "£cost£"),
        ("it is £colour£", Scenario.SPECIFIC_ROOM, "about a treasure", "TakePicture:"),
        ("go to £room", Scenario.DONT_KNOW, "without its partner", "£room£"),
        ("go to room£", Scenario.DONT_KNOW, "without its partner", "£room£"),
    ],
)
def test_a_bad_word_is_named_with_the_right_one(wording, scenario, problem, remedy):
    fault = word_fault(wording, scenario, OF_2016)
    assert problem in fault.problem
    assert remedy in fault.remedy


def test_a_property_of_a_set_is_a_word_beside_its_treasures_only():
    weight = (TreasureProperty("weight", "Weight"),)
    assert word_fault("It is £weight£", Scenario.TAKE_PICTURE, weight) is None
    assert "about a treasure" in word_fault("It is £weight£", Scenario.DONT_KNOW, weight).problem
    assert "£colour£" in word_fault("It is £colour£", Scenario.TAKE_PICTURE, weight).problem


def test_a_wording_that_names_what_is_unknown_is_left_out_while_there_is_another():
    both = ScriptedQuestion(("It is £weight£.", "It is there."))
    only = ScriptedQuestion(both.wordings[:1])
    template = Template("", {Scenario.TAKE_PICTURE: (both,), Scenario.TAKE_TREASURE: (only,)})

    def said(scenario, seed, **known):
        topic = DialogueTopic(scenario, 0, Room(4), 5.0, 82.5, properties=known)
        return TemplatePhrasing(template, seed, ENGLISH).say(Dialogue(1, topic), Ask(0))

    assert {said(Scenario.TAKE_PICTURE, seed) for seed in range(20)} == {"It is there."}
    assert {said(Scenario.TAKE_PICTURE, seed, weight="Heavy") for seed in range(20)} == {"It is heavy.", "It is there."}
    assert said(Scenario.TAKE_TREASURE, 1) == "It is unknown."


def test_confidence_is_said_where_the_wording_wants_it_or_else_before_it():
    named = ScriptedQuestion(("Room £room£, and I am £confidence£ sure.",))
    silent, last = ScriptedQuestion(("Room £room£?",)), ScriptedQuestion(("Now?",))

    def said(question, ask, confidence):
        template = Template("", {Scenario.DONT_KNOW: (question, last)})
        topic = DialogueTopic(Scenario.DONT_KNOW, 0, Room(4), 5.0, 82.5, confidence=confidence)
        return TemplatePhrasing(template, 1, ENGLISH).say(Dialogue(1, topic), Ask(ask))

    assert said(named, 0, 0.755) == "Room 4, and I am 76% sure."
    assert said(silent, 0, 0.7) == "I am 70% sure of my suggestion. Room 4?"
    assert said(silent, 1, 0.7) == "Now?"
    assert said(silent, 0, None) == "Room 4?"


@pytest.mark.parametrize(
    ("wording", "said"),
    [
        ("Room £room£ costs £cost£ of my £energy£ energy. Shall I go?", "Shall I go?"),
        ("It costs me £cost£ to go to room £room£", "It costs me … to go to room 4"),
        ("I suggest room £room£: £reason£. Agreed?", "I suggest room 4: my energy is enough for the way. Agreed?"),
        ("Shall I go to room £room£?", "Shall I go to room 4?"),
    ],
)
def test_sentences_with_energy_are_left_out_for_people_who_do_not_see_it(wording, said):
    template = Template("", {Scenario.DONT_KNOW: (ScriptedQuestion((wording,)),)})
    topic = DialogueTopic(Scenario.DONT_KNOW, 0, Room(4), 5.5, 82.5, reason="it costs me 5.5")
    assert TemplatePhrasing(template, 1, ENGLISH).without_energy().say(Dialogue(1, topic), Ask(0)) == said


def test_a_room_is_called_by_its_own_name_or_else_by_its_number():
    names = RoomNames.of([(3, "Kitchen"), (4, "Room 4")])
    played = HuntWithoutSimulator(set_name="four-properties")
    said = {}
    for room in (3, 4):
        dialogues = GameDialogues(scripted_engine(played.templates), room_names=names)
        played.run(6)
        dialogues.open(played.session.game, Scenario.SPECIFIC_ROOM, 0, Room(room))
        said[room] = dialogues.take_utterances()[0].text
    assert said[3].startswith("Kitchen, room 3, costs me ")
    assert said[4].startswith("Room 4, room 4, costs me ")


def test_the_manual_lists_every_word_with_its_meaning():
    manual = (Path(__file__).parents[4] / "docs" / "reference" / "templates.md").read_text(encoding="utf-8")
    assert all(f"| `£{word.name}£` | {word.meaning} |" in manual for word in WORDS)

import pytest

from thbridge.dialogue.moves import DialogueTopic, Scenario
from thbridge.dialogue.templates import fill, word_fault, words_of
from thbridge.hunt.rooms import Room


def test_reserved_words_become_what_people_read():
    topic = DialogueTopic(Scenario.TAKE_PICTURE, 0, Room(4), 5.0, 82.5, "Orange", "Round and Large")
    wording = "£robot£: £colour£, £footprint£ in room £room£; £cost£ of £energy£; £5 each"
    assert fill(wording, words_of(topic)) == "1: orange, round and large in room 4; 5 of 82.5; £5 each"


@pytest.mark.parametrize("wording", ["£colour£ it is.", "Look! £colour£ it is.", "A thing. £colour£ it is."])
def test_a_word_that_begins_a_sentence_has_a_capital(wording):
    assert "Orange it is." in fill(wording, {"colour": "orange"})


def test_what_fills_a_word_is_not_filled_again():
    assert fill("£colour£", {"colour": "£room£", "room": "4"}) == "£room£"


@pytest.mark.parametrize("wording", ["£room£ £cost£", "It costs £5", "5£ or 6£", "plain"])
def test_good_wordings_pass(wording):
    assert word_fault(wording, Scenario.DONT_KNOW) is None


@pytest.mark.parametrize(
    ("wording", "scenario", "problem", "remedy"),
    [
        ("go to £romo£", Scenario.DONT_KNOW, "£romo£", "£room£"),
        ("go to £ROOM£", Scenario.DONT_KNOW, "£ROOM£", "£room£"),
        ("go to £xyzzy£", Scenario.DONT_KNOW, "£xyzzy£", "£cost£"),
        ("it is £colour£", Scenario.SPECIFIC_ROOM, "beside a treasure", "TakePicture:"),
        ("go to £room", Scenario.DONT_KNOW, "without its partner", "£room£"),
        ("go to room£", Scenario.DONT_KNOW, "without its partner", "£room£"),
    ],
)
def test_a_bad_word_is_named_with_the_right_one(wording, scenario, problem, remedy):
    fault = word_fault(wording, scenario)
    assert problem in fault.problem
    assert remedy in fault.remedy

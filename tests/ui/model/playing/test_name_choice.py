import pytest

from ui.model.playing.memory.name_choice import TYPING, NameChoice
from ui.model.playing.memory.popup_queue import TreasureItem

NAMES = {"ball": "ball", "beer_bottle": "beer bottle", "beer_can": "beer can", "oil": "Öl", "umbrella": "umbrella"}
NONE = NameChoice(TreasureItem(0, 3))


def typed(letters: str, pause: float = 0.1, choice: NameChoice = NONE) -> NameChoice:
    for number, letter in enumerate(letters):
        choice = choice.typing(letter, NAMES, number * pause)
    return choice


@pytest.mark.parametrize(
    ("letters", "name"),
    [
        ("b", "ball"),
        ("B", "ball"),
        ("be", "beer_bottle"),
        ("beer c", "beer_can"),
        ("ö", "oil"),
        ("bb", "beer_bottle"),
        ("bbbb", "ball"),
        ("x", None),
        ("ux", None),
        ("umbrellas", None),
        ("bex", None),
        ("uxb", None),
    ],
)
def test_letters_typed_quickly_are_the_beginning_of_a_name_and_one_letter_goes_round(letters, name):
    assert typed(letters).name == name


@pytest.mark.parametrize(("letters", "name"), [("be", None), ("xu", "umbrella"), ("bb", "beer_bottle")])
def test_a_letter_after_a_pause_begins_anew(letters, name):
    assert typed(letters, TYPING).name == name

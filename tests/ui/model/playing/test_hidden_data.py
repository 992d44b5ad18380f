"""What a seat without energy, score and map is shown, in all front ends."""

import re
from dataclasses import fields, is_dataclass

import pytest

from tests.support.hunts.people_in_a_hunt import HuntOfPeople
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import shipped_texts
from thbridge.hunt.seats import Seat
from ui.model.playing.keys import act_for
from ui.model.playing.screen import (
    AnswerDialogueAct,
    ChooseRobot,
    Confirm,
    ConsiderRoom,
    DialoguePopup,
    EndGameAct,
    FitMap,
    FollowRobot,
    IdentifyTreasureAct,
    PickName,
    SelectRoomAct,
    ShowHelp,
    TakePictureAct,
)
from ui.web.page.game_page import KEYS, BrowserPageMaker

BLIND = Seat("blind", "the blind one", robots=(0, 1), sees_energy=False, sees_score=False, sees_map=False)
SEEING = Seat("seeing", "the seeing one", robots=(2,))
QUANTITIES = {"en": r"\d+ ?(energy|unit|point)|(energy|score|costs?)\W+[-−\d]", "de": r"\d+ ?(Energie|Einheit|Punkt)"}
"""Patterns of numbers of energy or points in words."""


def words_in(value: object) -> list[str]:
    """Return all texts in a value."""
    match value:
        case str():
            return [value]
        case tuple() | list():
            return [text for each in value for text in words_in(each)]
        case _ if is_dataclass(value):
            return [text for field in fields(value) for text in words_in(getattr(value, field.name))]
        case _:
            return []


def found_in(texts: Texts, shown: list[str], own: set[str]) -> list[str]:
    """Return the texts that contain numbers of energy or points. `own` are sentences of the study's dialogues."""
    return [each for each in shown if each not in own and re.search(QUANTITIES[texts.language], each, re.IGNORECASE)]


def played(hunt: HuntOfPeople, texts: Texts):
    """Play a game at the seat, and yield each screen, with the sentences of dialogues so far."""
    person = hunt.people["blind"]
    person.model._memory.texts = texts
    hunt.run()
    own: set[str] = set()

    def look():
        for dialogue in person.tabui.view.dialogues:
            own.update(dialogue.said)
        own.update(text for words in person.tabui.view.last_words for text in words.said)
        return person.screen, own

    def do(act, ticks=12):
        person.do(act)
        hunt.run(ticks)
        return look()

    def agree():
        while isinstance(person.screen.popup, DialoguePopup) and person.screen.popup.choices:
            yield do(AnswerDialogueAct(0))

    yield look()
    yield do(ConsiderRoom(3))
    yield do(ShowHelp())
    yield do(ShowHelp())
    yield do(SelectRoomAct(3))
    yield from agree()
    yield do(SelectRoomAct(5))  # The question whether to stop the robot.
    yield do(Confirm(), 40)
    yield from agree()
    yield do(ConsiderRoom(None), 60)
    yield do(TakePictureAct())
    yield from agree()
    pop = person.screen.popup
    yield do(PickName(pop.names[0]))
    yield do(IdentifyTreasureAct())
    yield from agree()
    yield do(ChooseRobot(1), 30)
    yield do(EndGameAct())
    yield do(Confirm(), 20)


@pytest.mark.parametrize("language", ["en", "de"])
def test_no_screen_and_no_page_has_energy_costs_score_points_or_map(language):
    hunt, texts = HuntOfPeople((BLIND, SEEING)), shipped_texts(language)
    maker = BrowserPageMaker(lambda picture: "" if picture is None else "picture")
    for screen, own in played(hunt, texts):
        page = maker.page(texts, screen, (), None)
        assert found_in(texts, words_in(screen) + words_in(page), own) == []
        assert (screen.score, page.score, page.score_spoken) == (None, "", "")
        assert {card.energy for card in screen.cards} == {None}
        assert {card.energy for card in page.cards} == {()}
        assert {tile.cost for tile in screen.tiles} == {None}
        assert {tile.state for tile in screen.tiles} <= {"unvisited", "reserved", "visited"}
        assert screen.no_map
        assert not any(isinstance(act_for(key, screen), FollowRobot | FitMap) for key in KEYS)
    assert screen.ending is not None
    assert any(room.verdict is not None for room in hunt.people["blind"].tabui.view.rooms)


def test_a_seat_that_sees_everything_is_shown_what_the_other_is_not():
    hunt = HuntOfPeople((replace_sight(BLIND), SEEING))
    shown = [text for screen, _ in played(hunt, shipped_texts()) for text in words_in(screen)]
    assert found_in(shipped_texts(), shown, set())


def test_the_terminal_has_no_energy_costs_score_or_points():
    hunt = HuntOfPeople((SEEING, BLIND), at_terminal="blind")
    hunt.run()
    terminal, own = hunt.terminal, set()
    for line in ("?", "rules", "1 3", "c", "c", "?", "p 3", "c", "c", "names", "?", "h", "end"):
        terminal.type(line)
        hunt.run(40)
        own.update(text for dialogue in terminal.tabui.view.dialogues for text in dialogue.said)
    said = [line for line in terminal.lines if not any(text in line for text in own)]
    assert found_in(shipped_texts(), said, set()) == []
    assert "Robot 1 sets out for room 3." in terminal.lines
    assert "The game is over." in terminal.lines


def replace_sight(seat: Seat) -> Seat:
    """Return a seat that sees everything."""
    return Seat(seat.name, seat.label, seat.robots)

"""What was found, talked over with a robot that argues: a name that does not fit, a picture, and not knowing."""

import pytest

from tests.support.hunts.scripted_hunt import COLLABORATOR, ArguingHunt, arguing_engine
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.events import TreasureIdentified
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.shared.view import (
    AnswerDialogue,
    Consent,
    IdentifyTreasure,
    OpenDialogue,
    RequestSuggestion,
    SendRobot,
    SenseTreasure,
    TakePicture,
    View,
)

ORANGE_OR_BLUE = (
    TreasureKind({"colour": "Blue", "footprint": "Round"}, 20, "Cup", "cup.jpg"),
    TreasureKind({"colour": "Blue", "footprint": "Round"}, 30, "Vase", "vase.jpg"),
)
"""Treasures that a robot cannot tell apart."""


class AtTreasure(ArguingHunt):
    """Robot 1 stands before a treasure that it has sensed."""

    def __init__(self, condition: DialogueCondition = COLLABORATOR, kinds: tuple[TreasureKind, ...] = ()) -> None:
        super().__init__(condition, talk=arguing_engine(condition), kinds=kinds or None)
        self.wish(RequestSuggestion(0))
        self.place = self.dialogue().room
        self.say("All right")
        self.wish(SendRobot(0, self.place), ticks=40)
        self.wish(SenseTreasure(self.place))

    def claim(self, name: str | None) -> View:
        return self.wish(OpenDialogue(0, "take-treasure", self.place, name))

    def act(self, act: str) -> View:
        talk = self.dialogue()
        return self.wish(AnswerDialogue(talk.dialogue, talk.turn, talk.acts.index(act)))

    def named(self, name: str) -> TreasureIdentified | None:
        self.wish(IdentifyTreasure(self.place, name))
        return next((event for event in self.hunt.log.events if isinstance(event, TreasureIdentified)), None)

    @property
    def true_name(self) -> str:
        known = self.view.room(self.place).known
        return next(kind.name for kind in self.hunt.templates.kinds if kind.properties == known)

    @property
    def wrong_name(self) -> str:
        colour = self.view.room(self.place).known["colour"]
        return next(kind.name for kind in self.hunt.templates.kinds if kind.properties["colour"] != colour)


def test_a_name_that_fits_what_was_sensed_is_agreed_at_once() -> None:
    table = AtTreasure()
    name = table.true_name
    assert table.claim(name).consents == (Consent(0, "take-treasure", table.place, name),)
    assert table.named(name) is not None


def test_a_name_that_does_not_fit_is_argued_against_with_what_was_sensed_and_the_list() -> None:
    table = AtTreasure()
    wrong, known = table.wrong_name, table.view.room(table.place).known
    assert table.claim(wrong).consents == ()
    table.act("challenge")
    assert f"the treasure in room {table.place} is {known['colour'].lower()}" in table.dialogue().said[-1]
    assert table.named(wrong) is None


def test_who_was_persuaded_asks_and_names_what_the_robot_holds_it_to_be() -> None:
    table = AtTreasure()
    right = table.true_name
    table.claim(table.wrong_name)
    table.act("accept")
    table.act("question")
    assert right in table.dialogue().said[-1]
    assert table.act("accept").consents == (Consent(0, "take-treasure", table.place, right),)
    assert table.named(right) is not None


def test_an_agreement_on_one_name_is_none_on_another() -> None:
    table = AtTreasure()
    table.claim(table.true_name)
    assert table.named(table.wrong_name) is None
    refusal = table.view.refusal
    assert refusal is not None and "not agreed" in refusal.sentence


def test_a_person_who_sees_it_in_the_picture_persuades_the_robot() -> None:
    table = AtTreasure(DialogueCondition.ADVISER)
    table.wish(OpenDialogue(0, "take-picture", table.place))
    table.act("override")
    table.wish(TakePicture(table.place))
    wrong = table.wrong_name
    table.claim(wrong)
    table.act("challenge")
    table.act("reject")
    table.say(f"The treasure in room {table.place} is the {wrong}")
    table.say(f"I see the {wrong} in the picture")
    assert Consent(0, "take-treasure", table.place, wrong) in table.view.consents


def test_without_a_picture_nobody_can_say_that_they_see_it() -> None:
    table = AtTreasure()
    wrong = table.wrong_name
    table.claim(wrong)
    table.act("challenge")
    table.act("reject")
    table.say(f"The treasure in room {table.place} is the {wrong}")
    assert not any("in the picture" in choice for choice in table.dialogue().choices)


def test_who_does_not_know_what_it_is_is_told_what_the_robot_holds_it_to_be() -> None:
    table = AtTreasure()
    table.claim("")
    assert table.true_name in table.dialogue().said[-1]
    assert table.act("accept").consents == (Consent(0, "take-treasure", table.place, table.true_name),)


def test_who_does_not_know_what_it_is_is_shown_a_picture_where_names_are_left() -> None:
    table = AtTreasure(kinds=ORANGE_OR_BLUE)
    table.claim("")
    assert "picture" in table.dialogue().said[-1]
    assert table.act("accept").consents == (Consent(0, "take-picture", table.place),)


def test_nobody_knows_what_it_is_and_the_robot_says_so() -> None:
    table = AtTreasure(kinds=ORANGE_OR_BLUE)
    table.wish(OpenDialogue(0, "take-picture", table.place))
    table.wish(TakePicture(table.place))
    table.claim("")
    talk = table.dialogue()
    assert "I do not know whether" in talk.said[-1]
    assert table.view.consents == () and "leave" in talk.acts and len(talk.choices) <= 5
    assert table.act("leave").dialogues == ()


@pytest.mark.parametrize("condition", [DialogueCondition.SUPERVISOR, DialogueCondition.AUTONOMOUS])
def test_the_last_word_decides_about_names_too(condition: DialogueCondition) -> None:
    table = AtTreasure(condition)
    right, wrong = table.true_name, table.wrong_name
    view = table.claim(wrong)
    if condition is DialogueCondition.SUPERVISOR:
        assert view.consents == (Consent(0, "take-treasure", table.place, wrong),)
    else:
        table.act("challenge")
        assert table.act("reject").consents == (Consent(0, "take-treasure", table.place, right),)

"""Objections in the dialogue of a teammate, in the window."""

from dataclasses import replace

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from tests.support.windows import sample_screens
from ui.model.playing.keys import keyed
from ui.model.playing.screen import Action, DialoguePopup, RaiseObjectionAct, ShowNext

OBJECTION = "The scout objects: That room is too far."
FOLLOWED = DialoguePopup(
    0,
    "Robot 1: room 3",
    (("robot", "Shall I go?"), ("objection", OBJECTION)),
    (),
    keyed(ShowNext(), "Close"),
    room=3,
    partner="the driver",
    objects=Action(RaiseObjectionAct(), "Object", "O", hint="The driver reads it and decides."),
    own_words="Your own words",
)


def following(**changes):
    return replace(sample_screens.playing(), popup=replace(FOLLOWED, **changes))


def test_the_button_and_the_key_object_with_the_words_of_the_field(opened):
    shown = opened(following())
    panel = shown.window.dialogue
    panel.own_words.setText("Look at the wall.")
    panel.objects.buttons[0].click()
    assert shown.done[-1] == RaiseObjectionAct("Look at the wall.")
    panel.own_words.clear()
    QTest.keyClick(shown.window, Qt.Key.Key_O)
    assert shown.done[-1] == RaiseObjectionAct("")


def test_an_objection_has_a_bubble_that_says_who_objects(opened):
    shown = opened(following())
    assert shown.window.dialogue.transcript._bubbles[-1].accessibleName() == OBJECTION


def test_words_for_one_dialogue_are_never_kept_for_another(opened):
    shown = opened(following())
    field = shown.window.dialogue.own_words
    field.setText("too far")
    shown.show(following(sentences=(("robot", "Shall I go?"),)))
    assert field.text() == "too far"
    shown.show(following(title="Robot 2: room 4"))
    assert field.text() == ""


def test_without_the_right_there_is_neither_button_nor_field(opened):
    panel = opened(following(objects=None, own_words="")).window.dialogue
    assert not panel.own_words.isVisible()
    assert not any(button.isVisible() for button in panel.objects.buttons)

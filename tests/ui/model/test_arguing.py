"""The screen while robots argue."""

from tests.ui.model.views import arguing, view
from thbridge.roles.view import View
from ui.model.participant import Participant
from ui.model.screen import ChooseRoom


def model_of(seen: View) -> Participant:
    model = Participant()
    model.connected(0.0)
    model.receive(seen, 0.0)
    model.screen(0.0)
    return model


def test_who_said_what_is_as_the_game_tells():
    model = model_of(view())
    talk = arguing(">Go there next.", "No.", ">Why?", "Too far.", ">Still.")
    model.receive(view(dialogues=(talk,)), 0.0)
    lines = [("you", "Go there next."), ("robot", "No."), ("you", "Why?"), ("robot", "Too far."), ("you", "Still.")]
    assert list(model.screen(0.0).popup.sentences) == lines
    assert [(line.speaker, line.text) for line in model.screen(0.0).history[1:]] == lines


def test_the_sentence_that_opened_a_dialogue_is_there_once():
    model = model_of(view())
    model.do(ChooseRoom(2), 0.0)
    model.receive(view(dialogues=(arguing(">Go to room 2 next.", "No."),)), 0.0)
    lines = [("you", "Go to room 2."), ("robot", "No.")]
    assert list(model.screen(0.0).popup.sentences) == lines
    assert [(line.speaker, line.text) for line in model.screen(0.0).history[1:]] == lines

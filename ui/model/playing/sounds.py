"""Sounds of a game: one for each kind of important news. The window also shows all these news."""

from collections.abc import Iterator

from thbridge.roles.shared.view import View
from ui.model.playing.memory.state import HuntMemory, ParticipantMemory
from ui.model.playing.screen import GameSound
from ui.model.playing.seat_view import decisions
from ui.model.playing.votes import awaits_own


def why_silent(memory: ParticipantMemory, hunt: HuntMemory) -> str:
    """Return the reason why there is no sound, as a sentence; empty if sound is possible."""
    if not hunt.view.sound:
        return hunt.texts.text("hints.no_sound_in_study")
    return "" if memory.can_sound else hunt.texts.text("hints.no_sound_player")


def sounds_of(before: View, view: View) -> Iterator[GameSound]:
    """Yield the sounds for the news of a view."""
    for was, now in zip(before.robots, view.robots, strict=True):
        if was.moving_to not in (None, now.moving_to) and view.room(was.moving_to).state == "visited":
            yield GameSound.ARRIVAL
    for old, new in zip(before.rooms, view.rooms, strict=True):
        if new.found and not old.found:
            yield GameSound.FIND
        if new.verdict is not None and old.verdict is None and new.verdict.points:
            yield GameSound.WON if new.verdict.points > 0 else GameSound.LOST
    known = {(dialogue.dialogue, dialogue.turn) for dialogue in before.dialogues if dialogue.choices}
    if any(dialogue.choices and (dialogue.dialogue, dialogue.turn) not in known for dialogue in view.dialogues):
        yield GameSound.QUESTION
    voted = {each.decision for each in decisions(before)}
    if any(each.decision not in voted and awaits_own(view, each) for each in decisions(view)):
        yield GameSound.QUESTION

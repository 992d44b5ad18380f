"""Advice for a participant in the practice game."""

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import DialoguePopup, Phase, Screen, TreasurePopup


def advice(texts: Texts, screen: Screen) -> str:
    """Return one or two sentences about the next step of the practice game."""
    if screen.phase is Phase.CONNECTING:
        return texts.text("practice.begins")
    if screen.phase is Phase.CONSENT:
        return texts.text("practice.consent")
    if screen.ending is not None or screen.phase is Phase.OVER:
        return texts.text("practice.over")
    if screen.confirmation is not None:
        return texts.text("practice.confirm")
    if isinstance(screen.popup, TreasurePopup):
        return _about_treasure(texts, screen.popup)
    if isinstance(screen.popup, DialoguePopup):
        if not screen.popup.choices:
            return texts.text("practice.robot_thinks")
        return texts.text("practice.answer")
    if screen.waiting:
        return texts.text("practice.waiting")
    if any(card.progress is not None for card in screen.cards):
        return texts.text("practice.driving")
    if any(tile.choose.enabled for tile in screen.tiles):
        return texts.text("practice.choose_room")
    return texts.text("practice.nothing_left")


def _about_treasure(texts: Texts, pop: TreasurePopup) -> str:
    if pop.verdict is not None:
        return texts.text("practice.verdict")
    if pop.facts is None:
        return texts.text("practice.looking")
    if pop.picture is None and pop.take_picture is not None and pop.take_picture.enabled:
        return texts.text("practice.take_picture")
    if pop.picked is None:
        return texts.text("practice.pick_name")
    return texts.text("practice.name_it")

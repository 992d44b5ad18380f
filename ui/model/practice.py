"""Advice for a participant in the practice game."""

from ui.model.screen import DialoguePopup, Phase, Screen, TreasurePopup


def advice(screen: Screen) -> str:
    """The next step of the practice game, in a sentence or two."""
    if screen.phase is Phase.CONNECTING:
        return "The practice game is about to begin."
    if screen.phase is Phase.CONSENT:
        return "Read the text, and agree if you want to take part."
    if screen.ending is not None or screen.phase is Phase.OVER:
        return "That was the practice game. Go on when you are ready."
    if screen.confirmation is not None:
        return "The program asks before it does what cannot be undone."
    if isinstance(screen.popup, TreasurePopup):
        return _about_treasure(screen.popup)
    if isinstance(screen.popup, DialoguePopup):
        if not screen.popup.choices:
            return "The robot thinks about its answer."
        return "The robot asks you something. Choose an answer with the mouse, or press the key printed on it."
    if screen.waiting:
        return "Something waits for you at the side. Open it when you are ready."
    if any(card.progress is not None for card in screen.cards):
        return "The robot is under way; watch it on the map. You can stop it, or send it to another room."
    if any(tile.choose.enabled for tile in screen.tiles):
        return (
            "Choose a room: click it on the map, or press its number. The robot says what the way costs. "
            "If you don't know, ask for its advice."
        )
    return "Nothing is left to do here. You can end the game."


def _about_treasure(pop: TreasurePopup) -> str:
    if pop.verdict is not None:
        return "This is what came of it, and the score has moved. Close this, and go on."
    if pop.facts is None:
        return "The robot looks around in the room."
    if pop.picture is None and pop.take_picture is not None and pop.take_picture.enabled:
        return (
            "Colour and shape do not always tell what it is. Take a picture: it costs energy, and shows the treasure."
        )
    if pop.picked is None:
        return "Choose from the list what you see, or type how it begins. Nothing counts before you name it."
    return "Name it when you are sure: the right name wins points, a wrong one loses them. Or leave it."

"""Search for the buttons on a screen."""

from collections.abc import Iterator

from ui.model.playing.screen import (
    Act,
    Action,
    DialoguePopup,
    HandOverAct,
    Phase,
    RequestHandbackAct,
    Screen,
    ShowWaiting,
    StopRobotAct,
    TakeUpTreasureAct,
    TreasurePopup,
)


def offers(screen: Screen) -> Iterator[Action]:
    """Yield all buttons on a screen, in arbitrary order."""
    match screen.phase:
        case Phase.CONSENT:
            yield from (screen.agree, screen.decline)
        case Phase.OVER:
            if screen.ending is not None:
                yield screen.ending.again
        case Phase.PLAYING:
            yield from _playing(screen)
        case Phase.CONNECTING:
            pass
    if screen.confirmation is None:
        yield from screen.tools


def offer(screen: Screen, act: Act) -> Action | None:
    """Return the button for an act, or None. If an act names no robot, it means the selected robot.

    `ShowWaiting` may omit the room.
    """
    if act == StopRobotAct():
        return next((card.stop for card in screen.cards if card.selected), None)
    if act == RequestHandbackAct():
        return next((card.ask_back for card in screen.cards if card.selected), None)
    if act == HandOverAct():
        return next((card.hand_over for card in screen.cards if card.selected), None)
    if act == TakeUpTreasureAct():
        return next((card.take_up for card in screen.cards if card.selected), None)
    if isinstance(act, ShowWaiting) and act.room is None:
        return next((waiting.show for waiting in screen.waiting if waiting.robot == act.robot), None)
    return next((action for action in offers(screen) if action.act == act), None)


def _playing(screen: Screen) -> Iterator[Action]:
    if screen.confirmation is not None:
        yield from screen.confirmation.answers
        return
    yield screen.ask_advice
    yield screen.end
    for card in screen.cards:
        yield card.select
        yield from (action for _, action in card.buttons)
    for vote in screen.votes:
        yield from vote.buttons
    yield from (tile.choose for tile in screen.tiles)
    yield from (waiting.show for waiting in screen.waiting)
    match screen.popup:
        case DialoguePopup() as dialogue:
            yield from dialogue.choices
            if dialogue.enlarge is not None:
                yield dialogue.enlarge
            if dialogue.objects is not None:
                yield dialogue.objects
            yield dialogue.aside
        case TreasurePopup() as treasure:
            if treasure.take_picture is not None:
                yield treasure.take_picture
            if treasure.enlarge is not None:
                yield treasure.enlarge
            yield from treasure.acts
            if treasure.asks_for_name:
                yield from (treasure.name_it, treasure.leave)
            yield treasure.aside
        case None:
            pass

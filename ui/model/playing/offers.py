"""Everything that a screen offers to do."""

from collections.abc import Iterator

from ui.model.screen import (
    Act,
    Action,
    AskForRobot,
    DialoguePopup,
    Phase,
    Screen,
    ShowWaiting,
    StopRobot,
    TreasurePopup,
)


def offers(screen: Screen) -> Iterator[Action]:
    """All actions on a screen, in no order that matters."""
    match screen.phase:
        case Phase.CONSENT:
            yield screen.agree
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
    """What offers this act, if anything does; the keys that stop a robot, or ask for it, mean the one selected.

    What waits for a robot may be asked for without saying what.
    """
    if act == StopRobot():
        return next((card.stop for card in screen.cards if card.selected), None)
    if act == AskForRobot():
        return next((card.ask_back for card in screen.cards if card.selected), None)
    if isinstance(act, ShowWaiting) and act.room is None:
        return next((waiting.show for waiting in screen.waiting if waiting.robot == act.robot), None)
    return next((action for action in offers(screen) if action.act == act), None)


def _playing(screen: Screen) -> Iterator[Action]:
    if screen.confirmation is not None:
        yield screen.confirmation.yes
        yield screen.confirmation.no
        return
    yield screen.ask_advice
    yield screen.end
    for card in screen.cards:
        yield card.select
        if card.stop is not None:
            yield card.stop
        if card.ask_back is not None:
            yield card.ask_back
    yield from (tile.choose for tile in screen.tiles)
    yield from (waiting.show for waiting in screen.waiting)
    match screen.popup:
        case DialoguePopup() as talk:
            yield from talk.choices
            yield talk.aside
        case TreasurePopup() as found:
            if found.take_picture is not None:
                yield found.take_picture
            yield from (found.name_it, found.leave, found.aside)
        case None:
            pass

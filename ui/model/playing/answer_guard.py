"""Guard against acts that were meant for earlier content of the screen."""

import math

from ui.model.playing.screen import (
    Act,
    DialoguePopup,
    PickName,
    RequestSuggestionAct,
    Screen,
    SelectRoomAct,
    TakePictureAct,
    TreasurePopup,
    TypeDigit,
    TypeLetter,
)

ANSWER_DELAY = 0.3
"""Seconds for which a new pop-up ignores answers, because a press was meant for the previous content.

The next turn of the same dialogue also counts as new, because the second press of a double click is not an answer. A
name can be submitted only after there was time to read it.
"""


class AnswerGuard:
    """Guard of one person's screen: it refuses acts that follow a change of the screen too soon.

    Arguments called `now` are monotonic seconds of the person's clock: the moment when the screen was painted, or when
    the person acted.

    Attributes:
        opened_at: time at which the list that letters and arrow keys go to appeared.
        popped_at: time at which the content that a person has to read before answering appeared.
    """

    def __init__(self) -> None:
        self.opened_at = self.popped_at = -math.inf
        self._popped: tuple[Act, ...] = ()
        # Time since which digits mean rooms again. A press shortly afterwards was meant for a numbered answer.
        self._digits_at = -math.inf
        # Time at which the game selected another robot. A room chosen shortly afterwards was meant for the previous
        # robot.
        self._selected_at = -math.inf

    def show(self, screen: Screen, before: Screen | None, now: float, *, acting: bool) -> bool:
        """Note that a screen is shown.

        Args:
            screen: the screen.
            before: the screen shown before it; None if it is the first.
            now: see the class.
            acting: True if the screen changed because of an act of the person.

        Returns:
            True if it has new content that a person has to read before answering.
        """
        offered = _offered(screen)
        is_new = before is None or offered != self._popped or _subject(screen) != _subject(before)
        if is_new:
            self._popped, self.popped_at = offered, now
        if before is not None and _selected(screen) != _selected(before) and not acting:
            self._selected_at = now
        if before is not None and _is_numbered(before) and not _is_numbered(screen):
            self._digits_at = now
        if before is None or _listed(screen) != _listed(before):
            self.opened_at = now
        return is_new

    def admits(self, act: Act, now: float, *, on_map: bool = False) -> bool:
        """Return False if an act was meant for the previous content; `on_map` is True for a click on the map."""
        picks = isinstance(act, PickName | TypeLetter)
        since = self.opened_at if picks else self.popped_at
        if (picks or on_map or act in self._popped) and now - since < ANSWER_DELAY:
            return False
        if isinstance(act, TypeDigit) and now - self._digits_at < ANSWER_DELAY:
            return False
        chooses = isinstance(act, SelectRoomAct | RequestSuggestionAct | TypeDigit)
        return not (chooses and now - self._selected_at < ANSWER_DELAY)


def _offered(screen: Screen) -> tuple[Act, ...]:
    """Return the possible answers to the pop-up, the question, the votes and the end page; these appear without a
    request."""
    acts: list[Act] = []
    if screen.confirmation is not None:
        acts += [answer.act for answer in screen.confirmation.answers]
    match screen.popup:
        case DialoguePopup(choices=choices):
            acts += [choice.act for choice in choices]
        case TreasurePopup() as pop:
            acts += [pop.name_it.act, pop.leave.act, TakePictureAct()]
        case None:
            pass
    acts += [button.act for vote in screen.votes for button in vote.buttons]
    if screen.ending is not None:
        acts.append(screen.ending.again.act)
    return tuple(acts)


def _subject(screen: Screen) -> tuple[object, ...]:
    """Return the content that a person has to read before answering."""
    pop = screen.popup
    match pop:
        case DialoguePopup():
            return screen.confirmation, pop.robot, pop.sentences
        case TreasurePopup():
            return screen.confirmation, pop.room, pop.picked
        case None:
            return (screen.confirmation,)


def _selected(screen: Screen) -> int | None:
    """Return the index of the selected robot."""
    return next((card.robot for card in screen.cards if card.selected), None)


def _is_numbered(screen: Screen) -> bool:
    """Return True while digits are answers."""
    return isinstance(screen.popup, DialoguePopup) and screen.popup.numbered


def _listed(screen: Screen) -> tuple[object, ...]:
    """Return the subject of the list to which letters and arrow keys go."""
    pop = screen.popup
    subject = (pop.robot, pop.room) if isinstance(pop, TreasurePopup) else None
    return subject, screen.confirmation, bool(screen.help)

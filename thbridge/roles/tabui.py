"""TabUI: the participant's program, whoever sits in front of it, a person or a simulated one."""

from collections.abc import Mapping, Sequence
from typing import Protocol

import msgspec

from sim.common.observations import TICKS_PER_SECOND
from thbridge.hunt.rooms import Room
from thbridge.roles.notices import KEEPER, House, ParticipantReady, Picture, Subscribe, Ways, Whereabouts, heard, tell
from thbridge.roles.view import Identify, SendRobot, Sense, TakePicture, View, Wish
from thbridge.wire import legacy
from thbridge.wire.notice import JsonValue, Notice, notice, parse_notice
from thbridge.wire.text import Message

RETRY = 3 * TICKS_PER_SECOND
"""Ticks after which a wish that the view does not show fulfilled is said again."""


RENEWAL = 3 * TICKS_PER_SECOND
"""Ticks from one subscription to the next; robots' programs that come back hear of it by then."""

Seen = View | House | Picture | Whereabouts | Ways
"""All that a participant's program is shown."""


class Onlooker(Protocol):
    """Whoever watches what a participant is shown, as a window does."""

    def saw(self, level: Seen) -> None:
        """Take in how things are; told in the order in which it was heard."""


class Player(Protocol):
    """Whoever decides for the participant."""

    def wishes(self, view: View) -> Sequence[Wish]:
        """What is wanted as things stand; asked anew whenever they change, and again if nothing came of it."""


class TabUI:
    """Says a player's wishes in the words of 2016 where there are such, and keeps saying them until they show.

    It holds no state of the game: a TabUI that starts in the middle of one goes on with the next view.

    Args:
        player: decides.
        onlooker: watches; without one nobody asks where the robots are.
    """

    name = legacy.TABUI

    def __init__(self, player: Player, onlooker: Onlooker | None = None) -> None:
        self._player = player
        self._onlooker = onlooker
        self._view: View | None = None
        self._introduce = False
        self._renew: int | None = None
        self._said: dict[Wish, int] = {}
        self._look = 0

    @property
    def view(self) -> View | None:
        """The latest view, None before the first."""
        return self._view

    def connected(self) -> None:
        """Ask the keeper for the view with the next step; what was said before may be lost."""
        self._introduce = True
        self._renew = 0
        self._said.clear()

    def look_again(self) -> None:
        """Ask the player with the next step, whether or not anything changed: a person has made up their mind."""
        self._look = 0

    def step(self, tick: int, messages: Sequence[Message]) -> list[Message]:
        """One tick; see `Role`."""
        changed = False
        for message in messages:
            seen = _seen(message)
            if isinstance(seen, View):
                self._view, changed = seen, True
            if seen is not None and self._onlooker is not None:
                self._onlooker.saw(seen)
        said: list[Message] = []
        if self._introduce:
            self._introduce = False
            said.append(tell(self.name, KEEPER, ParticipantReady()))
        if self._onlooker is not None and self._renew is not None and tick >= self._renew:
            self._renew = tick + RENEWAL
            said.append(tell(self.name, legacy.SIMR, Subscribe()))
        if self._view is not None and self._view.ready and (changed or tick >= self._look):
            said += self._say(tick, self._view)
        return said

    def _say(self, tick: int, view: View) -> list[Message]:
        wishes = dict.fromkeys(self._player.wishes(view))
        self._said = {wish: at for wish, at in self._said.items() if wish in wishes}
        due = [wish for wish in wishes if tick - self._said.get(wish, -RETRY) >= RETRY]
        for wish in due:
            self._said[wish] = tick
        self._look = tick + RETRY
        return [spoken(wish) for wish in due]


def _seen(message: Message) -> Seen | None:
    """What a message shows, if it is well formed and shows anything."""
    shown = parse_notice(message)
    if not isinstance(shown, Notice):
        return None
    if shown.kind == View.__name__:
        return View.from_json(shown.fields)
    return heard(shown, Whereabouts) or heard(shown, Ways) or heard(shown, House) or heard(shown, Picture)


def spoken(wish: Wish) -> Message:
    """The message that says a wish: a line of 2016 where there is one, else a notice to the keeper."""
    match wish:
        case SendRobot(robot, room):
            return legacy.Goto(robot, Room.of_people(room).wire).message()
        case Sense(room):
            return legacy.AskTreasure(Room.of_people(room).wire).message()
        case TakePicture(room):
            return legacy.Snap(Room.of_people(room).wire).message()
        case Identify(room, name):
            return legacy.Identify(Room.of_people(room).wire, name).message()
        case _:
            fields: Mapping[str, JsonValue] = msgspec.to_builtins(wish)
            return notice(TabUI.name, KEEPER, type(wish).__name__, **fields)

"""What wants to be looked at in the middle of the window, one thing at a time."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DestinationItem:
    """A robot talks, or is about to, about where to go."""

    robot: int


@dataclass(frozen=True, slots=True)
class TreasureItem:
    """A robot stands beside a treasure: what to do with it, what is said about that, and what came of it."""

    robot: int
    room: int


PopupItem = DestinationItem | TreasureItem


class PopupQueue:
    """The thing shown and the things that wait, oldest first.

    Nothing takes the place of what is shown but by the participant's own doing.
    """

    def __init__(self) -> None:
        self._items: list[PopupItem] = []
        self._aside: set[PopupItem] = set()
        self.shown: PopupItem | None = None

    @property
    def waiting(self) -> tuple[PopupItem, ...]:
        """What waits behind the thing shown, or was put aside."""
        return tuple(item for item in self._items if item != self.shown)

    @property
    def next(self) -> PopupItem | None:
        """What `put_aside` would show."""
        fresh = next((item for item in self.waiting if item not in self._aside), None)
        return fresh if fresh is not None or self.shown is not None else next(iter(self.waiting), None)

    def update(self, live: Sequence[PopupItem]) -> None:
        """Only these want to be looked at now; new ones come last."""
        self._items = [item for item in self._items if item in live]
        self._items += [item for item in live if item not in self._items]
        self._aside &= set(live)
        if self.shown not in live:
            self.shown = None
            self.shown = next((item for item in self.waiting if item not in self._aside), None)

    def show(self, item: PopupItem) -> None:
        """Show this at once, as the participant asked for it; what was shown waits."""
        self._aside.discard(item)
        if item not in self._items:
            self._items.append(item)
        self.shown = item

    def put_aside(self) -> None:
        """Let the thing shown wait until it is asked for, and show the next; without one, show what waits longest."""
        following = self.next
        if self.shown is not None:
            self._aside.add(self.shown)
        self.shown = following
        if following is not None:
            self._aside.discard(following)

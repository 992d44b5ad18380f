"""Queue of pop-ups: one is shown in the middle of the window, all others wait."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DestinationItem:
    """Dialogue with a robot, open or requested, about where to go."""

    robot: int


@dataclass(frozen=True, slots=True)
class TreasureItem:
    """Robot at a treasure: the possible acts, the dialogue about the treasure, and the verdict."""

    robot: int
    room: int


PopupItem = DestinationItem | TreasureItem


class PopupQueue:
    """Queue of the pop-up shown and the pop-ups that wait, oldest first.

    Only an act of the participant replaces the pop-up shown.
    """

    def __init__(self) -> None:
        self._items: list[PopupItem] = []
        self._aside: set[PopupItem] = set()
        # Pop-ups that were replaced when the participant selected another robot; they return when the pop-up shown
        # since then has ended.
        self._left: set[PopupItem] = set()
        self.shown: PopupItem | None = None

    @property
    def waiting(self) -> tuple[PopupItem, ...]:
        """Pop-ups that wait behind the pop-up shown, including those that were put aside."""
        return tuple(item for item in self._items if item != self.shown)

    @property
    def next(self) -> PopupItem | None:
        """Pop-up that `put_aside` would show."""
        fresh = next(iter(self._fresh()), None)
        return fresh if fresh is not None or self.shown is not None else next(iter(self.waiting), None)

    def update(self, live: Sequence[PopupItem], only_of: int | None = None) -> None:
        """Keep only these items, and add new ones at the end.

        Args:
            live: all items that should be open.
            only_of: robot whose items may be shown if no item is shown now. If None, items of all robots may.
        """
        self._items = [item for item in self._items if item in live]
        self._items += [item for item in live if item not in self._items]
        self._aside &= set(live)
        self._left &= set(live)
        if self.shown not in live:
            if self.shown is not None:
                self._left.clear()
            self.shown = None
            self.shown = next((item for item in self._fresh() if only_of in (None, item.robot)), None)

    def show(self, item: PopupItem) -> None:
        """Show this item at once, as the participant requested; the item shown before then waits."""
        self._aside.discard(item)
        self._left.discard(item)
        if item not in self._items:
            self._items.append(item)
        self.shown = item

    def turn_to(self, robot: int) -> None:
        """Show an item of this robot, if one waits; the item of another robot then waits until this one has ended.

        Items that were put aside are also shown, but only if no other item of this robot waits.
        """
        if self.shown is None or self.shown.robot != robot:
            if self.shown is not None:
                self._left.add(self.shown)
            of_robot = (item for item in self._items if item.robot == robot)
            self.shown = None
            first = min(of_robot, key=lambda item: (item in self._aside, item in self._left), default=None)
            if first is not None:
                self.show(first)

    def put_aside(self) -> None:
        """Put the shown item aside until the participant requests it, and show `next`."""
        following = self.next
        if self.shown is not None:
            self._aside.add(self.shown)
        self.shown = following
        if following is not None:
            self._aside.discard(following)
            self._left.discard(following)

    def _fresh(self) -> list[PopupItem]:
        """Return the waiting items that were neither put aside nor replaced by an item of another robot."""
        return [item for item in self.waiting if item not in self._aside | self._left]

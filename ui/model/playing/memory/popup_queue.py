"""Queue of pop-ups: one is shown in the middle of the window, the others wait."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DestinationItem:
    """A dialogue with a robot, open or requested, about where to go."""

    robot: int


@dataclass(frozen=True, slots=True)
class TreasureItem:
    """A robot at a treasure: possible acts, the dialogue about the treasure, and the verdict."""

    robot: int
    room: int


PopupItem = DestinationItem | TreasureItem


class PopupQueue:
    """The pop-up shown and those that wait, oldest first.

    Only an act of the participant replaces the pop-up shown.
    """

    def __init__(self) -> None:
        self._items: list[PopupItem] = []
        self._aside: set[PopupItem] = set()
        # Items that the participant turned away from; they return when the item shown since has ended.
        self._left: set[PopupItem] = set()
        self.shown: PopupItem | None = None

    @property
    def waiting(self) -> tuple[PopupItem, ...]:
        """The items that wait behind the one shown, or were put aside."""
        return tuple(item for item in self._items if item != self.shown)

    @property
    def next(self) -> PopupItem | None:
        """The item that `put_aside` would show."""
        fresh = next(iter(self._fresh()), None)
        return fresh if fresh is not None or self.shown is not None else next(iter(self.waiting), None)

    def update(self, live: Sequence[PopupItem], only_of: int | None = None) -> None:
        """Keep only these items; new ones are added at the end.

        Args:
            live: all items that should be open.
            only_of: the robot whose items may be shown now if nothing is shown. If None, items of any robot may.
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
        """Show this item at once, on the participant's request; the item shown before waits."""
        self._aside.discard(item)
        self._left.discard(item)
        if item not in self._items:
            self._items.append(item)
        self.shown = item

    def turn_to(self, robot: int) -> None:
        """Show an item of this robot, if one waits; the item of another robot waits until that one has ended.

        Items that were put aside are shown too, but last.
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
        """Return the waiting items that were neither put aside nor turned away from."""
        return [item for item in self.waiting if item not in self._aside | self._left]

"""Queue of pop-ups: one pop-up is shown, all others wait."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DestinationItem:
    """Pop-up of an open or requested dialogue with a robot about its next room."""

    robot: int


@dataclass(frozen=True, slots=True)
class TreasureItem:
    """Pop-up of a treasure and the robot there, with the possible acts, the dialogue and the verdict."""

    robot: int
    room: int


PopupItem = DestinationItem | TreasureItem


class PopupQueue:
    """Queue of the pop-up shown and of the waiting pop-ups, oldest first.

    The pop-up shown changes only after an act of the participant. Quiet pop-ups are about teammates: they never open by
    themselves, and a pop-up that waits for the participant replaces them.

    Attributes:
        shown: the pop-up shown; None if there is none.
        quiet: quiet pop-ups.
    """

    def __init__(self) -> None:
        self._items: list[PopupItem] = []
        self._aside: set[PopupItem] = set()
        # Pop-ups that were replaced because the participant selected another robot. They are shown again after the end
        # of the pop-up that replaced them.
        self._left: set[PopupItem] = set()
        self.shown: PopupItem | None = None
        self.quiet: frozenset[PopupItem] = frozenset()

    @property
    def waiting(self) -> tuple[PopupItem, ...]:
        """Waiting pop-ups, including pop-ups that were put aside."""
        return tuple(item for item in self._items if item != self.shown)

    @property
    def next(self) -> PopupItem | None:
        """Pop-up that `put_aside` would show."""
        fresh = next(iter(self._fresh()), None)
        if fresh is not None or self.shown is not None:
            return fresh
        return min(self.waiting, key=lambda item: item in self.quiet, default=None)

    def update(self, live: Sequence[PopupItem], only_of: int | None = None, quiet: Collection[PopupItem] = ()) -> None:
        """Keep only these items, and append new items.

        Args:
            live: all items that should be open.
            only_of: if no item is shown now, only items of this robot may be shown. If None, all items may be shown.
            quiet: items that do not open by themselves.
        """
        self.quiet = frozenset(quiet)
        self._items = [item for item in self._items if item in live]
        self._items += [item for item in live if item not in self._items]
        self._aside &= set(live)
        self._left &= set(live)
        if self.shown not in live:
            if self.shown is not None:
                self._left.clear()
            self.shown = None
        if self.shown is None or self.shown in self.quiet:
            self.shown = next((item for item in self._fresh() if only_of in (None, item.robot)), self.shown)

    def show(self, item: PopupItem) -> None:
        """Show an item that the participant has requested; the item shown before waits."""
        self._aside.discard(item)
        self._left.discard(item)
        if item not in self._items:
            self._items.append(item)
        self.shown = item

    def turn_to(self, robot: int) -> None:
        """Show a waiting item of this robot, if there is one. The item shown before waits until the new item has ended.

        Items that were put aside are shown only if no other item of this robot waits.
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
        """Return the waiting items, without quiet items and items that were put aside or replaced."""
        return [item for item in self.waiting if item not in self._aside | self._left | self.quiet]

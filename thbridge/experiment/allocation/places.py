"""Places in an experiment. A place is for one person; it determines a cell of the design and an order of conditions.

The number of a place determines its cell and its order. The experiment's seed shuffles cells in blocks; each block
contains every cell equally often. It also shuffles orders in blocks within each cell. If a run does not count, its
place becomes free, and the next person gets the lowest free place. So cells and orders stay as balanced as possible
if people drop out. The same seed always gives the same places.

In a study with games of several people, blocks contain groups instead of single people. All people of a group have
the same order of conditions and successive places, so that people who come one after another can play together. If a
run does not count after the other people of the group have played, its place stays empty, because a new person would
have no partner. Instead, a further group gets places.
"""

import itertools
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from math import ceil

from sim.numerics import noise


@dataclass(frozen=True, slots=True)
class Place:
    """A place in an experiment.

    Attributes:
        number: number of the place, from 0, in the order of assignment.
        cell: index of the combination of levels between people.
        order: index of the order of conditions.
    """

    number: int
    cell: int
    order: int


class NoPlace(StrEnum):
    """Reason why a person does not get a place."""

    FULL = "full"
    """The quota of valid runs is reached."""
    TAKEN = "taken"
    """All places are taken. A place may become free, because some runs are still in progress."""
    CLOSED = "closed"
    """The researcher has closed admission."""


@dataclass(frozen=True, slots=True)
class Allocation:
    """Rule for the assignment of places.

    Attributes:
        cells: number of combinations of levels between people.
        orders: number of orders of conditions.
        quota: required number of valid runs in each cell.
        seed: the experiment's random seed.
        in_block: number of places of each cell in a block.
        groups: for games of several people, the cells of the people of a group, for each kind of group. Empty if all
            games have one participant.
    """

    cells: int
    orders: int
    quota: int
    seed: int
    in_block: int = 1
    groups: tuple[tuple[int, ...], ...] = ()

    @property
    def size(self) -> int:
        """Number of valid runs that the study needs. Groups are complete, so a cell may need more than its quota."""
        groups = sum(needed * len(cells) for needed, cells in zip(self._needed, self.groups, strict=True))
        return groups if self.groups else self.cells * self.quota

    @property
    def _needed(self) -> tuple[int, ...]:
        """Number of groups of each kind that the study needs."""
        return tuple(ceil(self.quota / min(map(cells.count, cells))) for cells in self.groups)

    def place(self, number: int) -> Place:
        """Return the place with a number. Numbers from `size` on are not assigned to people."""
        if self.groups:
            groups = _groups_of_block(self, number // (self.in_block * sum(map(len, self.groups))))
            return next(each for _, places in groups for each in places if each.number == number)
        block, index = divmod(number, self.cells * self.in_block)
        dealt = _shuffled([i % self.cells for i in range(self.cells * self.in_block)], self.seed, "cells", block)
        cell = dealt[index]
        # Number of earlier places in this cell.
        times = block * self.in_block + dealt[:index].count(cell)
        of_orders, turn = divmod(times, self.orders)
        order = _shuffled(list(range(self.orders)), self.seed, f"orders of cell {cell}", of_orders)[turn]
        return Place(number, cell, order)

    def next(
        self, valid: Collection[int], under_way: Collection[int], grouped: Collection[int] = ()
    ) -> Place | NoPlace:
        """Return the place for the next person.

        Args:
            valid: numbers of the places of runs that count.
            under_way: numbers of the places of unfinished runs.
            grouped: numbers of the places of runs in a game of several people.
        """
        if self.groups:
            return self._next_of_groups(valid, under_way, grouped)
        for number in range(self.size):
            if number not in valid and number not in under_way:
                return self.place(number)
        return NoPlace.FULL if len(valid) >= self.size else NoPlace.TAKEN

    def _next_of_groups(
        self, valid: Collection[int], under_way: Collection[int], grouped: Collection[int]
    ) -> Place | NoPlace:
        """Return the first free place of a group that has not played; see `next`."""
        wanted = Counter(
            {
                (kind, cell): needed * count
                for kind, (needed, cells) in enumerate(zip(self._needed, self.groups, strict=True))
                for cell, count in Counter(cells).items()
            }
        )
        done, open_ = Counter[tuple[int, int]](), Counter[tuple[int, int]]()
        for kind, places in self._groups():
            done.update((kind, place.cell) for place in places if place.number in valid)
            if all(open_[key] >= wanted[key] for key in wanted):
                break
            if all(open_[kind, cell] >= wanted[kind, cell] for cell in self.groups[kind]):
                continue
            has_played = any(place.number in grouped for place in places)
            for place in places:
                is_free = place.number not in valid and place.number not in under_way
                if is_free and not has_played:
                    return place
                open_[kind, place.cell] += not is_free
        return NoPlace.FULL if all(done[key] >= wanted[key] for key in wanted) else NoPlace.TAKEN

    def _groups(self) -> Iterator[tuple[int, tuple[Place, ...]]]:
        """Yield the kind and the places of each group, without end. Further groups follow after the needed ones."""
        for block in itertools.count():
            yield from _groups_of_block(self, block)


@lru_cache(maxsize=4096)
def _groups_of_block(allocation: Allocation, block: int) -> tuple[tuple[int, tuple[Place, ...]], ...]:
    """Return the kind and the places of each group of a block."""
    kinds, in_block = allocation.groups, allocation.in_block
    first = block * in_block * sum(map(len, kinds))
    earlier, found = Counter[int](), list[tuple[int, tuple[Place, ...]]]()
    mixed = [kind for kind in range(len(kinds)) for _ in range(in_block)]
    for kind in _shuffled(mixed, allocation.seed, "groups", block):
        of_orders, turn = divmod(block * in_block + earlier[kind], allocation.orders)
        orders = list(range(allocation.orders))
        order = _shuffled(orders, allocation.seed, f"orders of group {kind}", of_orders)[turn]
        places = tuple(Place(number, cell, order) for number, cell in enumerate(kinds[kind], start=first))
        found.append((kind, places))
        first += len(places)
        earlier[kind] += 1
    return tuple(found)


def _shuffled(items: list[int], seed: int, name: str, block: int) -> list[int]:
    """Return the items in a random order, which depends only on the seed, the stream's name and the block's number.

    Source: Durstenfeld, Algorithm 235: Random permutation (1964).
    """
    stream, shuffled = noise.key(seed, "experiment", name), list(items)
    for last in range(len(shuffled) - 1, 0, -1):
        other = int(noise.uniform(stream, block, last) * (last + 1))
        shuffled[last], shuffled[other] = shuffled[other], shuffled[last]
    return shuffled

"""Places in an experiment. A place is for one person; it determines a cell of the design and an order of conditions.

The number of a place determines its cell and its order. The experiment's seed shuffles cells in blocks; each block
contains every cell equally often. It also shuffles orders in blocks within each cell. If a run does not count, its
place becomes free, and the next person gets the lowest free place. So cells and orders stay as balanced as possible
if people drop out. The same seed always gives the same places.

In a study with games of several people, blocks contain groups instead of single people. All people of a group have
the same order of conditions and successive places, so that people who come one after another can play together.
"""

from collections.abc import Collection
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
        """Number of places. Groups are complete, so a cell may have more places than its quota."""
        return len(_places_of_groups(self)) if self.groups else self.cells * self.quota

    def place(self, number: int) -> Place:
        """Return the place with a number. Numbers from `size` on are not assigned to people."""
        if self.groups:
            places = _places_of_groups(self)
            same = places[number % len(places)]
            return Place(number, same.cell, same.order)
        block, index = divmod(number, self.cells * self.in_block)
        dealt = _shuffled([i % self.cells for i in range(self.cells * self.in_block)], self.seed, "cells", block)
        cell = dealt[index]
        # Number of earlier places in this cell.
        times = block * self.in_block + dealt[:index].count(cell)
        of_orders, turn = divmod(times, self.orders)
        order = _shuffled(list(range(self.orders)), self.seed, f"orders of cell {cell}", of_orders)[turn]
        return Place(number, cell, order)

    def next(self, valid: Collection[int], under_way: Collection[int]) -> Place | NoPlace:
        """Return the place for the next person.

        Args:
            valid: numbers of the places of runs that count.
            under_way: numbers of the places of unfinished runs.
        """
        for number in range(self.size):
            if number not in valid and number not in under_way:
                return self.place(number)
        return NoPlace.FULL if len(valid) >= self.size else NoPlace.TAKEN


@lru_cache(maxsize=8)
def _places_of_groups(allocation: Allocation) -> tuple[Place, ...]:
    """Return all places of a study with games of several people."""
    kinds, found = allocation.groups, list[Place]()
    needed = [ceil(allocation.quota / min(map(group.count, group))) for group in kinds]
    dealt = [0] * len(kinds)
    for block in range(ceil(max(needed) / allocation.in_block)):
        mixed = [kind for kind in range(len(kinds)) for _ in range(allocation.in_block)]
        for kind in _shuffled(mixed, allocation.seed, "groups", block):
            if dealt[kind] == needed[kind]:
                continue
            of_orders, turn = divmod(dealt[kind], allocation.orders)
            orders = list(range(allocation.orders))
            order = _shuffled(orders, allocation.seed, f"orders of group {kind}", of_orders)[turn]
            found += [Place(len(found) + person, cell, order) for person, cell in enumerate(kinds[kind])]
            dealt[kind] += 1
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

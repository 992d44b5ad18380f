"""Places in an experiment. A place is for one person; it determines a cell of the design and an order of conditions.

The number of a place determines its cell and its order. The experiment's seed shuffles cells in blocks; each block
contains every cell equally often. It also shuffles orders in blocks within each cell. If a run does not count, its
place becomes free, and the next person gets the lowest free place. So cells and orders stay as balanced as possible
if people drop out. The same seed always gives the same places.
"""

from collections.abc import Collection
from dataclasses import dataclass
from enum import StrEnum

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
    """

    cells: int
    orders: int
    quota: int
    seed: int
    in_block: int = 1

    @property
    def size(self) -> int:
        """Number of places."""
        return self.cells * self.quota

    def place(self, number: int) -> Place:
        """Return the place with a number. Numbers from `size` on are not assigned to people."""
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


def _shuffled(items: list[int], seed: int, name: str, block: int) -> list[int]:
    """Return the items in a random order, which depends only on the seed, the stream's name and the block's number.

    Source: Durstenfeld, Algorithm 235: Random permutation (1964).
    """
    stream, shuffled = noise.key(seed, "experiment", name), list(items)
    for last in range(len(shuffled) - 1, 0, -1):
        other = int(noise.uniform(stream, block, last) * (last + 1))
        shuffled[last], shuffled[other] = shuffled[other], shuffled[last]
    return shuffled

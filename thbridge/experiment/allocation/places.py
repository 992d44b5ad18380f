"""Places in an experiment: each is one cell of the design with one order of conditions, and is taken by one person.

Places are numbered, and a number says all: which cell it is comes from a block in which every cell stands equally
often, dealt by the experiment's seed, and which order from blocks of orders inside the cell. A place of somebody whose
run does not count opens again, and the next person takes the lowest one that is open. So cells and orders stay as
balanced as they can be, whoever drops out and when, and anybody can deal the same places again.
"""

from collections.abc import Collection
from dataclasses import dataclass
from enum import StrEnum

from sim.numerics import noise


@dataclass(frozen=True, slots=True)
class Place:
    """A place in an experiment.

    Attributes:
        number: from 0, in the order in which places are given.
        cell: index of the combination of levels of all between factors.
        order: index of the order of conditions.
    """

    number: int
    cell: int
    order: int


class NoPlace(StrEnum):
    """Reason for having no place for a person."""

    FULL = "full"
    """As many valid runs as are wanted are there."""
    TAKEN = "taken"
    """All places are taken; some may open again while runs are under way."""


@dataclass(frozen=True, slots=True)
class Allocation:
    """Dealing of places.

    Attributes:
        cells: number of combinations of levels of the between factors.
        orders: number of orders of conditions.
        quota: valid runs wanted in each cell.
        seed: the experiment's.
        in_block: times that each cell stands in a block.
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
        """Return the place of a number; those of `size` and more are nobody's."""
        block, index = divmod(number, self.cells * self.in_block)
        dealt = _shuffled([i % self.cells for i in range(self.cells * self.in_block)], self.seed, "cells", block)
        cell = dealt[index]
        # How often this cell was dealt before.
        times = block * self.in_block + dealt[:index].count(cell)
        of_orders, turn = divmod(times, self.orders)
        order = _shuffled(list(range(self.orders)), self.seed, f"orders of cell {cell}", of_orders)[turn]
        return Place(number, cell, order)

    def next(self, valid: Collection[int], under_way: Collection[int]) -> Place | NoPlace:
        """Return the place for the next person.

        Args:
            valid: numbers of the places of runs that count.
            under_way: numbers of the places of runs that may yet.
        """
        for number in range(self.size):
            if number not in valid and number not in under_way:
                return self.place(number)
        return NoPlace.FULL if len(valid) >= self.size else NoPlace.TAKEN


def _shuffled(items: list[int], seed: int, name: str, block: int) -> list[int]:
    """Return a block in an order drawn from the seed, the stream's name and the block's number.

    Source: Durstenfeld, Algorithm 235: Random permutation (1964).
    """
    stream, shuffled = noise.key(seed, "experiment", name), list(items)
    for last in range(len(shuffled) - 1, 0, -1):
        other = int(noise.uniform(stream, block, last) * (last + 1))
        shuffled[last], shuffled[other] = shuffled[other], shuffled[last]
    return shuffled

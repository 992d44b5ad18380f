"""Places in an experiment. Each place is one cell of the design with one order of conditions, for one person.

The number of a place determines its cell and its order. Cells are shuffled, from the experiment's seed, in blocks that
contain every cell equally often; orders are shuffled in blocks within each cell. If a run does not count, its place is
free again, and the next person takes the lowest free place. So cells and orders stay as balanced as possible, whichever
people drop out and when, and the same places can be computed again.
"""

from collections.abc import Collection
from dataclasses import dataclass
from enum import StrEnum

from sim.numerics import noise


@dataclass(frozen=True, slots=True)
class Place:
    """A place in an experiment.

    Attributes:
        number: number from 0, in the order in which places are given.
        cell: index of the combination of levels of all between factors.
        order: index of the order of conditions.
    """

    number: int
    cell: int
    order: int


class NoPlace(StrEnum):
    """Reason for not giving a place to a person."""

    FULL = "full"
    """The quota of valid runs is reached."""
    TAKEN = "taken"
    """All places are taken; some may become free while runs are in progress."""


@dataclass(frozen=True, slots=True)
class Allocation:
    """Rule for giving places.

    Attributes:
        cells: number of combinations of levels of the between factors.
        orders: number of orders of conditions.
        quota: number of valid runs wanted in each cell.
        seed: the experiment's random seed.
        in_block: number of times that each cell is in a block.
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
        """Return the place with a number; numbers from `size` on are not given to people."""
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
            under_way: numbers of the places of runs that may still count.
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

"""Energy costs of moves between rooms."""

import math
from collections.abc import Sequence

from thbridge.hunt.rooms import Room, all_rooms

NOT_A_MOVE = 99.0
"""Number in a cost file that means that there is no move."""


class CostMatrix:
    """Energy from every place to every place; the game uses mean travel times in seconds as energy.

    The matrix need not be symmetric. Staying is never a move, and going to the corridor is a move only if it has a
    cost. This is no dataclass, for the reason given at `Room`.

    Args:
        rows: `rows[start][goal]`, indexed by the number for people (0 is the corridor); infinite if there is no move.
            Square, at least 2 x 2, and no entry negative or NaN.

    Raises:
        ValueError: the rows are not such a matrix.

    Attributes:
        rooms: the rooms of the matrix, without the corridor.
    """

    __slots__ = ("rooms", "rows")

    def __init__(self, rows: tuple[tuple[float, ...], ...]) -> None:
        size = len(rows)
        if size < 2 or any(len(row) != size for row in rows):
            raise ValueError("a cost matrix is square and has at least the corridor and one room")
        # Written as a negation so that NaN, which compares false with everything, is refused too.
        if any(not cost >= 0.0 for row in rows for cost in row):
            raise ValueError("a cost is a number that is not negative")
        self.rows = rows
        self.rooms = all_rooms(size - 1)

    @classmethod
    def of_map_times(cls, rows: tuple[tuple[float, ...], ...]) -> "CostMatrix":
        """Return the matrix of the numbers in a `mapTimes` file; exactly 99 means that there is no move.

        Numbers above 99 are normal costs, so that large maps can be written. Only a cost of exactly 99 cannot be
        written; write 98 or 100. There is no move from a place to itself, whatever number the file has.

        Raises:
            ValueError: the rows are not such a matrix.
        """
        return cls(
            tuple(
                tuple(math.inf if cost == NOT_A_MOVE or start == goal else float(cost) for goal, cost in enumerate(row))
                for start, row in enumerate(rows)
            )
        )

    @classmethod
    def of_plain(cls, rows: Sequence[Sequence[float | None]]) -> "CostMatrix":
        """Return the matrix of rows from JSON; None means that there is no move.

        It raises ValueError as the class does.
        """
        return cls(tuple(tuple(math.inf if cost is None else cost for cost in row) for row in rows))

    def has_place(self, place: Room) -> bool:
        """Return True if the matrix has a row for this place."""
        return place.people < len(self.rows)

    def cost(self, start: Room, goal: Room) -> float:
        """Return the energy from `start` to `goal`; infinite without a move. Raises IndexError for unknown places."""
        return self.rows[start.people][goal.people]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, CostMatrix) and self.rows == other.rows

    def __hash__(self) -> int:
        return hash(self.rows)

    def __repr__(self) -> str:
        return f"CostMatrix({self.rows})"


def energy_text(energy: float) -> str:
    """Return an amount of energy as text: `13`, `12.5`, `0.07`, never `13.0`."""
    return f"{energy:.2f}".rstrip("0").rstrip(".")

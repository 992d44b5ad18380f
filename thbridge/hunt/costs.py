"""Energy costs of moves between rooms."""

import math
from collections.abc import Sequence

from thbridge.hunt.rooms import Room, all_rooms

NOT_A_MOVE = 99.0
"""Number in a cost file for a move that is not possible."""


class CostMatrix:
    """Energy of the moves between all places. The game uses mean travel times in seconds as energy.

    The matrix may be asymmetric. Staying is never a move. Going to the corridor is a move only if it has a cost. This
    class is no dataclass; see the reason at `Room`.

    Args:
        rows: `rows[start][goal]`, by the number for people (0 is the corridor). A cost is infinite if there is no move.
            The matrix must be square, at least 2 x 2, without negative numbers and NaN.

    Raises:
        ValueError: the rows are not a valid matrix.

    Attributes:
        rooms: the rooms of the matrix, without the corridor.
    """

    __slots__ = ("rooms", "rows")

    def __init__(self, rows: tuple[tuple[float, ...], ...]) -> None:
        size = len(rows)
        if size < 2 or any(len(row) != size for row in rows):
            raise ValueError("a cost matrix must be square and must have the corridor and at least one room")
        # With `not`, NaN is refused, too: all comparisons with NaN are false.
        if any(not cost >= 0.0 for row in rows for cost in row):
            raise ValueError("a cost must be a number of 0 or more")
        self.rows = rows
        self.rooms = all_rooms(size - 1)

    @classmethod
    def of_map_times(cls, rows: tuple[tuple[float, ...], ...]) -> "CostMatrix":
        """Return the matrix for the numbers in a `mapTimes` file. The number 99 means that there is no move.

        Numbers above 99 are normal costs, for large maps. A cost of 99 is impossible, so write 98 or 100. There is
        never a move from a place to itself, so this number in the file is ignored.

        Raises:
            ValueError: the rows are not a valid matrix.
        """
        return cls(
            tuple(
                tuple(math.inf if cost == NOT_A_MOVE or start == goal else float(cost) for goal, cost in enumerate(row))
                for start, row in enumerate(rows)
            )
        )

    @classmethod
    def of_plain(cls, rows: Sequence[Sequence[float | None]]) -> "CostMatrix":
        """Return the matrix for rows from JSON. None means that there is no move.

        Raises:
            ValueError: the rows are not a valid matrix.
        """
        return cls(tuple(tuple(math.inf if cost is None else cost for cost in row) for row in rows))

    def has_place(self, place: Room) -> bool:
        """Return True if the matrix has a row for this place."""
        return place.people < len(self.rows)

    def cost(self, start: Room, goal: Room) -> float:
        """Return the energy from `start` to `goal`; infinite if there is no move. Raise IndexError for other places."""
        return self.rows[start.people][goal.people]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, CostMatrix) and self.rows == other.rows

    def __hash__(self) -> int:
        return hash(self.rows)

    def __repr__(self) -> str:
        return f"CostMatrix({self.rows})"


def energy_text(energy: float) -> str:
    """Return an amount of energy as text, without trailing zeros: `13`, `12.5`, `0.07`."""
    return f"{energy:.2f}".rstrip("0").rstrip(".")

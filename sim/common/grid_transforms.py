"""Kernels that transform a mask of cells: nearest cells, king's moves, and connected areas.

scipy has the same transforms, and their results are equal. But importing scipy's would take a fifth of a second of each
start.
"""

import numpy as np
from numpy.typing import NDArray

from sim.numerics.kernels import njit


@njit(cache=True)
def nearest_cells(mask: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return (2, rows, cols): row and column of the mask's cell nearest to each cell. The mask must not be empty.

    Of several nearest cells, the first is chosen: in a column, the cell with the smallest row; then the cell with the
    smallest column. Source: Maurer, Qi and Raghavan (2003), "A linear time algorithm for computing exact Euclidean
    distance transforms of binary images in arbitrary dimensions", IEEE Transactions on Pattern Analysis and Machine
    Intelligence 25 (2).
    """
    rows, cols = mask.shape
    nearest = np.empty((2, rows, cols), dtype=np.int32)
    # In each column, the row of the nearest cell of this column, or -1.
    for col in range(cols):
        above = -1
        for row in range(rows):
            if mask[row, col]:
                above = row
            nearest[0, row, col] = above
        below = -1
        for row in range(rows - 1, -1, -1):
            if mask[row, col]:
                below = row
            above = nearest[0, row, col]
            if above < 0 or (below >= 0 and below - row < row - above):
                nearest[0, row, col] = below
    left = np.empty(cols, dtype=np.int64)
    square = np.empty(cols, dtype=np.int64)
    for row in range(rows):
        # Columns with the nearest cell of a part of this row, from left to right, and the squares of the cells' offsets
        # in rows.
        last = -1
        for col in range(cols):
            if nearest[0, row, col] < 0:
                continue
            offset = np.int64(nearest[0, row, col] - row) ** 2
            while last >= 1:
                a, b = left[last] - left[last - 1], col - left[last]
                hidden = (a + b) * square[last] - b * square[last - 1] - a * offset - a * b * (a + b)
                if hidden <= 0:
                    break
                last -= 1
            last += 1
            left[last], square[last] = col, offset
        at = 0
        for col in range(cols):
            while at < last and square[at] + (left[at] - col) ** 2 > square[at + 1] + (left[at + 1] - col) ** 2:
                at += 1
            nearest[1, row, col] = left[at]
        # The rows of these columns are read before they are replaced.
        for col in range(cols):
            square[col] = nearest[0, row, nearest[1, row, col]]
        for col in range(cols):
            nearest[0, row, col] = square[col]
    return nearest


@njit(cache=True)
def king_moves(mask: NDArray[np.bool_], limit: int) -> NDArray[np.uint8]:
    """Return (rows, cols) the king's moves (as in chess) from each cell to the nearest cell of a mask.

    Args:
        mask: (rows, cols) cells.
        limit: largest result, at most 255; also the result if the mask is empty.
    """
    rows, cols = mask.shape
    moves = np.empty((rows, cols), dtype=np.uint8)
    # The first pass counts moves to cells of the mask above and to the left, the second pass all others.
    for turn in range(2):
        step = 1 - 2 * turn
        for i in range(rows):
            row = i if turn == 0 else rows - 1 - i
            before = row - step
            for j in range(cols):
                col = j if turn == 0 else cols - 1 - j
                fewest = limit if turn == 0 else np.int64(moves[row, col])
                if mask[row, col]:
                    fewest = 0
                if 0 <= col - step < cols:
                    fewest = min(fewest, np.int64(moves[row, col - step]) + 1)
                if 0 <= before < rows:
                    for beside in range(max(col - 1, 0), min(col + 2, cols)):
                        fewest = min(fewest, np.int64(moves[before, beside]) + 1)
                moves[row, col] = fewest
    return moves


@njit(cache=True)
def connected_areas(mask: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Label cells of a mask that are connected over their four sides with the number of their area, from 1.

    Other cells have the label 0. Areas are numbered in the order of their first cells, row by row.
    """
    rows, cols = mask.shape
    areas = np.zeros((rows, cols), dtype=np.int32)
    # Cells of the present area whose neighbors have not been checked: row * cols + col.
    ahead = np.empty(rows * cols, dtype=np.int32)
    count = 0
    for first_row in range(rows):
        for first_col in range(cols):
            if not mask[first_row, first_col] or areas[first_row, first_col] != 0:
                continue
            count += 1
            areas[first_row, first_col] = count
            ahead[0] = first_row * cols + first_col
            found = 1
            while found > 0:
                found -= 1
                row, col = ahead[found] // cols, ahead[found] % cols
                for side in range(4):
                    near_row = row + (side == 0) - (side == 1)
                    near_col = col + (side == 2) - (side == 3)
                    if not (0 <= near_row < rows and 0 <= near_col < cols):
                        continue
                    if mask[near_row, near_col] and areas[near_row, near_col] == 0:
                        areas[near_row, near_col] = count
                        ahead[found] = near_row * cols + near_col
                        found += 1
    return areas

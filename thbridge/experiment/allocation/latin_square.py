"""Orders of conditions: each condition occurs equally often at each position and after each other condition.

Source: Williams, Experimental designs balanced for the estimation of residual effects of treatments (1949).
"""

from collections.abc import Sequence
from itertools import pairwise

Order = tuple[int, ...]
"""Indices of conditions, in the order of play."""


def balanced_latin_square(conditions: int) -> tuple[Order, ...]:
    """Return the orders of a balanced Latin square: n orders for n conditions, or 2n orders if n is odd.

    Raises:
        ValueError: there are no conditions.
    """
    if conditions < 1:
        raise ValueError("an order needs at least one condition")
    # In 0, 1, n - 1, 2, n - 2, ..., all differences between neighbors are different.
    first, low, high = [0], 1, conditions - 1
    while low <= high:
        first.append(low)
        if low != high:
            first.append(high)
        low, high = low + 1, high - 1
    orders = [tuple((index + shift) % conditions for index in first) for shift in range(conditions)]
    if conditions % 2 == 1 and conditions > 1:
        # For an odd number, differences repeat. With the reversed orders, too, all pairs are equally frequent.
        orders += [order[::-1] for order in orders]
    return tuple(orders)


def cyclic_latin_square(conditions: int) -> tuple[Order, ...]:
    """Return the orders of a cyclic Latin square: each condition is at every position once.

    Raises:
        ValueError: there are no conditions.
    """
    if conditions < 1:
        raise ValueError("an order needs at least one condition")
    return tuple(tuple((index + shift) % conditions for index in range(conditions)) for shift in range(conditions))


def is_balanced(orders: Sequence[Order]) -> bool:
    """Return True if each condition occurs equally often at each position and directly after each other condition."""
    at = {(place, one): 0 for one in orders[0] for place in range(len(orders[0]))}
    behind = {(one, other): 0 for one in orders[0] for other in orders[0] if one != other}
    for order in orders:
        for place, one in enumerate(order):
            at[place, one] += 1
        for one, other in pairwise(order):
            behind[one, other] += 1
    return len(set(at.values())) == 1 and len(set(behind.values())) <= 1

"""Chunks: the pieces of a sweep, each some games of one condition that a worker plays in one go."""

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass

from sim.numerics import noise

_SHARD = re.compile(r"([1-9]\d{0,6})/([1-9]\d{0,6})")


@dataclass(frozen=True, slots=True)
class GameChunk:
    """Some games of one condition.

    Attributes:
        number: in the whole sweep, from 1.
        condition: number of the condition.
        seeds: of its games.
    """

    number: int
    condition: int
    seeds: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Shard:
    """One of several equal parts of a sweep; `number` is from 1."""

    number: int = 1
    parts: int = 1

    def has(self, chunk: GameChunk) -> bool:
        """Return True when a chunk is of this part: each is of exactly one."""
        return chunk.number % self.parts == self.number - 1


def shard_in(text: str) -> Shard | None:
    """Return the shard in "2/8"; None for other words."""
    found = _SHARD.fullmatch(text)
    if found is None or int(found[1]) > int(found[2]):
        return None
    return Shard(int(found[1]), int(found[2]))


def chunks_of(conditions: int, seeds: Sequence[int], size: int) -> tuple[GameChunk, ...]:
    """Return all chunks of a sweep.

    The first of every condition come first, so that an early look sees all conditions.

    Args:
        conditions: number of conditions.
        seeds: of the games in each.
        size: greatest number of games in a chunk.
    """
    pieces = [tuple(seeds[start : start + size]) for start in range(0, len(seeds), size)]
    pairs = itertools.product(pieces, range(1, conditions + 1))
    return tuple(GameChunk(number, condition, piece) for number, (piece, condition) in enumerate(pairs, 1))


def is_drawn(purpose: str, one_in: int, condition: int, seed: int) -> bool:
    """Return True for one of so many games, drawn by its condition and seed; 0 draws none, 1 all."""
    return one_in > 0 and noise.uniform(noise.key(condition, "sweep", purpose), seed, 0) * one_in < 1.0

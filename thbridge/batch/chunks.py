"""Chunks: parts of a sweep. A chunk contains games of one condition, and one worker plays all these games."""

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
        number: number of the chunk in the sweep, from 1.
        condition: number of the condition.
        seeds: random seeds of the games.
    """

    number: int
    condition: int
    seeds: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Shard:
    """One of several equal parts of a sweep.

    Attributes:
        number: number of this part, from 1.
        parts: number of parts.
    """

    number: int = 1
    parts: int = 1

    def has(self, chunk: GameChunk) -> bool:
        """Return True if a chunk belongs to this part. Each chunk belongs to exactly one part of the sweep."""
        return chunk.number % self.parts == self.number - 1


def shard_in(text: str) -> Shard | None:
    """Return the shard for a text such as "2/8", or None for another text."""
    found = _SHARD.fullmatch(text)
    if found is None or int(found[1]) > int(found[2]):
        return None
    return Shard(int(found[1]), int(found[2]))


def chunks_of(conditions: int, seeds: Sequence[int], size: int) -> tuple[GameChunk, ...]:
    """Return all chunks of a sweep.

    The first chunks of all conditions are at the beginning, so that early results cover all conditions.

    Args:
        conditions: number of conditions.
        seeds: random seeds of the games in each condition.
        size: maximum number of games in a chunk.
    """
    pieces = [tuple(seeds[start : start + size]) for start in range(0, len(seeds), size)]
    pairs = itertools.product(pieces, range(1, conditions + 1))
    return tuple(GameChunk(number, condition, piece) for number, (piece, condition) in enumerate(pairs, 1))


def is_drawn(purpose: str, one_in: int, condition: int, seed: int) -> bool:
    """Return True for about one game in `one_in`, chosen at random by condition and seed. If 0, return False."""
    return one_in > 0 and noise.uniform(noise.key(condition, "sweep", purpose), seed, 0) * one_in < 1.0

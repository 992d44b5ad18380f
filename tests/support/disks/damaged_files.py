"""Damage to one place in a file: each byte changed, and the file cut to each shorter length."""

import random
from collections.abc import Iterator

EACH_BIT = (0x01, 0x02, 0x04, 0x08, 0x10, 0x20, 0x40, 0x80, 0xFF)
"""Masks that change a byte: each bit alone, as a faulty memory does, and all bits."""
SOME_BITS = (0x01, 0x80, 0xFF)


def flips(content: bytes, masks: tuple[int, ...], stride: int = 1) -> Iterator[tuple[str, bytes]]:
    """Yield a description and the content with one byte changed, for every `stride`-th byte and each mask."""
    for place in range(0, len(content), stride):
        for mask in masks:
            flipped = bytes((content[place] ^ mask,))
            yield f"byte {place} ^ {mask:#04x}", content[:place] + flipped + content[place + 1 :]


def cuts(content: bytes, stride: int = 1) -> Iterator[tuple[str, bytes]]:
    """Yield a description and the content cut to every `stride`-th shorter length."""
    for length in range(0, len(content), stride):
        yield f"cut to {length} bytes", content[:length]


def damaged(whole: bytes, draws: random.Random) -> bytes:
    """Return a file as disks, crashes and people may damage it: cut, with one bit flipped, with an extra byte, or all
    zeros."""
    at = draws.randrange(len(whole))
    flipped = bytes([whole[at] ^ 1 << draws.randrange(8)])
    return draws.choice(
        [whole[:at], whole[:at] + flipped + whole[at + 1 :], whole + b"\0", bytes(len(whole)), whole[at + 1 :]]
    )

"""Damage to one place of a file: each byte changed, and each length to which the file may have been cut."""

import random
from collections.abc import Iterator

EACH_BIT = (0x01, 0x02, 0x04, 0x08, 0x10, 0x20, 0x40, 0x80, 0xFF)
"""What a byte is changed by: each bit alone, as a bad memory does, and all of them."""
SOME_BITS = (0x01, 0x80, 0xFF)


def flips(content: bytes, masks: tuple[int, ...], stride: int = 1) -> Iterator[tuple[str, bytes]]:
    """Yield the content with one byte changed, for each byte (or each so many) and mask, and what was done to it."""
    for place in range(0, len(content), stride):
        for mask in masks:
            flipped = bytes((content[place] ^ mask,))
            yield f"byte {place} ^ {mask:#04x}", content[:place] + flipped + content[place + 1 :]


def cuts(content: bytes, stride: int = 1) -> Iterator[tuple[str, bytes]]:
    """Yield the content cut to each shorter length (or each so many), and what was done to it."""
    for length in range(0, len(content), stride):
        yield f"cut to {length} bytes", content[:length]


def damaged(whole: bytes, draws: random.Random) -> bytes:
    """A file as disks, crashes and people leave it: cut, a bit flipped, zeros, bytes more."""
    at = draws.randrange(len(whole))
    flipped = bytes([whole[at] ^ 1 << draws.randrange(8)])
    return draws.choice(
        [whole[:at], whole[:at] + flipped + whole[at + 1 :], whole + b"\0", bytes(len(whole)), whole[at + 1 :]]
    )

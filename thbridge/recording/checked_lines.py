"""Lines of JSON that carry their length and a checksum chained to all lines before, so that no damage reads as data.

A line is an object whose last members are `"length"` (bytes of the line without these two) and `"sum"` (64 bits of
BLAKE2b over the sum before and the line without it, as hexadecimal). So it stays a line of JSON for every other reader.
"""

import re
from hashlib import blake2b

_END = re.compile(rb',"length":([0-9]{1,9}),"sum":"([0-9a-f]{16})"\}')


class DamagedLine(ValueError):  # noqa: N818 - it is told as a sentence
    """A line whose checksum does not fit it."""


def checked(text: str, before: str) -> tuple[bytes, str]:
    """A line with its length and checksum, without a newline, and the checksum.

    Args:
        text: an object of JSON with at least one member.
        before: checksum of the line before; "" for the first.
    """
    body = text.encode()
    length = f',"length":{len(body)}'.encode()
    own = _sum(body[:-1] + length, before)
    return body[:-1] + length + f',"sum":"{own}"}}'.encode(), own


def has_sum(line: bytes) -> bool:
    """True for a line that ends in a length and a checksum, right or wrong."""
    return b'"sum"' in line[-40:] or _END.search(line[-60:]) is not None


def verified(line: bytes, before: str) -> tuple[bytes, str]:
    """The object of a line without length and checksum, and the checksum.

    Raises:
        DamagedLine: they do not fit.
    """
    found = _END.search(line, max(0, len(line) - 60))
    if found is None or found.end() != len(line):
        raise DamagedLine("the line has no checksum at its end: it was damaged")
    body = line[: found.start()]
    own = _sum(body + line[found.start() : found.end() - len(f',"sum":"{16 * "0"}"}}')], before)
    if int(found[1]) != len(body) + 1 or own.encode() != found[2]:
        raise DamagedLine("the checksum does not fit: this line, or one before it, was damaged or is missing")
    return body + b"}", own


def _sum(data: bytes, before: str) -> str:
    return blake2b(before.encode() + data, digest_size=8).hexdigest()

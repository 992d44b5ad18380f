"""Lines of JSON with their length and a checksum, chained to all earlier lines, so that damage is never read as data.

A line is an object. The last two members of the object are `"length"` (bytes of the line without these two members) and
`"sum"`. The sum has 64 bits: BLAKE2b over the previous sum and the line without its own sum, hexadecimal. For other
readers, a line is plain JSON.
"""

import re
from hashlib import blake2b

_END = re.compile(rb',"length":([0-9]{1,9}),"sum":"([0-9a-f]{16})"\}')


class DamagedLine(ValueError):  # noqa: N818 - it is shown as a sentence
    """A line with a wrong checksum, or without a checksum."""


def checked(text: str, before: str) -> tuple[bytes, str]:
    """Return a line with its length and checksum, without a newline, and the checksum.

    Args:
        text: a JSON object with at least one member.
        before: checksum of the previous line; "" for the first line.
    """
    body = text.encode()
    length = f',"length":{len(body)}'.encode()
    own = _sum(body[:-1] + length, before)
    return body[:-1] + length + f',"sum":"{own}"}}'.encode(), own


def has_sum(line: bytes) -> bool:
    """Return True for a line that ends with a length and a checksum, right or wrong."""
    return b'"sum"' in line[-40:] or _END.search(line[-60:]) is not None


def verified(line: bytes, before: str) -> tuple[bytes, str]:
    """Return the object of a line without length and checksum, and the checksum.

    Raises:
        DamagedLine: length or checksum is wrong.
    """
    found = _END.search(line, max(0, len(line) - 60))
    if found is None or found.end() != len(line):
        raise DamagedLine("the line was damaged: the checksum at its end is missing")
    body = line[: found.start()]
    own = _sum(body + line[found.start() : found.end() - len(f',"sum":"{16 * "0"}"}}')], before)
    if int(found[1]) != len(body) + 1 or own.encode() != found[2]:
        raise DamagedLine("the checksum is wrong: this line, or an earlier line, was damaged or is missing")
    return body + b"}", own


def _sum(data: bytes, before: str) -> str:
    return blake2b(before.encode() + data, digest_size=8).hexdigest()

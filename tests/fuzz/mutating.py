"""Mistakes in bytes: the same seed makes the same ones."""

from random import Random

NUMBERS = (0, 1, 0x7F, 0xFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)
"""Lengths and counts that parsers stumble over."""
WORDS = (
    b"", b"\0", b"\x1b[2J", b"\xff\xfe", b"nan", b".inf", b"1e999", b"-1", b"9" * 5000, b"[" * 2000, b"{" * 2000,
    b'"', b"'", b"&a ", b"*a", b"!!python/object:os.system ", b"\t", b"\n", b"- ", b": ", b"../", b"/dev/zero",
    b"a/b[] c\n", b"=" * 80 + b"\nMSG: a/B\n", b"\\ud800", b"null", b"true",
)  # fmt: skip
"""Words of the formats that are read, in places where they are not expected."""


def mutated(data: bytes, random: Random) -> bytes:
    """Return the bytes with one to four mistakes."""
    out = bytearray(data)
    for _ in range(random.randint(1, 4)):
        at = random.randrange(len(out) + 1)
        other = random.randrange(len(out) + 1)
        size = random.choice((1, 2, 4, 8, 64, 1024))
        match random.randrange(8):
            case 0:
                out[at : at + 1] = bytes([random.randrange(256)])
            case 1:
                out[at : at + 4] = random.choice(NUMBERS).to_bytes(4, random.choice(("little", "big")))
            case 2:
                del out[at : at + size]
            case 3:
                out[at:at] = out[other : other + size]
            case 4:
                out[at : at + size] = out[other : other + size]
            case 5:
                del out[at:]
            case 6:
                out[at:at] = random.choice(WORDS)
            case _:
                out[at : at + size] = random.choice(WORDS)
    return bytes(out)

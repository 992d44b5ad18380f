"""Gossip of zenoh: a message that names peers and their addresses, and the messages that open a connection for it.

zenoh connects to peers that gossip names. The Python library has no function that asks for a connection.

Source: zenoh, zenoh-protocol (transport/init.rs, transport/open.rs, network/oam.rs) and net/codec/linkstate.rs.
"""

from collections.abc import Mapping

_VERSION = 9
_PEER = 1
"""Mode of the sender. In gossip, modes have other numbers."""
_INIT, _INIT_ANSWER, _OPEN, _FRAME, _GOSSIP = 0x01, 0x21, 0x42, 0x25, 0x5F
"""Kinds of messages, with flags: a lease in seconds, a reliable frame, and a body of bytes."""
_KIND = 0x3F
_HAS_SIZES = 0x40
_LEASE_SECONDS = 10
_FIELDS = 0b111
"""A named peer has an id, a mode and addresses."""
_GOSSIPED_PEER = 2


def init_request(own: bytes) -> bytes:
    """Return the first message of a connection. It contains the id of the sender, 16 bytes."""
    return _batch(bytes([_INIT, _VERSION, (len(own) - 1) << 4 | _PEER]) + own)


def cookie_of(answer: bytes) -> bytes | None:
    """Return the cookie in the answer to the first message, without its length. If it is invalid, return None."""
    if len(answer) < 4 or answer[0] & _KIND != _INIT_ANSWER:
        return None
    start = 4 + (answer[2] >> 4) + (3 if answer[0] & _HAS_SIZES else 0)
    size = 0
    for place, byte in enumerate(answer[start : start + 3]):
        size |= (byte & 0x7F) << 7 * place
        if byte < 0x80:
            cookie = answer[start + place + 1 :][:size]
            return cookie if len(cookie) == size else None
    return None


def open_request(cookie: bytes) -> bytes:
    """Return the second message of a connection."""
    return _batch(bytes([_OPEN]) + _number(_LEASE_SECONDS) + _number(0) + _sized(cookie))


def gossip(peers: Mapping[str, str]) -> bytes:
    """Return a message that names peers by their ids, hexadecimal digits, with their addresses in the form of zenoh."""
    named = (
        _number(_FIELDS)
        + _number(number)
        + _number(1)
        + _sized(int(peer, 16).to_bytes((len(peer) + 1) // 2, "little"))
        + bytes([_GOSSIPED_PEER])
        + _number(1)
        + _sized(address.encode())
        + _number(0)
        for number, (peer, address) in enumerate(peers.items())
    )
    body = _number(len(peers)) + b"".join(named)
    return _batch(bytes([_FRAME]) + _number(0) + bytes([_GOSSIP]) + _number(1) + _sized(body))


def _batch(message: bytes) -> bytes:
    return len(message).to_bytes(2, "little") + message


def _sized(content: bytes) -> bytes:
    return _number(len(content)) + content


def _number(number: int) -> bytes:
    """Return a number in groups of 7 bits, the lowest first."""
    groups = bytearray()
    while number > 0x7F:
        groups.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes([*groups, number])

"""Connections of a process that was killed, in the copy that continues."""

import socket
from pathlib import Path

import pytest

from ui.web.pool.sleeping_copies import place_of, shut_accepted


@pytest.mark.parametrize("family", [socket.AF_UNIX, socket.AF_INET])
def test_all_accepted_connections_are_shut_down_and_no_others(family: socket.AddressFamily, tmp_path: Path) -> None:
    def listening(name: str) -> socket.socket:
        made = socket.socket(family)
        made.bind(str(tmp_path / name) if family == socket.AF_UNIX else ("127.0.0.1", 0))
        made.listen()
        return made

    def connected(to: socket.socket) -> socket.socket:
        made = socket.socket(family)
        made.connect(to.getsockname())
        made.settimeout(20)
        return made

    with (
        listening("first") as first,
        listening("second") as second,
        connected(first) as shut,
        connected(second) as other,
        connected(first) as later,
    ):
        (accepted, _), (kept, _) = first.accept(), second.accept()
        shut_accepted({place_of(first)})
        assert shut.recv(1) == b""
        kept.sendall(b"k")
        assert other.recv(1) == b"k"
        # A connection that nobody has accepted yet is served.
        waiting, _ = first.accept()
        waiting.sendall(b"w")
        assert later.recv(1) == b"w"
        for each in (accepted, kept, waiting):
            each.close()

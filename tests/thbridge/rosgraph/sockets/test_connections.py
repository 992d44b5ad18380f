"""Keepalive of TCP, by whatever options a system has."""

import socket
from asyncio import Transport

import pytest

from thbridge.rosgraph.sockets.connections import keep_alive


class OverSocket(Transport):
    """A transport over a socket."""

    def __init__(self, link: socket.socket) -> None:
        super().__init__({"socket": link})


@pytest.mark.parametrize("lacking", [(), ("TCP_KEEPIDLE",), ("TCP_KEEPIDLE", "TCP_KEEPINTVL", "TCP_KEEPCNT")])
def test_a_vanished_peer_is_found_by_the_options_that_there_are(
    lacking: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    options = {name: getattr(socket, name) for name in ("TCP_KEEPIDLE", "TCP_KEEPINTVL", "TCP_KEEPCNT")}
    for name in lacking:
        monkeypatch.delattr(socket, name)
    with socket.socket() as link:
        keep_alive(OverSocket(link))
        assert link.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE) == 1
        told = {name: link.getsockopt(socket.IPPROTO_TCP, option) for name, option in options.items()}
    wanted = {"TCP_KEEPIDLE": 60, "TCP_KEEPINTVL": 10, "TCP_KEEPCNT": 9}
    assert {name: told[name] for name in wanted if name not in lacking} == {
        name: value for name, value in wanted.items() if name not in lacking
    }

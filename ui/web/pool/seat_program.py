"""Program in a seat of a game: a simulated participant at the game's text server."""

import asyncio
import secrets
from collections.abc import Callable

from sim.common.observations import TICK
from thbridge.app.programs import SingleRole, exchange
from thbridge.roles.participant.tabui import TabUI
from thbridge.sockets.reconnecting import ConnectionLost
from thbridge.text_protocol.sockets.client import TextClient
from ui.sources.game import RECONNECT_BACKOFF


async def play_seat(participant: TabUI, host: str, port: int, token: str, stopped: Callable[[], bool]) -> None:
    """Let a simulated participant play until `stopped` returns True. It stays connected after the end of the game.

    Args:
        participant: the participant.
        host: host of the text server.
        port: port of the text server.
        token: token of all programs of this seat, with which a program replaces the connection of the one before it.
        stopped: function that returns True if the program must leave the seat.
    """
    # Each program counts its requests from 1.
    participant.run = secrets.token_hex(8)
    runner = SingleRole(participant)
    client = TextClient(participant.name, token, host, port, RECONNECT_BACKOFF)
    async with client.running():
        while not stopped():
            exchange(runner, client, _ignore)
            await asyncio.sleep(TICK)


def _ignore(_lost: ConnectionLost) -> None:
    """Do nothing: the client connects again."""

"""Game whose server runs elsewhere, for one visitor, who joins it as `thbridge tabui` does."""

import asyncio
import math
from dataclasses import dataclass
from pathlib import Path

from sim.common.observations import TICK
from thbridge.files.keys.key_file import ClientKey
from thbridge.roles.shared.seat_programs import program_of
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.reconnecting import ConnectionLost
from thbridge.study.study_file import Study
from thbridge.text_protocol.sockets.client import TextClient
from ui.web.page.patches import Json
from ui.web.pool.single_game import SingleGame
from ui.web.pool.worker import PeopleInGame

REACH_TIMEOUT = 5.0
"""Seconds for the server of a game elsewhere to answer."""
LOOK = 1.0
"""Seconds between two looks for a server that cannot be reached."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JoinedGame(SingleGame):
    """Game at a text server elsewhere, which asks for consent and writes the recording; see `GameRequest`.

    Attributes:
        server: address of the text server.
        key: key that the server requires; None for none.
    """

    server: ListeningAddress
    key: ClientKey | None

    @classmethod
    def at(
        cls, study: Study, file: Path | None, server: ListeningAddress, key: ClientKey | None = None, seat: str = ""
    ) -> "JoinedGame":
        """Return the game of a study at this address, for the person in a seat; it is empty if there is only one."""
        return cls(study, file, None, False, {seat: ""}, math.inf, server=server, key=key)

    @property
    def seat(self) -> str:
        """Name of the person's seat; empty in a game with one participant."""
        return next(iter(self.consents))

    @property
    def joins_next(self) -> bool:
        """See `GameRequest`."""
        return True

    async def why_refused(self) -> ConnectionLost | None:
        """Return the reason why the person cannot join the game now; None if they can."""
        host, port = self.server.host, self.server.port
        return await TextClient.why_refused(program_of(self.seat), host, port, self.key, REACH_TIMEOUT)

    async def opened(self) -> None:
        """Wait until the person can join the game."""
        while await self.why_refused() is not None:
            await asyncio.sleep(LOOK)

    async def play(self, people: PeopleInGame) -> Json:
        """Let the person take part until they have left."""
        people.ready(self.server, self.key)
        while not people.have_left():
            await asyncio.sleep(TICK)
        return None

"""Game whose server runs elsewhere, for one visitor, who joins it as `thbridge tabui` does."""

import asyncio
import math
from dataclasses import dataclass
from pathlib import Path

from sim.common.observations import TICK
from thbridge.files.keys.key_file import ClientKey
from thbridge.sockets.addresses import ListeningAddress
from thbridge.study.study_file import Study
from ui.web.page.patches import Json
from ui.web.pool.single_game import SingleGame
from ui.web.pool.worker import PeopleInGame


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

    async def play(self, people: PeopleInGame) -> Json:
        """Let the person take part until they have left."""
        people.ready(self.server, self.key)
        while not people.have_left():
            await asyncio.sleep(TICK)
        return None

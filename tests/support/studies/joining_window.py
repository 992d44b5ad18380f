"""Window of the kiosk without a screen, whose person plays games by the real connection, and ends them."""

import asyncio

from tests.support.studies.kiosk_without_screen import Person, ShownWindow
from thbridge.roles.shared.view import EndGame, GiveConsent, View
from ui.model.kiosk import GameNews, GameSeenOver, GameToJoin, InstructionsSoFar, TextToRead, ToKiosk
from ui.windows.link import ParticipantLink

POLL = 0.02


class JoiningWindow(ShownWindow):
    """Window that joins games. It stays open after the last person.

    Args:
        person: behavior of the people at it, one after the other.
        people: number of them.
        may_end: set when the person may end the present game.

    Attributes:
        joined: all games that it has joined.
        view: what the person sees of the present game; None before.
    """

    def __init__(self, person: Person, people: int = 1, may_end: asyncio.Event | None = None) -> None:
        super().__init__(person, people)
        self.joined: list[GameToJoin] = []
        self.view: View | None = None
        self._may_end = may_end
        self._playing: asyncio.Task[None] | None = None

    async def send(self, message: ToKiosk) -> None:
        """See `ShownWindow`."""
        if self._playing is not None and not isinstance(message, GameNews | InstructionsSoFar):
            self._playing.cancel()
            await asyncio.gather(self._playing, return_exceptions=True)
            self._playing = None
        if isinstance(message, TextToRead) and message.anew and self._left == 0:
            return  # The window stays open without a person.
        if isinstance(message, GameToJoin):
            self.joined.append(message)
            self._playing = asyncio.create_task(self._play(message))
        await super().send(message)

    async def _play(self, game: GameToJoin) -> None:
        consent = GiveConsent(game.agreed_at) if game.agreed_at else None
        link, over = ParticipantLink(game.host, game.port, game.token, consent, seat=game.seat), False
        link.start()
        try:
            while True:
                for received in link.take_events():
                    if isinstance(received.event, View):
                        self.view = received.event
                if self.view is not None and (self._may_end is None or self._may_end.is_set()):
                    link.request((EndGame(self.view.game),))
                if self.view is not None and self.view.over is not None and not over:
                    over = True
                    self.say(GameSeenOver(game.page))
                await asyncio.sleep(POLL)
        finally:
            await asyncio.to_thread(link.stop)
            self.view = None

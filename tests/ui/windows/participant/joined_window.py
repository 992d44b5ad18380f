"""The participant's program in the middle of a game."""

from dataclasses import dataclass, field

from tests.support.hunts.participant_views import view
from ui.model.lobby import FromWindow
from ui.sources.game import ReceivedEvent, ServerReached
from ui.windows.link import ParticipantLink
from ui.windows.participant_program import ParticipantMainWindow


class ArrivedLink(ParticipantLink):
    """A link to a game whose first view has arrived."""

    def __init__(self) -> None:
        super().__init__("127.0.0.1", 1, "token")
        self._arrived = [ReceivedEvent(0.0, ServerReached()), ReceivedEvent(0.0, view())]

    def start(self) -> None:
        pass

    def stop(self) -> None:
        pass

    def take_events(self) -> list[ReceivedEvent]:
        events, self._arrived = self._arrived, []
        return events


@dataclass
class JoinedWindow:
    """The main window in the middle of a game, its clock, and what it told its host."""

    window: ParticipantMainWindow | None = None
    now: float = 1.0
    told: list[FromWindow] = field(default_factory=list)

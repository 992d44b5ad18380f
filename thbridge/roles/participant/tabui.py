"""TabUI: the program of a participant. The participant may be a person or simulated."""

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias, assert_never

from sim.common.observations import TICKS_PER_SECOND
from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.rooms import RoomNames
from thbridge.hunt.seats import PlayedBy
from thbridge.roles.shared.notices import (
    KEEPER,
    FloorPlan,
    GameTexts,
    ParticipantFault,
    ParticipantReady,
    PicturePiece,
    PlannedPaths,
    PoseTelemetry,
    Subscribe,
)
from thbridge.roles.shared.participant_lines import encode_request_line
from thbridge.roles.shared.seat_programs import program_of, researchers_program
from thbridge.roles.shared.team_notices import ReportPresence, TeamTalk
from thbridge.roles.shared.view import (
    DeclineConsent,
    GiveConsent,
    ParticipantRequest,
    View,
    refusal_wishes,
)
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import NoticeDecoder, encode_notice

RETRY_PERIOD = 3 * TICKS_PER_SECOND
"""A request is repeated after this number of ticks if the view does not show its effect."""

REJOIN_PERIOD = TICKS_PER_SECOND // 2
"""Number of ticks after joining again before a request is repeated, because the first view may show its effect."""

NUMBER_PERIOD = 30 * TICKS_PER_SECOND
"""After this number of ticks, an unchanged request of the player gets a new number, because its effect was lost.

The server closes connections that are interrupted for this time.
"""

RENEWAL_PERIOD = 3 * TICKS_PER_SECOND
"""Number of ticks between two subscriptions. They are repeated for the case that SimR was restarted."""

ParticipantUpdate: TypeAlias = View | TeamTalk | GameTexts | FloorPlan | PicturePiece | PoseTelemetry | PlannedPaths
"""A notice to the participant's program."""

_UPDATES = NoticeDecoder[ParticipantUpdate](ParticipantUpdate)


class ParticipantObserver(Protocol):
    """Observer of the notices to a participant, such as a window."""

    def observe(self, level: ParticipantUpdate) -> None:
        """Receive a notice. Notices are in the order of arrival."""


class Player(Protocol):
    """Program part that decides for the participant: a window or a bot."""

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the requests for this view. TabUI calls this for every new view, and again after `RETRY_PERIOD`."""


class TabUI:
    """Role of the participant. It sends a player's requests, and repeats them until the view shows their effects.

    A request is a line of 2016 if there is such a line, otherwise a notice. TabUI does not store the state of the game.
    If it starts during a game, it continues with the next view.

    Args:
        player: program part that decides for the participant.
        observer: object that receives all notices. Without an observer, TabUI does not subscribe to pose telemetry.
        consent: consent of a participant who agreed to take part before this program joined. TabUI sends it first.
        first_number: number of the first request. It is random if another program with the same run id may follow, such
            as a window that is opened again. With a random number, the keeper does not count
            new requests as repetitions.
        seat: name of the participant's seat; empty in a game with one participant.
        talk: function that receives the texts between participants. If None, the player does not use them.
        by: who plays the seat, in a game with several seats.

    Attributes:
        name: name of the program.
        view: the latest view, or None before the first view.
        room_names: room names of the game's map. Empty before the keeper has sent them.
        texts: texts of the game's language. None before the keeper has sent them.
        run: id of this run of the program; see `ParticipantReady`.
        declined: True if the participant has declined to take part. Then this program must leave.
        present: False while the participant is away from their front end; only a game with several seats needs it.
    """

    def __init__(
        self,
        player: Player,
        observer: ParticipantObserver | None = None,
        consent: GiveConsent | None = None,
        first_number: int = 1,
        seat: str = "",
        talk: Callable[[TeamTalk], None] | None = None,
        by: PlayedBy = PlayedBy.PERSON,
    ) -> None:
        self.name = researchers_program(seat) if by is PlayedBy.RESEARCHER else program_of(seat)
        self._is_simulated = bool(seat) and by is PlayedBy.PROGRAM
        self._seat = seat
        self._player = player
        self._observer = observer
        self._talk = talk
        self._consent = consent
        self.view: View | None = None
        self.room_names = RoomNames()
        self.texts: Texts | None = None
        self.run = ""
        self.declined = False
        self.present = self._shown_present = True
        self._introduce = False
        self._renew_at: int | None = None
        # For each present request of the player: its number, and the last tick for this number. Then the tick at which
        # each request was last sent.
        self._numbers: dict[ParticipantRequest, tuple[int, int]] = {}
        self._sent: dict[ParticipantRequest, int] = {}
        self._last_number = first_number - 1
        self._next_poll = 0
        self._fault = ""

    def connected(self) -> None:
        """Request the view from the keeper in the next step. Earlier requests may be lost."""
        self._introduce = True
        self._renew_at = 0

    def poll_player(self) -> None:
        """Ask the player in the next step, even for an unchanged view, because a person has decided."""
        self._next_poll = 0

    def decline(self) -> None:
        """Inform the keeper in the next step that the participant does not take part."""
        self.declined = True

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Run one tick; see `Role`."""
        changed = False
        for message in messages:
            update = _decode_update(message)
            match update:
                case View():
                    self._note_refusal(update)
                    self.view, changed = update, True
                    if update.team is not None and update.team.room_names:
                        self.room_names = RoomNames.of(enumerate(update.team.room_names, 1))
                case FloorPlan():
                    self.room_names = update.room_names
                case GameTexts():
                    self.texts = update.texts() or self.texts
                case TeamTalk():
                    if self._talk is not None:
                        self._talk(update)
                case PicturePiece() | PoseTelemetry() | PlannedPaths() | None:
                    pass  # Only the observer uses these notices.
                case _:
                    assert_never(update)
            if update is not None and self._observer is not None:
                self._observer.observe(update)
        outgoing: list[TextMessage] = []
        if self._introduce:
            self._introduce = False
            # Repeat requests a little later, because the next view may show their effects.
            self._sent = dict.fromkeys(self._sent, tick + REJOIN_PERIOD - RETRY_PERIOD)
            self._next_poll = min(self._next_poll, tick + REJOIN_PERIOD)
            if self._consent is not None:
                outgoing.append(encode_request_line(self._consent, sender=self.name))
            outgoing.append(encode_notice(self.name, KEEPER, ParticipantReady(self.run, self._is_simulated)))
            self._shown_present = True
        if self._seat and self.present != self._shown_present:
            self._shown_present = self.present
            outgoing.append(encode_notice(self.name, KEEPER, ReportPresence(self.present)))
        if self._observer is not None and self._renew_at is not None and tick >= self._renew_at:
            self._renew_at = tick + RENEWAL_PERIOD
            outgoing.append(encode_notice(self.name, legacy.SIMR, Subscribe()))
        if self.declined:
            return [*outgoing, encode_notice(self.name, KEEPER, DeclineConsent())]
        if self.view is not None and self.view.ready and (changed or tick >= self._next_poll):
            outgoing += self._due_requests(tick, self.view)
        return outgoing

    def _due_requests(self, tick: int, view: View) -> list[TextMessage]:
        requests = dict.fromkeys(self._player.requests(view))
        fault: str = getattr(self._player, "fault", "")
        reported = [encode_notice(self.name, KEEPER, ParticipantFault(fault))] if fault and fault != self._fault else []
        self._fault = fault
        self._sent = {request: at for request, at in self._sent.items() if request in requests}
        good = {request: number for request, number in self._numbers.items() if tick < number[1]}
        self._numbers = {request: good.get(request) or self._fresh_number(tick) for request in requests}
        due = [request for request in requests if tick - self._sent.get(request, -RETRY_PERIOD) >= RETRY_PERIOD]
        for request in due:
            self._sent[request] = tick
        self._next_poll = min(self._sent.values(), default=tick) + RETRY_PERIOD
        return [*reported, *(encode_request_line(request, self._numbers[request][0], self.name) for request in due)]

    def _fresh_number(self, tick: int) -> tuple[int, int]:
        self._last_number += 1
        return self._last_number, tick + NUMBER_PERIOD

    def _note_refusal(self, view: View) -> None:
        """Remove the numbers of refused requests. So a request that the player repeats is sent again."""
        if view.refusal is not None and (self.view is None or view.refusal != self.view.refusal):
            wish = view.refusal.wish
            self._numbers = {
                request: number for request, number in self._numbers.items() if wish not in refusal_wishes(request)
            }


def _decode_update(message: TextMessage) -> ParticipantUpdate | None:
    """Return the notice in a message, or None if it is malformed or not for participants."""
    update = _UPDATES.read(message)
    return None if isinstance(update, View) and not update.is_consistent() else update

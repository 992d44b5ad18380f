"""TabUI: the program of a participant, who may be a person or simulated."""

from collections.abc import Sequence
from typing import Protocol, TypeAlias, assert_never

from sim.common.observations import TICKS_PER_SECOND
from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.rooms import RoomNames
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
from thbridge.roles.shared.view import (
    DeclineConsent,
    GiveConsent,
    ParticipantRequest,
    View,
    refusal_wishes,
)
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice import NoticeDecoder, encode_notice

RETRY_PERIOD = 3 * TICKS_PER_SECOND
"""Ticks after which a request is sent again if the view does not show its effect."""

REJOIN_PERIOD = TICKS_PER_SECOND // 2
"""Ticks after joining again before a request is sent again: the first view may show its effect."""

NUMBER_PERIOD = 30 * TICKS_PER_SECOND
"""Ticks after which a request that the player still makes gets a new number, because its effect must have been lost.

The server closes a connection that is interrupted for this time.
"""

RENEWAL_PERIOD = 3 * TICKS_PER_SECOND
"""Ticks from one subscription to the next, so that a restarted SimR learns of it."""

ParticipantUpdate: TypeAlias = View | GameTexts | FloorPlan | PicturePiece | PoseTelemetry | PlannedPaths
"""A notice to the participant's program."""

_UPDATES = NoticeDecoder[ParticipantUpdate](ParticipantUpdate)


class ParticipantObserver(Protocol):
    """Observer of the notices to a participant, such as a window."""

    def observe(self, level: ParticipantUpdate) -> None:
        """Receive a notice; called in the order of arrival."""


class Player(Protocol):
    """Decision maker for the participant: a window or a bot."""

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the requests for this view; called for every new view, and again after `RETRY_PERIOD`."""


class TabUI:
    """The participant's role, which sends a player's requests and repeats them until the view shows their effects.

    Requests are lines of 2016 if such lines exist, otherwise notices. TabUI keeps no state of the game: if it starts
    during a game, it continues with the next view.

    Args:
        player: decides.
        observer: receives all notices; without one TabUI does not subscribe to pose telemetry.
        consent: consent of a participant who agreed to take part before this program joined; it is sent first.
        first_number: number of its first request. It is random if another program with the same mark may follow, such
            as a window that is opened again. So the keeper does not take new requests for repetitions.

    Attributes:
        view: the latest view, None before the first.
        room_names: room names of the game's map; empty until the keeper has sent them.
        texts: texts of the game's language; None until the keeper has sent them.
        run: mark of this run of the program; see `ParticipantReady`.
        declined: True when the participant has declined to take part; then this program must leave.
    """

    name = legacy.TABUI

    def __init__(
        self,
        player: Player,
        observer: ParticipantObserver | None = None,
        consent: GiveConsent | None = None,
        first_number: int = 1,
    ) -> None:
        self._player = player
        self._observer = observer
        self._consent = consent
        self.view: View | None = None
        self.room_names = RoomNames()
        self.texts: Texts | None = None
        self.run = ""
        self.declined = False
        self._introduce = False
        self._renew_at: int | None = None
        # For each current request of the player: its number, the last tick of this number, the tick of the last
        # sending.
        self._numbers: dict[ParticipantRequest, tuple[int, int]] = {}
        self._sent: dict[ParticipantRequest, int] = {}
        self._last_number = first_number - 1
        self._next_poll = 0
        self._fault = ""

    def connected(self) -> None:
        """Request the view from the keeper in the next step; requests sent before may be lost."""
        self._introduce = True
        self._renew_at = 0

    def poll_player(self) -> None:
        """Ask the player in the next step even if the view has not changed, because a person has decided."""
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
                case FloorPlan():
                    self.room_names = update.room_names
                case GameTexts():
                    self.texts = update.texts() or self.texts
                case PicturePiece() | PoseTelemetry() | PlannedPaths() | None:
                    pass  # For the observer alone.
                case _:
                    assert_never(update)
            if update is not None and self._observer is not None:
                self._observer.observe(update)
        outgoing: list[TextMessage] = []
        if self._introduce:
            self._introduce = False
            # Requests are repeated a little later, since the next view may show that they were not lost.
            self._sent = dict.fromkeys(self._sent, tick + REJOIN_PERIOD - RETRY_PERIOD)
            self._next_poll = min(self._next_poll, tick + REJOIN_PERIOD)
            if self._consent is not None:
                outgoing.append(encode_request_line(self._consent))
            outgoing.append(encode_notice(self.name, KEEPER, ParticipantReady(self.run)))
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
        return [*reported, *(encode_request_line(request, self._numbers[request][0]) for request in due)]

    def _fresh_number(self, tick: int) -> tuple[int, int]:
        self._last_number += 1
        return self._last_number, tick + NUMBER_PERIOD

    def _note_refusal(self, view: View) -> None:
        """Forget the numbers of refused requests, so that a player that still makes one of them sends it again."""
        if view.refusal is not None and (self.view is None or view.refusal != self.view.refusal):
            wish = view.refusal.wish
            self._numbers = {
                request: number for request, number in self._numbers.items() if wish not in refusal_wishes(request)
            }


def _decode_update(message: TextMessage) -> ParticipantUpdate | None:
    """Return the notice in a message; None if it is malformed or not for participants."""
    update = _UPDATES.read(message)
    return None if isinstance(update, View) and not update.is_consistent() else update

"""Hider: the program for treasures in the study of 2016. It chooses the treasures and answers questions about them."""

from collections.abc import Sequence
from functools import cached_property
from typing import assert_never

from sim.common.observations import TICKS_PER_SECOND
from sim.numerics import noise
from thbridge.hunt.codec import treasure_fields
from thbridge.hunt.properties import OF_2016, TreasureProperty, labelled
from thbridge.hunt.treasures import TreasureKind, hide, same_name
from thbridge.roles.shared.notices import (
    HIDER_NOTICES,
    KEEPER,
    HideRequest,
    HiderNotice,
    HiderReady,
    HideTreasures,
    LegacyReply,
)
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.legacy import (
    AskTreasure,
    FoundTreasure,
    NameTreasure,
    PointsAwarded,
    SnapTreasure,
    TreasureImage,
)
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import COUNTED, Notice, encode_notice, is_notice, parse_notice

KEEPER_TIMEOUT = TICKS_PER_SECOND
"""Number of ticks for which a question waits for a keeper. Then Hider answers the question itself, as in 2016."""


MOST_ROOMS = 1000
"""Largest accepted number of rooms. No map has more rooms, so a larger number is a mistake."""

_Question = AskTreasure | SnapTreasure | NameTreasure


class Hider:
    """Role that hides the treasures.

    It chooses the treasures of every game randomly, from its seed and the game's number. The keeper receives and stores
    the treasures, so a restarted Hider does not need to restore its state. The keeper answers all questions, and Hider
    sends the answers. Without a keeper (at the server of another program), Hider itself answers, as in 2016.

    Args:
        kinds: kinds of treasures, with their pictures.
        seed: random seed.
        rooms: number of rooms if there is no keeper (from the treasures file).
        properties: properties of the kinds.
    """

    name = legacy.HIDER

    def __init__(
        self, kinds: Sequence[TreasureKind], seed: int, rooms: int, properties: Sequence[TreasureProperty] = OF_2016
    ) -> None:
        self._kinds = tuple(kinds)
        self._properties = tuple(properties)
        self._noise_key = noise.key(seed, "hider")
        self._rooms = rooms
        self._introduce = False
        self._has_keeper = False
        # Questions of 2016 that wait for a keeper: pairs of tick and question.
        self._questions: list[tuple[int, _Question]] = []

    def connected(self) -> None:
        """Send a notice to the keeper in the next step that Hider is connected."""
        self._introduce = True

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Run one tick; see `Role`."""
        outgoing: list[TextMessage] = []
        if self._introduce:
            self._introduce = False
            outgoing.append(encode_notice(self.name, KEEPER, HiderReady()))
        for message in messages:
            if is_notice(message):
                notice = parse_notice(message)
                if isinstance(notice, Notice):
                    self._has_keeper = True
                    outgoing += self._handle_notice(HIDER_NOTICES.decode(notice))
            else:
                value = legacy.decode(message)
                if isinstance(value, _Question):
                    self._questions.append((tick, value))
        return outgoing + self._answer_without_keeper(tick)

    def _handle_notice(self, notice: HiderNotice | None) -> list[TextMessage]:
        match notice:
            case HideRequest(game, rooms):
                if game not in COUNTED or not 0 < rooms <= MOST_ROOMS:
                    return []
                treasures = tuple(treasure_fields(kind) for kind in self.hidden(game, rooms))
                return [encode_notice(self.name, KEEPER, HideTreasures(game, treasures))]
            case LegacyReply(command, text):
                return [TextMessage.of(command, self.name, legacy.TABUI, text)]
            case None:
                return []
            case _:
                assert_never(notice)

    def hidden(self, game: int, rooms: int) -> tuple[TreasureKind, ...]:
        """Return the treasure of each room in a game, by its number from 1."""
        return hide(self._kinds, noise.first_uniforms(self._noise_key, game, rooms))

    def _answer_without_keeper(self, tick: int) -> list[TextMessage]:
        if self._has_keeper:
            self._questions.clear()
        outgoing = []
        while self._questions and tick - self._questions[0][0] >= KEEPER_TIMEOUT:
            outgoing += self._answer(self._questions.pop(0)[1])
        return outgoing

    @cached_property
    def _alone(self) -> tuple[TreasureKind, ...]:
        """The treasures if there is no keeper."""
        return self.hidden(1, self._rooms)

    def _answer(self, question: _Question) -> list[TextMessage]:
        if question.room >= len(self._alone):
            return []
        treasure = self._alone[question.room]
        match question:
            case AskTreasure(room):
                return [FoundTreasure(room, labelled(self._properties, treasure.properties)).message()]
            case SnapTreasure(room):
                return [] if treasure.image is None else [TreasureImage(room, treasure.image).message()]
            case NameTreasure(_, name):
                return [
                    PointsAwarded(treasure.points if same_name(name, treasure.name) else -treasure.points).message()
                ]

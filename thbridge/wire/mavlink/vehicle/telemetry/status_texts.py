"""Sentences for people, as STATUSTEXT: few at a time, and none twice in a row.

Source: the MAVLink developer guide, STATUSTEXT: longer sentences go in chunks of 50 bytes; one that is shorter is the
last.
"""

from collections import deque
from collections.abc import Iterator

from sim.common.observations import TICKS_PER_SECOND
from thbridge.wire.mavlink.dialect import TEXT_SIZE, Message, mav
from thbridge.wire.mavlink.outgoing import OutgoingMessage
from thbridge.wire.mavlink.vehicle.parts import TextSeverity

_MOST_WAITING = 8
_BETWEEN = TICKS_PER_SECOND // 4
"""Ticks between two sentences: four a second at most."""
_AGAIN = 3 * TICKS_PER_SECOND
"""Ticks after which the same sentence is said again."""


class StatusTexts:
    """What one vehicle has to tell people.

    Sentences wait for their turn; of too many that wait the oldest are dropped, and of equal ones within three seconds
    all but the first; one that warns is not equal to one that only tells.
    """

    def __init__(self) -> None:
        self._waiting: deque[tuple[TextSeverity, str]] = deque(maxlen=_MOST_WAITING)
        self._last: dict[tuple[TextSeverity, str], int] = {}
        self._tick = 0
        self._next = 0
        self._count = 0

    def say(self, severity: TextSeverity, sentence: str) -> None:
        """Tell a sentence when its turn comes."""
        sentence = sentence[:1].upper() + sentence[1:]
        text = (severity, sentence)
        before = self._last.get(text)
        if before is not None and self._tick - before < _AGAIN:
            return
        self._last = {old: tick for old, tick in self._last.items() if self._tick - tick < _AGAIN}
        self._last[text] = self._tick
        self._waiting.append(text)

    def step(self, tick: int) -> Iterator[OutgoingMessage]:
        """A tick has passed; the sentence whose turn it is."""
        self._tick = tick
        if self._waiting and tick >= self._next:
            self._next = tick + _BETWEEN
            severity, sentence = self._waiting.popleft()
            for message in self._chunks(severity, sentence.encode("utf-8")):
                # What is critical is told to stations that are not heard any more, too: they may hear.
                yield OutgoingMessage(message, to_sleepers=severity is TextSeverity.CRITICAL)

    def _chunks(self, severity: TextSeverity, text: bytes) -> Iterator[Message]:
        if len(text) <= TEXT_SIZE:
            yield mav.MAVLink_statustext_message(severity, text, 0, 0)
            return
        self._count = self._count % 0xFFFF + 1
        # A sentence that fills its last chunk gets an empty one more, which ends it.
        for chunk, start in enumerate(range(0, len(text) + 1, TEXT_SIZE)):
            yield mav.MAVLink_statustext_message(severity, text[start : start + TEXT_SIZE], self._count, chunk)

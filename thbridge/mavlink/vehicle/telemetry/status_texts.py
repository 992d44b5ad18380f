"""Sentences for people, sent as STATUSTEXT: a few per second. No sentence is repeated within three seconds.

Source: the MAVLink developer guide, STATUSTEXT. Longer sentences are sent in chunks of 50 bytes. A shorter chunk is the
last chunk.
"""

from collections import deque
from collections.abc import Iterator

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.vehicle.parts import TextSeverity
from thbridge.mavlink.wire.dialect import TEXT_SIZE, Message, mav
from thbridge.mavlink.wire.outgoing import OutgoingMessage

_MOST_WAITING = 8
_BETWEEN = TICKS_PER_SECOND // 4
"""Ticks between two sentences. So there are at most four sentences per second."""
_AGAIN = 3 * TICKS_PER_SECOND
"""The same sentence may be sent again after this number of ticks."""


class StatusTexts:
    """Queue of texts of one vehicle.

    A full queue drops the oldest sentences. Equal sentences of the same severity within three seconds are sent once.
    """

    def __init__(self) -> None:
        self._waiting: deque[tuple[TextSeverity, str]] = deque(maxlen=_MOST_WAITING)
        self._last: dict[tuple[TextSeverity, str], int] = {}
        self._tick = 0
        self._next = 0
        self._count = 0

    def say(self, severity: TextSeverity, sentence: str) -> None:
        """Queue a sentence."""
        sentence = sentence[:1].upper() + sentence[1:]
        text = (severity, sentence)
        before = self._last.get(text)
        if before is not None and self._tick - before < _AGAIN:
            return
        self._last = {old: tick for old, tick in self._last.items() if self._tick - tick < _AGAIN}
        self._last[text] = self._tick
        self._waiting.append(text)

    def step(self, tick: int) -> Iterator[OutgoingMessage]:
        """Advance by one tick and return the sentence that is due."""
        self._tick = tick
        if self._waiting and tick >= self._next:
            self._next = tick + _BETWEEN
            severity, sentence = self._waiting.popleft()
            for message in self._chunks(severity, sentence.encode("utf-8")):
                # Critical texts also go to inactive links, because their stations may still receive.
                yield OutgoingMessage(message, to_inactive=severity is TextSeverity.CRITICAL)

    def _chunks(self, severity: TextSeverity, text: bytes) -> Iterator[Message]:
        if len(text) <= TEXT_SIZE:
            yield mav.MAVLink_statustext_message(severity, text, 0, 0)
            return
        # The id joins the chunks of a sentence. Id 0 would mean that there is only one chunk.
        self._count = self._count % 0xFFFF + 1
        # If a sentence fills its last chunk, an empty chunk marks the end.
        for chunk, start in enumerate(range(0, len(text) + 1, TEXT_SIZE)):
            yield mav.MAVLink_statustext_message(severity, text[start : start + TEXT_SIZE], self._count, chunk)

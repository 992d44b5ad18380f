"""What a vehicle says again and again, to whom, and how often.

Every link gets the same messages at the same rates until somebody on it asks for others.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from thbridge.wire.mavlink.outgoing import LinkId
from thbridge.wire.mavlink.vehicle.boot_time import MICROSECONDS_PER_TICK

_LONGEST = 0x7FFFFFFF // MICROSECONDS_PER_TICK
"""Ticks of the longest interval that MESSAGE_INTERVAL can tell: 35 minutes."""

OFF = 0
"""As an interval in ticks: never."""

_SPREAD = 7
"""Ticks between one message and the next at the same rate, and one vehicle and the next; it divides no usual interval,
so what is said once a second is spread over the second."""


@dataclass(frozen=True, slots=True)
class DueMessage:
    """A message whose time has come.

    Attributes:
        message: its id.
        link: for this link only; None: for all but `besides`.
        besides: links with a rate of their own.
    """

    message: int
    link: LinkId | None
    besides: frozenset[LinkId]


class Streams:
    """The rates of one vehicle's messages.

    Args:
        defaults: ticks between two of each message that can be asked for; `OFF` where somebody must ask for it.
        system: of the vehicle; vehicles say the same things at different times.
    """

    def __init__(self, defaults: Mapping[int, int], system: int) -> None:
        self._defaults = dict(defaults)
        self._offsets = {message: (system + place) * _SPREAD for place, message in enumerate(defaults)}
        self._unasked = [(message, every, self._offsets[message]) for message, every in defaults.items() if every]
        self._own: dict[LinkId, dict[int, int]] = {}
        self._besides: dict[int, frozenset[LinkId]] = {message: frozenset() for message in defaults}

    def __contains__(self, message: int) -> bool:
        return message in self._defaults

    def every(self, link: LinkId, message: int) -> int:
        """Ticks between two of a message, which can be asked for, on a link."""
        return self._own.get(link, {}).get(message, self._defaults[message])

    def change(self, link: LinkId, message: int, ticks: int | None) -> None:
        """Say a message, which can be asked for, at another rate on a link; None: at the default one again."""
        own = self._own.setdefault(link, {})
        if ticks is None:
            own.pop(message, None)
        else:
            own[message] = ticks
        self._renew(message)

    def forget(self, link: LinkId) -> None:
        """A link is gone."""
        for message in self._own.pop(link, {}):
            self._renew(message)

    def due(self, tick: int) -> Iterator[DueMessage]:
        """What is to be said now."""
        for message, every, offset in self._unasked:
            if (tick + offset) % every == 0:
                yield DueMessage(message, None, self._besides[message])
        for link, own in self._own.items():
            for message, every in own.items():
                if every and (tick + self._offsets[message]) % every == 0:
                    yield DueMessage(message, link, frozenset())

    def _renew(self, message: int) -> None:
        self._besides[message] = frozenset(link for link, own in self._own.items() if message in own)


def ticks_of(microseconds: float) -> int:
    """The interval in ticks that comes nearest, of those that there can be: from one tick to some half an hour."""
    return round(max(1.0, min(microseconds / MICROSECONDS_PER_TICK, float(_LONGEST))))

"""Streams: messages that a vehicle sends repeatedly, and their intervals on each link.

Every link gets the same messages at the same rates until a station on the link requests other rates.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from thbridge.mavlink.vehicle.boot_time import MICROSECONDS_PER_TICK
from thbridge.mavlink.wire.outgoing import LinkId

_LONGEST = 0x7FFFFFFF // MICROSECONDS_PER_TICK
"""Longest interval that MESSAGE_INTERVAL can contain, in ticks. This is 35 minutes."""

OFF = 0
"""Interval, in ticks, of a message that is not sent."""

_SPREAD = 7
"""Ticks between two messages of the same rate, and between two vehicles. No usual interval is a multiple of it. So
messages at 1 Hz are spread over the second."""


@dataclass(frozen=True, slots=True)
class DueMessage:
    """Message that must be sent in this tick.

    Attributes:
        message: id of the message.
        link: only link that gets the message. If None, all links except `except_links` get it.
        except_links: links that have their own rate of this message.
    """

    message: int
    link: LinkId | None
    except_links: frozenset[LinkId]


class Streams:
    """Rates of one vehicle's messages.

    Args:
        defaults: interval of each message that can be requested, ticks. `OFF` means that the message is only sent if
            requested.
        system: system id of the vehicle. With it, vehicles send the same messages at different times.
    """

    def __init__(self, defaults: Mapping[int, int], system: int) -> None:
        self._defaults = dict(defaults)
        self._offsets = {message: (system + place) * _SPREAD for place, message in enumerate(defaults)}
        self._by_default = [(message, every, self._offsets[message]) for message, every in defaults.items() if every]
        self._own: dict[LinkId, dict[int, int]] = {}
        self._with_own_rate: dict[int, frozenset[LinkId]] = {message: frozenset() for message in defaults}

    def __contains__(self, message: int) -> bool:
        return message in self._defaults

    def every(self, link: LinkId, message: int) -> int:
        """Return the interval of a known message on a link, ticks."""
        return self._own.get(link, {}).get(message, self._defaults[message])

    def change(self, link: LinkId, message: int, ticks: int | None) -> None:
        """Set the interval of a known message on a link, in ticks. None restores the default."""
        own = self._own.setdefault(link, {})
        if ticks is None:
            own.pop(message, None)
        else:
            own[message] = ticks
        self._renew(message)

    def forget(self, link: LinkId) -> None:
        """Forget a closed link and its rates."""
        for message in self._own.pop(link, {}):
            self._renew(message)

    def due(self, tick: int) -> Iterator[DueMessage]:
        """Yield the messages that are due in this tick."""
        for message, every, offset in self._by_default:
            if (tick + offset) % every == 0:
                yield DueMessage(message, None, self._with_own_rate[message])
        for link, own in self._own.items():
            for message, every in own.items():
                if every and (tick + self._offsets[message]) % every == 0:
                    yield DueMessage(message, link, frozenset())

    def _renew(self, message: int) -> None:
        self._with_own_rate[message] = frozenset(link for link, own in self._own.items() if message in own)


def ticks_of(microseconds: float) -> int:
    """Convert an interval to the nearest number of ticks, from one tick to 35 minutes."""
    return round(max(1.0, min(microseconds / MICROSECONDS_PER_TICK, float(_LONGEST))))

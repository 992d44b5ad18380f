"""What is known of each link: who was heard there and when, what was lost and what was dropped."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from thbridge.wire.mavlink.frames.frame import missing_between
from thbridge.wire.mavlink.vehicle_interface import Station

MOST_STATIONS = 16
"""Senders that are listened to on one link: whoever makes up more is not heard."""


class DropReason(StrEnum):
    """Why a frame that was whole goes nowhere, as the end of the sentence "a frame goes nowhere: ..."."""

    OURS = "its sender has the ids of one of our vehicles"
    NOBODY = "its sender has the system id 0, which stands for everybody"
    CROWDED = f"{MOST_STATIONS} other senders are heard on this link"
    SECRET = "it carries a signing key, and keys come from a file"
    UNKNOWN = "the dialect does not know its message"


@dataclass(frozen=True, slots=True)
class LinkReport:
    """How a link stands.

    Attributes:
        name: of the link.
        stations: who has been, in the order in which they came.
        received: frames that came in and were listened to.
        lost: frames that did not come in, by the gaps in their senders' counts.
        dropped: frames that came in and went nowhere, by why.
        sent: frames that went out.
    """

    name: str
    stations: tuple[Station, ...]
    received: int
    lost: int
    dropped: Mapping[DropReason, int]
    sent: int

    def __str__(self) -> str:
        counts = f"{self.received} frames came in, {self.lost} were lost on the way, {self.sent} went out"
        dropped = "".join(f"; {count} went nowhere: {why}" for why, count in self.dropped.items())
        return f"{self.name}: {counts}{dropped}"


@dataclass(slots=True)
class _Heard:
    """When a sender was last heard, and its count then."""

    tick: int
    sequence: int


@dataclass(slots=True)
class HubLink:
    """What the hub knows of a link.

    Attributes:
        name: for people.
        patience: ticks for which somebody counts as heard.
        robot: the only vehicle that is there, from 0; None: all are.
        sent: frames that went out.
        dropped: frames that went nowhere, by why.
    """

    name: str
    patience: int
    robot: int | None = None
    sent: int = 0
    dropped: Counter[DropReason] = field(default_factory=Counter)
    _received: int = 0
    _lost: int = 0
    _tick: int | None = None
    _stations: dict[Station, _Heard] = field(default_factory=dict)
    _counts: dict[int, int] = field(default_factory=dict)

    def reaches(self, robot: int) -> bool:
        """Whether this vehicle is there."""
        return self.robot in (None, robot)

    def has_room_for(self, station: Station, tick: int) -> bool:
        """Whether this sender is listened to; who has been silent for long makes room for another."""
        known = self._stations
        return station in known or len(known) < MOST_STATIONS or not all(self.has(other, tick) for other in known)

    def hear(self, station: Station, sequence: int, tick: int) -> None:
        """Note that a frame came in, from a sender for whom there is room."""
        heard = self._stations.get(station)
        if heard is None:
            if len(self._stations) >= MOST_STATIONS:
                del self._stations[min(self._stations, key=lambda other: self._stations[other].tick)]
            self._stations[station] = _Heard(tick, sequence)
        else:
            self._lost += missing_between(heard.sequence, sequence)
            heard.tick, heard.sequence = tick, sequence
        self._tick = tick
        self._received += 1

    def is_awake(self, tick: int) -> bool:
        """Whether anybody has been heard here lately."""
        return self._tick is not None and tick - self._tick <= self.patience

    def has(self, station: Station, tick: int) -> bool:
        """Whether this sender has been heard here lately."""
        heard = self._stations.get(station)
        return heard is not None and tick - heard.tick <= self.patience

    def leads_to(self, system: int, component: int | None, tick: int) -> bool:
        """Whether anybody of this system has been heard here lately; a component of None is any."""
        return any(
            station.system == system and component in (None, station.component) and tick - heard.tick <= self.patience
            for station, heard in self._stations.items()
        )

    def next_sequence(self, system: int) -> int:
        """The number of the next frame that one of our vehicles says here."""
        number = self._counts.get(system, 0)
        self._counts[system] = (number + 1) % 256
        self.sent += 1
        return number

    def report(self, tick: int) -> LinkReport:
        """How it stands."""
        stations = tuple(station for station in self._stations if self.has(station, tick))
        return LinkReport(self.name, stations, self._received, self._lost, dict(self.dropped), self.sent)

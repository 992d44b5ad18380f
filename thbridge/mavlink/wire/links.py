"""State of each link: its senders, the times of their last frames, lost frames and dropped frames."""

from collections import Counter
from dataclasses import dataclass, field
from enum import StrEnum

from thbridge.mavlink.values.vehicle_interface import Station
from thbridge.mavlink.wire.frames.frame import missing_between

MOST_STATIONS = 16
"""Maximum number of senders on one link. Frames of further senders are dropped."""


class DropReason(StrEnum):
    """Reason why a complete frame is dropped. It completes the log message "a frame was dropped: ..."."""

    OURS = "its sender has the ids of one of our vehicles"
    BROADCAST_SENDER = "its sender has the system id 0, which means all systems"
    CROWDED = f"{MOST_STATIONS} other senders already use this link"
    SECRET = "it contains a signing key, but keys must come from a file"
    UNKNOWN = "its message is not in the dialect"


@dataclass(slots=True)
class _LastFrame:
    """Tick and sequence number of a sender's last frame."""

    tick: int
    sequence: int


@dataclass(slots=True)
class HubLink:
    """State of a link in the hub.

    Attributes:
        name: name for people.
        timeout: number of ticks for which the sender of a frame counts as present.
        robot: index of the only vehicle on the link. If None, all vehicles are on the link.
        received: number of frames received and accepted.
        lost: number of lost frames, according to gaps in the senders' sequence numbers.
        dropped: number of dropped frames, by reason.
        sent: number of frames sent.
    """

    name: str
    timeout: int
    robot: int | None = None
    received: int = 0
    lost: int = 0
    dropped: Counter[DropReason] = field(default_factory=Counter)
    sent: int = 0
    _tick: int | None = None
    _stations: dict[Station, _LastFrame] = field(default_factory=dict)
    _counts: dict[int, int] = field(default_factory=dict)

    def __str__(self) -> str:
        counts = f"{self.received} frames received, {self.lost} lost in transmission, {self.sent} sent"
        dropped = "".join(f"; {count} dropped: {why}" for why, count in self.dropped.items())
        return f"{self.name}: {counts}{dropped}"

    def reaches(self, robot: int) -> bool:
        """Return True if this vehicle is on the link."""
        return self.robot in (None, robot)

    def has_room_for(self, station: Station, tick: int) -> bool:
        """Return True if frames of this sender are accepted. A new sender may replace a stale sender."""
        known = self._stations
        return (
            station in known or len(known) < MOST_STATIONS or not all(self.is_present(other, tick) for other in known)
        )

    def record_frame(self, station: Station, sequence: int, tick: int) -> None:
        """Count a frame of an accepted sender."""
        last = self._stations.get(station)
        if last is None:
            if len(self._stations) >= MOST_STATIONS:
                del self._stations[min(self._stations, key=lambda other: self._stations[other].tick)]
            self._stations[station] = _LastFrame(tick, sequence)
        else:
            self.lost += missing_between(last.sequence, sequence)
            last.tick, last.sequence = tick, sequence
        self._tick = tick
        self.received += 1

    def is_active(self, tick: int) -> bool:
        """Return True if a frame arrived within the timeout."""
        return self._tick is not None and tick - self._tick <= self.timeout

    def is_present(self, station: Station, tick: int) -> bool:
        """Return True if a frame of this sender arrived within the timeout."""
        last = self._stations.get(station)
        return last is not None and tick - last.tick <= self.timeout

    def leads_to(self, system: int, component: int | None, tick: int) -> bool:
        """Return True if a frame of this sender arrived within the timeout. None means any component."""
        return any(
            station.system == system and component in (None, station.component) and tick - last.tick <= self.timeout
            for station, last in self._stations.items()
        )

    def next_sequence(self, system: int) -> int:
        """Return the sequence number of the next frame that a vehicle sends on this link."""
        # By the standard, each sender numbers its frames separately on each link, so that gaps show lost frames.
        number = self._counts.get(system, 0)
        self._counts[system] = (number + 1) % 256
        self.sent += 1
        return number

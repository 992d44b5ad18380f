"""Quality of service of ROS 2 endpoints: the policies that Nav2's nodes use.

Source: rmw, qos_profiles.h and types.h; DDS 1.4, section 2.2.3 (which offers satisfy which requests).
"""

from dataclasses import dataclass
from enum import IntEnum


class DeliveryReliability(IntEnum):
    """Delivery with or without repetition of lost messages. The numbers are those of rmw."""

    RELIABLE = 1
    BEST_EFFORT = 2


class Durability(IntEnum):
    """Delivery with or without the last messages for late subscribers. The numbers are those of rmw."""

    TRANSIENT_LOCAL = 1
    VOLATILE = 2


@dataclass(frozen=True, slots=True)
class QosProfile:
    """Quality of service of an endpoint. History is always "keep last"; deadline and liveliness are the defaults.

    Attributes:
        depth: number of messages that are kept.
        reliability: repetition of lost messages.
        durability: delivery of the kept messages to late subscribers.
        lifespan_ns: time after which a kept message is no longer sent, nanoseconds. None for no limit.
    """

    depth: int = 10
    reliability: DeliveryReliability = DeliveryReliability.RELIABLE
    durability: Durability = Durability.VOLATILE
    lifespan_ns: int | None = None

    def satisfies(self, requested: "QosProfile") -> bool:
        """Return True if a subscription with the requested quality gets messages of a publisher with this quality."""
        return self.reliability <= requested.reliability and self.durability <= requested.durability


DEFAULT = QosProfile()
SENSOR_DATA = QosProfile(5, DeliveryReliability.BEST_EFFORT)
LATCHED = QosProfile(1, durability=Durability.TRANSIENT_LOCAL)
SERVICES = QosProfile()
PARAMETER_EVENTS = QosProfile(1000)
ROSOUT = QosProfile(1000, durability=Durability.TRANSIENT_LOCAL, lifespan_ns=10_000_000_000)
TF = QosProfile(100)

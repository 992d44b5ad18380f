"""Messages as they are watched."""

from dataclasses import dataclass

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from thbridge.ros.messages import pack, types
from thbridge.ros.messages.pack import Transform

SECOND = 1_000_000_000


@dataclass(frozen=True)
class StampedMessage:
    topic: str
    msgtype: str
    stamp_ns: int
    data: bytes


def tf(second: float, *entries: tuple[str, str, Pose2], topic: str = "/tf") -> StampedMessage:
    data = pack.transforms(0, [Transform(*entry) for entry in entries])
    return StampedMessage(topic, types.TFMESSAGE, round(second * SECOND), data)


def odometry(
    second: float, pose: Pose2, topic: str = "/odom", frame: str = "odom", child: str = "base_link", speed: float = 0.0
) -> StampedMessage:
    data = pack.odometry(0, frame, child, pose, Twist(speed, 0.0))
    return StampedMessage(topic, types.ODOMETRY, round(second * SECOND), data)

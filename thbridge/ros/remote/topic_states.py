"""State of single topics of a real robot: laser scans, plan, velocity commands to the base.

Each class receives the messages of its topics with their times of arrival.
"""

from collections.abc import Callable

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, LaserMount, Scan, Twist
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from thbridge.ros import clients
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.frames import FrameTree, PlanarMount
from thbridge.ros.messages import pack, unpack
from thbridge.ros.messages.stamps import tick_of
from thbridge.ros.names import frame_name

COMMAND_NS = 100_000_000
"""Time between two commands to the base while the robot is driven by hand."""
COMMAND_LASTS_NS = 500_000_000
"""Time for which a command to the base is valid. Without new commands, drivers stop the robot."""
NEAR_GOAL = 1.0
"""Maximum distance in meters between the end of a plan and its goal. Other plans are for other goals."""

NO_POSES: FloatArray = np.empty((0, 3))


class RemoteScans:
    """Scans of a laser. Static transforms contain its mounting.

    Args:
        base_frame: name of the robot's base frame.
    """

    def __init__(self, base_frame: str) -> None:
        self._base_frame = base_frame
        self._frames = FrameTree()
        self._scan: tuple[unpack.LaserScan, int] | None = None

    def receive_static(self, data: bytes, now_ns: int) -> None:
        """Process a message of /tf_static."""
        for transform in unpack.spatial_transforms(data):
            self._frames.add(transform)

    def receive(self, data: bytes, now_ns: int) -> None:
        """Store a scan."""
        self._scan = unpack.laser_scan(data), now_ns

    def take(self) -> Scan | None:
        """Return the newest scan. Return each scan only once. Return None while the laser's mounting is unknown."""
        if self._scan is None:
            return None
        (read, received_ns), self._scan = self._scan, None
        laser_in_base = self._frames.pose(frame_name(read.frame), self._base_frame)
        if laser_in_base is None:
            return None
        mount = PlanarMount.of(laser_in_base)
        sign = -1.0 if mount.upside_down else 1.0
        beams = len(read.ranges)
        increment = (read.angle_max - read.angle_min) / (beams - 1) if beams > 1 else 0.0
        laser = LaserMount(
            mount.laser_in_base, sign * read.angle_min, sign * increment, beams, read.range_min, read.range_max
        )
        # By the definition of LaserScan, ranges outside the laser's limits are not measurements.
        nothing = (read.ranges >= read.range_max) | (read.ranges <= read.range_min)
        return Scan(tick_of(received_ns), laser, np.where(nothing, np.float32(np.inf), read.ranges))


class RemotePlan:
    """Newest plan of a robot's global planner."""

    def __init__(self) -> None:
        self._poses = NO_POSES
        self._received_ns = 0

    def receive(self, data: bytes, now_ns: int) -> InvalidMessage | None:
        """Process a plan. Return the reason if it cannot be used."""
        plan = unpack.path(data)
        if not np.isfinite(plan).all():
            return InvalidMessage("its poses are not finite")
        self._poses, self._received_ns = plan, now_ns
        return None

    def ahead(self, here: Pose2, there: Pose2, sent_ns: int) -> FloatArray:
        """Return the rest of the plan to a goal, starting at the robot's own pose. Without a plan, it is empty.

        Args:
            here: pose of the robot.
            there: pose of the goal.
            sent_ns: time at which the goal was sent. Older plans are for other goals.
        """
        plan = self._poses
        if not len(plan) or self._received_ns < sent_ns:
            return NO_POSES
        if elementary.hypot(plan[-1, 0] - there.x, plan[-1, 1] - there.y) > NEAR_GOAL:
            return NO_POSES
        nearest = int(np.argmin(elementary_arrays.hypot(plan[:, 0] - here.x, plan[:, 1] - here.y)))
        return np.vstack([here.array(), plan[nearest + 1 :]])


class VelocityCommands:
    """Velocity commands to the base from any node. Our own commands are repeated during manual driving.

    Args:
        publish: function that publishes a message at a given time.
    """

    def __init__(self, publish: Callable[[bytes, int], None]) -> None:
        self._publish = publish
        self._last = (STANDSTILL, -COMMAND_LASTS_NS)
        self._drive: tuple[Twist, int] | None = None
        self._driven_ns = -COMMAND_NS

    def receive(self, data: bytes, now_ns: int) -> InvalidMessage | None:
        """Process a command. Return the reason if it cannot be used."""
        command = clients.velocity(data)
        if isinstance(command, InvalidMessage):
            return command
        self._last = command, now_ns
        return None

    def current(self, now_ns: int) -> Twist:
        """Return the command that is valid now."""
        command, received_ns = self._last
        return command if now_ns - received_ns <= COMMAND_LASTS_NS else STANDSTILL

    def drive(self, command: Twist, now_ns: int, lasts_ns: int) -> None:
        """Drive the robot by hand from the next step on."""
        self._drive = (command, now_ns + lasts_ns)
        self._driven_ns = now_ns - COMMAND_NS

    def stop(self, now_ns: int) -> None:
        """Stop the robot if it is driven by hand."""
        if self._drive is not None:
            self._drive = None
            self._send(STANDSTILL, now_ns)

    def step(self, now_ns: int) -> None:
        """Repeat our command while the robot is driven by hand."""
        if self._drive is None:
            return
        command, until_ns = self._drive
        if now_ns >= until_ns:
            self.stop(now_ns)
        elif now_ns - self._driven_ns >= COMMAND_NS:
            self._driven_ns = now_ns
            self._send(command, now_ns)

    def _send(self, command: Twist, now_ns: int) -> None:
        self._publish(pack.command(command), now_ns)
        self._last = command, now_ns

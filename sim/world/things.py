"""Things: bodies that no map shows. They appear, stand or walk where robots drive, and vanish.

A thing never runs into a robot. It appears when its place is free. A walking thing stops in front of a robot, at a
distance that grows with the robot's speed. So every collision is caused by the robot.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from sim.common.geometry import Pose2
from sim.common.observations import TICK, TICKS_PER_SECOND
from sim.common.polygons import NO_POLYGONS, Polygons, pack_polygons, placed_at, within_margin
from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.world.thing import Thing

ROBOT_MARGIN = 0.3
"""Distance that things keep from a robot, meters."""
BRAKING_TIME = 1.0
"""Seconds in which a robot drives the additional distance that things keep from it. Meanwhile it can see the thing and
brake."""
TURN_BACK_TICKS = 5 * TICKS_PER_SECOND
"""Ticks for which a walking thing waits for a robot before it turns back."""


@dataclass(frozen=True, slots=True)
class ThingState:
    """State of a thing in one tick.

    Attributes:
        thing: the thing itself.
        appeared: True if it is present, False while it waits until its place is free.
        walked: distance from the start of its path to its present position along the path, meters.
        forward: True if it walks along its path, False if it walks back.
        held_up: ticks for which a robot has blocked it.
    """

    thing: Thing
    appeared: bool = False
    walked: float = 0.0
    forward: bool = True
    held_up: int = 0

    def pose(self) -> Pose2:
        """Return the thing's pose in the map."""
        return self.thing.pose_after(self.walked)


@njit(cache=True)
def _would_run_into(
    corners: FloatArray,
    here: tuple[float, float, float],
    before: tuple[float, float],
    poses: FloatArray,
    twists: FloatArray,
    footprint: FloatArray,
    radius: float,
) -> bool:
    """Return True if a body approaches a robot and comes too close, on its way from point `before` to `here`."""
    body = placed_at(corners, here[0], here[1], here[2])
    reach = 0.0
    for k in range(corners.shape[0]):
        reach = max(reach, elementary.hypot(corners[k, 0], corners[k, 1]))
    for j in range(poses.shape[0]):
        margin = ROBOT_MARGIN + BRAKING_TIME * abs(twists[j, 0])
        distance = elementary.hypot(poses[j, 0] - here[0], poses[j, 1] - here[1])
        if distance > reach + radius + margin:
            continue
        # A thing may always move away from a robot, even if it is very near.
        if distance >= elementary.hypot(poses[j, 0] - before[0], poses[j, 1] - before[1]):
            continue
        if within_margin(body, placed_at(footprint, poses[j, 0], poses[j, 1], poses[j, 2]), margin):
            return True
    return False


@dataclass(frozen=True, slots=True)
class RobotBodies:
    """Bodies and velocities of the robots, for things that must not run into them.

    Attributes:
        poses: (n, 3) map frame.
        twists: (n, 2) m/s and rad/s.
        footprint: (v, 2) corners of each robot.
        radius: radius of the circle around the base that contains all corners.
    """

    poses: FloatArray
    twists: FloatArray
    footprint: FloatArray
    radius: float

    def would_meet(self, thing: Thing, here: Pose2, before: tuple[float, float]) -> bool:
        """Return True if a thing that moves from point `before` to pose `here` would run into a robot."""
        met: bool = _would_run_into(
            thing.corners, (here.x, here.y, here.theta), before, self.poses, self.twists, self.footprint, self.radius
        )
        return met


FROM_NOWHERE = (math.inf, math.inf)
"""Previous position of a thing that just appeared. It is infinitely far away, so the thing approaches every robot."""


def step_things(presences: Sequence[ThingState], robots: RobotBodies) -> tuple[ThingState, ...]:
    """Step all things by one tick. For things that neither appear nor walk, the same objects are returned."""
    return tuple(_step_thing(presence, robots) for presence in presences)


def _step_thing(presence: ThingState, robots: RobotBodies) -> ThingState:
    thing = presence.thing
    here = presence.pose()
    if not presence.appeared:
        return presence if robots.would_meet(thing, here, FROM_NOWHERE) else replace(presence, appeared=True)
    end = thing.length if presence.forward else 0.0
    if presence.walked == end:
        if presence.forward and not (thing.back_and_forth and thing.length > 0.0):
            return presence
        return replace(presence, forward=not presence.forward)
    step = thing.speed * TICK
    walked = min(end, presence.walked + step) if presence.forward else max(end, presence.walked - step)
    if not robots.would_meet(thing, thing.pose_after(walked), (here.x, here.y)):
        return replace(presence, walked=walked, held_up=0)
    if presence.held_up < TURN_BACK_TICKS:
        return replace(presence, held_up=presence.held_up + 1)
    return replace(presence, forward=not presence.forward, held_up=0)


def polygons_of(presences: Sequence[ThingState]) -> Polygons:
    """Return the bodies of the present things, map frame."""
    there = [presence for presence in presences if presence.appeared]
    if not there:
        return NO_POLYGONS
    return pack_polygons([presence.pose().transform(presence.thing.corners) for presence in there])

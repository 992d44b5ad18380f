"""Robots on ideal wheels, and places for them."""

import math

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, TICK, Neighbour, Twist
from sim.common.polygons import placed_at
from sim.numerics.elementary import wrap_angle
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.footprint import outline
from sim.robot.local_planning.braking import gap
from sim.robot.navigator.goals import Goal, GoalReached
from sim.robot.navigator.move_base import Navigator

FOOTPRINT = np.array(WorldParameters().footprint)
OUTLINE = outline(FOOTPRINT, 0.05)
ROOMS = [
    (-2.671, 4.692),
    (-2.735, 1.442),
    (-2.869, -2.970),
    (3.110, 4.857),
    (2.612, -2.758),
    (8.744, 5.440),
    (9.002, 1.457),
    (9.084, -2.518),
]
WALLS_ACROSS_X = [
    (-5, -5, 7), (11, -5, 7), (5, 3, 7), (-1, 3, 5), (1, 3, 5), (7, 3, 5),
    (-1, -3, 1), (1, -3, -1), (5, -5, -1), (7, -3, 1),
]  # fmt: skip
WALLS_ACROSS_Y = [
    (-5, -5, 11), (7, -5, 11), (3, -5, -1), (3, 1, 5), (3, 7, 11), (-1, -5, -1), (1, -5, -1), (-1, 1, 5), (-1, 7, 11),
]  # fmt: skip


def arena8():
    """The arena of 2016: sixteen meters by twelve, walls 0.12 m thick."""
    x = -5 + (np.arange(320) + 0.5) * 0.05
    y = -5 + (np.arange(240) + 0.5) * 0.05
    cells = np.zeros((240, 320), np.int8)
    for at, low, high in WALLS_ACROSS_X:
        cells[np.ix_((y >= low - 0.06) & (y <= high + 0.06), abs(x - at) <= 0.06)] = 100
    for at, low, high in WALLS_ACROSS_Y:
        cells[np.ix_(abs(y - at) <= 0.06, (x >= low - 0.06) & (x <= high + 0.06))] = 100
    return OccupancyGrid(cells, 0.05, Pose2(-5.0, -5.0, 0.0))


ARENA = arena8()


class IdealRobots:
    """Robots on ideal wheels; any touch of a wall or of each other fails the test."""

    def __init__(self, starts, grid=ARENA, parameters=None):
        self.grid = grid
        self.navigators = [Navigator(parameters or RobotParameters(), FOOTPRINT, grid, i) for i in range(len(starts))]
        self.poses = [Pose2(*start) for start in starts]
        self.twists = [STANDSTILL] * len(starts)
        self.said = [None] * len(starts)
        self.heard = []
        self.tick = 0
        self.results = [[] for _ in starts]
        self.scans = lambda pose: None
        self.strangers = []
        self.broken = set()
        self.waits = set()
        self.ways_made = []
        self.lost = set()

    def step(self):
        self.tick += 1
        for i, said in enumerate(self.said):
            wanted = said.command if said and i not in self.broken else STANDSTILL
            old = self.twists[i]
            v = old.linear + min(0.2, max(-0.2, wanted.linear - old.linear))
            w = old.angular + min(0.2, max(-0.2, wanted.angular - old.angular))
            x, y, theta = self.poses[i].array()
            middle = theta + 0.5 * w * TICK
            self.poses[i] = Pose2(
                x + v * TICK * math.cos(middle), y + v * TICK * math.sin(middle), wrap_angle(theta + w * TICK)
            )
            self.twists[i] = Twist(v, w)
        self.touch()
        for i, navigator in enumerate(self.navigators):
            others = [other for other in self.heard + self.strangers if other.robot != i]
            scan = self.scans(self.poses[i])
            self.said[i] = navigator.step(self.tick, self.poses[i], self.twists[i], scan, others, i in self.lost)
            if self.said[i].result:
                self.results[i].append(self.said[i].result)
            if self.said[i].waits_for is not None:
                assert self.said[i].command == STANDSTILL
                self.waits.add((i, self.said[i].waits_for))
            way_made = (i, self.said[i].makes_way_for)
            if way_made != next((made for made in reversed(self.ways_made) if made[0] == i), (i, None)):
                self.ways_made.append(way_made)
        self.heard = [
            Neighbour(i, self.poses[i], self.twists[i], FOOTPRINT, said.plan[:, :2], said.times, said.claim)
            for i, said in enumerate(self.said)
        ]

    def touch(self):
        bodies = [placed_at(FOOTPRINT, *pose.array()) for pose in self.poses]
        for i, pose in enumerate(self.poses):
            rows, cols = self.grid.cells_of(pose.transform(OUTLINE)).T
            assert (self.grid.cells[rows, cols] == 0).all(), f"robot {i} touches a wall at {pose}"
            for j in range(i):
                if pose.distance(self.poses[j]) < 0.75:
                    assert gap(bodies[i], bodies[j]) > 0, f"robots {j} and {i} touch at {pose}"

    def go(self, robot, x, y, theta=0.0):
        self.navigators[robot].go(Goal(self.tick, Pose2(x, y, theta)))

    def run(self, seconds, until=lambda rig: False):
        """Simulated seconds until `until`, or fail."""
        begun = self.tick
        while not until(self):
            assert (self.tick - begun) * TICK < seconds, self.describe()
            self.step()
        return (self.tick - begun) * TICK

    def describe(self):
        return [
            (said.state, pose, result) for said, pose, result in zip(self.said, self.poses, self.results, strict=True)
        ]


def everybody_arrived(rig):
    return all(results and isinstance(results[-1], GoalReached) for results in rig.results)


def dead_end():
    """A corridor of 1.2 m that opens into a room on its right: who stands in the corridor can only go into the room."""
    cells = np.full((80, 200), 100, np.int8)
    cells[28:52, 4:120] = 0
    cells[10:70, 120:196] = 0
    return OccupancyGrid(cells, 0.05, Pose2(0, 0, 0))

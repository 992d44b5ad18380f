"""Snapshots of a session as arrays: the truth, what robots sense and believe, the game."""

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.observations import TICK
from sim.team import TeamSnapshot
from thbridge.hunt.game import GameState

Floats: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]
Booleans: TypeAlias = NDArray[np.bool_]
Ranges: TypeAlias = NDArray[np.float32]


@dataclass(frozen=True, eq=False, repr=False)
class HuntSnapshot:
    """State of a session after a tick, as arrays: a row for each of the n robots, robot 1 first; rooms likewise.

    Poses are x, y (meters), theta (radians) in the map. What begins with `true_` neither robots nor participant know.
    The arrays are made when they are asked for; they are the caller's to read, not to write.

    Attributes:
        tick: ticks of 20 ms since the session began.
        seconds: simulated time since the session began.
        true_poses: (n, 3) poses.
        true_twists: (n, 2) velocities: m/s forward, rad/s anti-clockwise.
        true_collisions: (n,) how often each robot has begun to touch something.
        commands: (n, 2) velocities that are asked of the motors: m/s, rad/s.
        game: number of the game; 0 before the first.
        score: points.
        over: reason for the game's end: "all-visited", "no-move-left", "given-up"; None while it goes on.
    """

    tick: int
    seconds: float
    true_poses: Floats
    true_twists: Floats
    true_collisions: Integers
    commands: Floats
    game: int
    score: int
    over: str | None
    _team: TeamSnapshot
    _game: GameState | None
    _scans: tuple[Ranges, ...]

    @cached_property
    def true_treasures(self) -> tuple[str, ...]:
        """Names of what is hidden in the rooms; empty before it is hidden."""
        treasures = None if self._game is None else self._game.treasures
        return () if treasures is None else tuple(kind.name for kind in treasures)

    # What robots sense and believe

    @cached_property
    def poses(self) -> Floats:
        """(n, 3) poses that robots believe."""
        return _poses([output.estimate.base_in_map for output in self._team.robots])

    @cached_property
    def covariances(self) -> Floats:
        """(n, 3, 3) covariances of these: m^2, m rad, rad^2."""
        return np.stack([output.estimate.covariance for output in self._team.robots])

    @property
    def particles(self) -> tuple[Floats, ...]:
        """(m, 3) poses of each robot's particles; m is 0 for localizers without."""
        return tuple(output.estimate.particles for output in self._team.robots)

    @cached_property
    def lost(self) -> Booleans:
        """(n,) True where a robot holds itself to be lost."""
        return np.array([output.estimate.lost for output in self._team.robots])

    @cached_property
    def p_wrong(self) -> Floats:
        """(n,) probability that each believed pose is more than 1 m or 0.5 rad off; NaN before the first scan."""
        known = [output.estimate.p_wrong for output in self._team.robots]
        return np.array([np.nan if p_wrong is None else p_wrong for p_wrong in known])

    @cached_property
    def odometry(self) -> Floats:
        """(n, 3) poses by the wheels alone, each in the robot's own frame `odom`."""
        return _poses([output.observations.odometry.base_in_odom for output in self._team.robots])

    @cached_property
    def twists(self) -> Floats:
        """(n, 2) velocities that the wheels measured: m/s, rad/s."""
        twists = [output.observations.odometry.twist for output in self._team.robots]
        return np.array([(twist.linear, twist.angular) for twist in twists])

    @cached_property
    def scans(self) -> Ranges:
        """(n, beams) ranges of each robot's last scan, meters: infinite beyond the greatest range, NaN where lost."""
        return np.stack(self._scans)

    # What robots do

    @cached_property
    def goals(self) -> Floats:
        """(n, 3) goals of robots; NaN without one."""
        goals = [output.navigation.goal for output in self._team.robots]
        return _poses([_NOWHERE if goal is None else goal.base_in_map for goal in goals])

    @property
    def states(self) -> tuple[str, ...]:
        """State of each robot's move_base: "idle", "planning", "controlling", "clearing"; "dead" of a dead robot."""
        dead = self._team.dead
        return tuple("dead" if robot in dead else each.navigation.state for robot, each in enumerate(self._team.robots))

    @property
    def plans(self) -> tuple[Floats, ...]:
        """(m, 3) poses that each robot has still to drive through; m is 0 without a plan."""
        return tuple(output.navigation.plan for output in self._team.robots)

    @cached_property
    def remaining(self) -> Floats:
        """(n,) meters of these plans."""
        return np.array([output.navigation.remaining for output in self._team.robots])

    # The game

    @cached_property
    def energy(self) -> Floats:
        """(n,) energy left; before the first game that of the batteries."""
        if self._game is None:
            return np.array([output.observations.battery.charge for output in self._team.robots])
        return np.array([robot.energy for robot in self._game.robots])

    @cached_property
    def places(self) -> Integers:
        """(n,) number of the room in which each robot stands, or from which it set out; 0: the corridor."""
        robots = () if self._game is None else self._game.robots
        return np.array([robot.at.people for robot in robots], dtype=np.int64)

    @cached_property
    def bound_for(self) -> Integers:
        """(n,) number of the room to which each robot drives for the game; 0: none."""
        robots = () if self._game is None else self._game.robots
        return np.array([0 if each.bound_for is None else each.bound_for.people for each in robots], dtype=np.int64)

    @cached_property
    def costs(self) -> Floats:
        """(n, rooms) energy of a move of each robot to each room; infinite where there is none."""
        robots = range(0 if self._game is None else len(self._game.robots))
        return np.array([self._game.costs_from(robot)[1:] for robot in robots if self._game is not None])

    @cached_property
    def visited(self) -> Booleans:
        """(rooms,) True where a robot has arrived."""
        return np.array([room.visited for room in (() if self._game is None else self._game.rooms)], dtype=np.bool_)

    @cached_property
    def named(self) -> tuple[str | None, ...]:
        """Name that the treasure of each room was given; None where it has none yet."""
        return tuple(room.name for room in (() if self._game is None else self._game.rooms))

    def __repr__(self) -> str:
        score = "no game yet" if self._game is None else f"score {self.score}, {int(self.visited.sum())} rooms visited"
        return f"<HuntSnapshot {self.seconds:.2f} s, {len(self._team.robots)} robots, {score}>"


def snapshot_of(team: TeamSnapshot, game: GameState | None, scans: tuple[Ranges, ...]) -> HuntSnapshot:
    """Return a snapshot of a team, its game, and the last scan of each robot."""
    ended = None if game is None else game.ended
    return HuntSnapshot(
        tick=team.tick,
        seconds=team.tick * TICK,
        true_poses=team.truth.poses,
        true_twists=team.truth.twists,
        true_collisions=team.truth.collisions,
        commands=team.commands,
        game=0 if game is None else game.started.game,
        score=0 if game is None else game.score,
        over=None if ended is None else ended.reason.value,
        _team=team,
        _game=game,
        _scans=scans,
    )


def team_of(snapshot: HuntSnapshot) -> tuple[TeamSnapshot, tuple[Ranges, ...]]:
    """Return what a snapshot is made of: the team, and the last scan of each robot."""
    return snapshot._team, snapshot._scans


def _poses(poses: list[Pose2]) -> Floats:
    return np.array([(pose.x, pose.y, pose.theta) for pose in poses])


_NOWHERE = Pose2(np.nan, np.nan, np.nan)

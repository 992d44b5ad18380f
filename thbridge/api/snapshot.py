"""Snapshots of a session as arrays: true state, measurements and beliefs of robots, and the game."""

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.observations import TICK
from sim.snapshot import TeamSnapshot
from thbridge.hunt.game import GameState

Floats: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]
Booleans: TypeAlias = NDArray[np.bool_]
Ranges: TypeAlias = NDArray[np.float32]


@dataclass(frozen=True, eq=False, repr=False)
class HuntSnapshot:
    """State of a session after a tick, as arrays with one row per robot or room, in the order of the numbers.

    Poses are x, y (meters) and theta (radians) in the map frame. Neither robots nor the participant know the values
    that begin with `true_`. Arrays are computed on first access; do not modify them.

    Attributes:
        tick: ticks of 20 ms since the session began.
        seconds: simulated time since the session began.
        true_poses: (n, 3) poses.
        true_twists: (n, 2) velocities: forward (m/s) and counterclockwise (rad/s).
        true_collisions: (n,) number of contacts that each robot has begun.
        commands: (n, 2) velocities commanded to the motors (m/s, rad/s).
        game: number of the game; 0 before the first game.
        score: points.
        over: reason why the game ended: "all-visited", "no-move-left" or "given-up"; None before the end.
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
        """Names of the hidden treasures, one per room; empty before the treasures are hidden."""
        treasures = None if self._game is None else self._game.treasures
        return () if treasures is None else tuple(kind.name for kind in treasures)

    # Measurements and beliefs of robots

    @cached_property
    def poses(self) -> Floats:
        """(n, 3) estimated poses."""
        return _poses([output.estimate.base_in_map for output in self._team.robots])

    @cached_property
    def covariances(self) -> Floats:
        """(n, 3, 3) covariances of the estimated poses (m^2, m rad, rad^2)."""
        return np.stack([output.estimate.covariance for output in self._team.robots])

    @property
    def particles(self) -> tuple[Floats, ...]:
        """(m, 3) poses of each robot's particles; m is 0 for localizers without particles."""
        return tuple(output.estimate.particles for output in self._team.robots)

    @cached_property
    def lost(self) -> Booleans:
        """(n,) True for each robot that considers itself lost."""
        return np.array([output.estimate.lost for output in self._team.robots])

    @cached_property
    def p_wrong(self) -> Floats:
        """(n,) probability that the estimated pose is more than 1 m or 0.5 rad off; NaN before the first scan."""
        known = [output.estimate.p_wrong for output in self._team.robots]
        return np.array([np.nan if p_wrong is None else p_wrong for p_wrong in known])

    @cached_property
    def odometry(self) -> Floats:
        """(n, 3) poses according to wheel odometry alone, each in the robot's own `odom` frame."""
        return _poses([output.observations.odometry.base_in_odom for output in self._team.robots])

    @cached_property
    def twists(self) -> Floats:
        """(n, 2) velocities measured by the wheels (m/s, rad/s)."""
        twists = [output.observations.odometry.twist for output in self._team.robots]
        return np.array([(twist.linear, twist.angular) for twist in twists])

    @cached_property
    def scans(self) -> Ranges:
        """(n, beams) ranges of each robot's last scan, meters; infinite beyond the largest range, NaN if lost."""
        return np.stack(self._scans)

    # Actions of robots

    @cached_property
    def goals(self) -> Floats:
        """(n, 3) goal poses; NaN if a robot has no goal."""
        goals = [output.navigation.goal for output in self._team.robots]
        return _poses([_NOWHERE if goal is None else goal.base_in_map for goal in goals])

    @property
    def states(self) -> tuple[str, ...]:
        """State of each robot's move_base ("idle", "planning", "controlling", "clearing"); "dead" for a dead robot."""
        dead = self._team.dead
        return tuple("dead" if robot in dead else each.navigation.state for robot, each in enumerate(self._team.robots))

    @property
    def plans(self) -> tuple[Floats, ...]:
        """(m, 3) poses of the rest of each robot's plan; m is 0 if there is no plan."""
        return tuple(output.navigation.plan for output in self._team.robots)

    @cached_property
    def remaining(self) -> Floats:
        """(n,) length of the rest of each plan, meters."""
        return np.array([output.navigation.remaining for output in self._team.robots])

    # The game

    @cached_property
    def energy(self) -> Floats:
        """(n,) remaining energy; before the first game, the charge of the batteries."""
        if self._game is None:
            return np.array([output.observations.battery.charge for output in self._team.robots])
        return np.array([robot.energy for robot in self._game.robots])

    @cached_property
    def places(self) -> Integers:
        """(n,) number of the last room of each robot: where it is, or from where it departed; 0 is the corridor."""
        robots = () if self._game is None else self._game.robots
        return np.array([robot.at.people for robot in robots], dtype=np.int64)

    @cached_property
    def bound_for(self) -> Integers:
        """(n,) number of the room to which each robot is driving; 0 if the robot is at rest."""
        robots = () if self._game is None else self._game.robots
        return np.array([0 if each.bound_for is None else each.bound_for.people for each in robots], dtype=np.int64)

    @cached_property
    def costs(self) -> Floats:
        """(n, rooms) energy of a move of each robot to each room; infinite if no move is possible."""
        robots = range(0 if self._game is None else len(self._game.robots))
        return np.array([self._game.costs_from(robot)[1:] for robot in robots if self._game is not None])

    @cached_property
    def visited(self) -> Booleans:
        """(rooms,) True for each room that a robot has reached."""
        return np.array([room.visited for room in (() if self._game is None else self._game.rooms)], dtype=np.bool_)

    @cached_property
    def named(self) -> tuple[str | None, ...]:
        """Name given to the treasure in each room; None if no name was given yet."""
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
    """Return the team's state and the last scan of each robot that a snapshot contains."""
    return snapshot._team, snapshot._scans


def _poses(poses: list[Pose2]) -> Floats:
    return np.array([(pose.x, pose.y, pose.theta) for pose in poses])


_NOWHERE = Pose2(np.nan, np.nan, np.nan)

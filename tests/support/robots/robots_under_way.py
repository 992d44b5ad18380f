"""Robots that are always under way, for measurements of whole teams."""

import gc
import time
from collections.abc import Callable, Sequence

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import SendGoal, TeamInput
from sim.numerics.float_array import FloatArray
from sim.numerics.noise_arrays import NoiseStream
from sim.robot.navigator.goals import Goal
from sim.snapshot import TeamSnapshot
from sim.team import Team


class Errands:
    """Generator of goals: it sends each standing robot to a place that no robot is at or driving to."""

    def __init__(self, goals: Sequence[Pose2], robots: int) -> None:
        self._goals = goals
        self._bound = [-1] * robots
        self._chance = NoiseStream.named(1, "errands")
        self._count = 0

    def next(self, snapshot: TeamSnapshot | None) -> list[TeamInput]:
        inputs: list[TeamInput] = []
        for robot in range(len(self._bound) if self._goals else 0):
            if snapshot is not None and snapshot.robots[robot].navigation.goal is not None:
                continue
            free = [room for room in range(len(self._goals)) if room not in self._bound]
            if not free:
                continue
            self._count += 1
            self._bound[robot] = free[int(self._chance.uniforms(self._count, 1)[0] * len(free))]
            inputs.append(SendGoal(robot, Goal(self._count, self._goals[self._bound[robot]])))
        return inputs


def drive(
    team: Team, goals: Sequence[Pose2], seconds: int, watch: Callable[[TeamSnapshot], None] = lambda _: None
) -> FloatArray:
    """Return the CPU seconds of each tick of a drive of `seconds` simulated seconds.

    Without goals, all robots stand still.
    """
    gc.freeze()  # as a session does before its first tick
    errands = Errands(goals, team.size)
    snapshot, spent = None, []
    for _ in range(seconds * TICKS_PER_SECOND):
        began = time.process_time()
        snapshot = team.step(errands.next(snapshot))
        watch(snapshot)
        spent.append(time.process_time() - began)
    return np.array(spent)


def best_ticks(runs: Sequence[FloatArray]) -> FloatArray:
    """Return the CPU seconds of each tick, the least of several runs of the same drive; all runs do the same
    computations."""
    return np.minimum.reduce(list(runs))

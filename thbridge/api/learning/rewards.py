"""Rewards of agents: points for treasures, rooms reached, energy and time."""

import math
from dataclasses import dataclass

from thbridge.hunt.game import GameState


@dataclass(frozen=True, slots=True)
class RewardWeights:
    """Weights of the rewards, in points.

    Attributes:
        shared: If True, each agent gets the reward of the team. If False, each agent gets the reward of its robot.
        room: reward for each room reached, in addition to the points for treasures.
        energy: cost per unit of energy.
        time: cost per simulated second.
    """

    shared: bool
    room: float
    energy: float
    time: float

    def rewards(self, before: GameState, now: GameState, seconds: float) -> list[float]:
        """Return the reward of each agent for the changes between two states of a game."""
        own = [-self.time * seconds] * len(now.robots)
        if now is not before:
            for robot, (was, state) in enumerate(zip(before.robots, now.robots, strict=True)):
                own[robot] -= self.energy * (was.energy - state.energy)
            for past, room in zip(before.rooms, now.rooms, strict=True):
                if room is past or room.finder is None:
                    continue
                if not past.visited:
                    own[room.finder] += self.room
                if room.points is not None and past.points is None:
                    own[room.finder] += room.points
        return [math.fsum(own)] * len(own) if self.shared else own

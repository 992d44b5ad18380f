"""Policies that choose the next room of each robot in an environment."""

from collections.abc import Mapping
from pathlib import Path
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sim.numerics import noise
from thbridge.api.learning import AbstractHuntEnv, HuntEnv

Env: TypeAlias = HuntEnv | AbstractHuntEnv
Observations: TypeAlias = Mapping[str, NDArray[np.float32]]
Infos: TypeAlias = Mapping[str, Mapping[str, object]]


class Policy(Protocol):
    """Policy that chooses rooms."""

    def begin(self, env: Env, seed: int) -> None:
        """Begin the episode of a seed."""

    def choose(self, agent: str, costs: NDArray[np.float64], rooms: NDArray[np.int64]) -> int:
        """Return one of the rooms that an agent may choose.

        Args:
            agent: name of the agent.
            costs: energy costs of all rooms, from room 1 on.
            rooms: numbers of the rooms that the agent may choose.
        """


class RandomPolicy:
    """Policy that chooses a random room. With the same seed and the same possible rooms, it chooses the same room."""

    def begin(self, env: Env, seed: int) -> None:
        """See `Policy`."""
        self._key = noise.key(seed, "random policy")
        self._chosen = dict.fromkeys(env.possible_agents, 0)

    def choose(self, agent: str, costs: NDArray[np.float64], rooms: NDArray[np.int64]) -> int:
        """See `Policy`."""
        self._chosen[agent] += 1
        number = int(agent.rpartition("_")[2])
        return int(rooms[int(noise.uniform(self._key, number, self._chosen[agent]) * len(rooms))])


class CheapestPolicy:
    """Policy that chooses the cheapest room; if several rooms are equally cheap, the first."""

    def begin(self, env: Env, seed: int) -> None:
        """See `Policy`."""

    def choose(self, agent: str, costs: NDArray[np.float64], rooms: NDArray[np.int64]) -> int:
        """See `Policy`."""
        return int(rooms[np.argmin(costs[rooms - 1])])


class TablePolicy:
    """Policy with a preference for each room by agent and place.

    While learning, it samples by softmax; otherwise it chooses the greatest preference.

    Args:
        table: (agents, rooms + 1, rooms) preferences; place 0 is the start, others are rooms by number.
        dice: random generator for learning. If None, the room with the greatest preference is chosen.

    Attributes:
        table: table of preferences.
        gradient: gradient of the log-probability of all choices of the episode with respect to the table.
    """

    def __init__(self, table: NDArray[np.float64], dice: np.random.Generator | None = None) -> None:
        self.table = table
        self.gradient = np.zeros_like(table)
        self._dice = dice

    @classmethod
    def read(cls, file: Path) -> "TablePolicy":
        """Return the policy whose table `numpy.save` wrote to a file."""
        return cls(np.load(file))

    def begin(self, env: Env, seed: int) -> None:
        """See `Policy`."""
        self.gradient = np.zeros_like(self.table)
        self._at = dict.fromkeys(env.possible_agents, 0)

    def choose(self, agent: str, costs: NDArray[np.float64], rooms: NDArray[np.int64]) -> int:
        """See `Policy`."""
        robot, at = int(agent.rpartition("_")[2]) - 1, self._at[agent]
        preferences = self.table[robot, at, rooms - 1]
        if self._dice is None:
            chosen = int(np.argmax(preferences))
        else:
            weights = np.exp(preferences - preferences.max())
            shares = weights / weights.sum()
            chosen = min(int(np.searchsorted(shares.cumsum(), self._dice.random())), len(rooms) - 1)
            self.gradient[robot, at, rooms - 1] -= shares
            self.gradient[robot, at, rooms[chosen] - 1] += 1.0
        self._at[agent] = int(rooms[chosen])
        return int(rooms[chosen])


def play(env: Env, policy: Policy, seed: int) -> int:
    """Play the episode of a seed to its end, with one agent after the other, and return the score."""
    observations, infos = env.reset(seed=seed)
    policy.begin(env, seed)
    while env.agents:
        actions: dict[str, int] = {}
        for agent in env.agents:
            free = np.flatnonzero(np.asarray(infos[agent]["action_mask"]))[1:]
            rooms = free[~np.isin(free, list(actions.values()))]
            if len(rooms):
                costs = observations[agent][env.layout["costs"]].astype(np.float64)
                actions[agent] = policy.choose(agent, costs, rooms)
        observations, _, _, _, infos = env.step(actions)
    return int(str(infos[env.possible_agents[0]]["score"]))

"""Base class of the environments: agents, actions, observations, rewards and seeds."""

from abc import abstractmethod
from collections.abc import Mapping
from typing import Literal, TypeAlias, cast

import numpy as np

from sim.common.observations import TICK, TICKS_PER_SECOND
from sim.common.robot_numbers import number_of
from sim.numerics import noise
from thbridge.api.errors import HuntError
from thbridge.api.learning.choices import RobotChoices
from thbridge.api.learning.observation import (
    BodyNumbers,
    LayoutOfParts,
    ObservationEncoder,
    ObservationScale,
    Vector,
)
from thbridge.api.learning.rewards import RewardWeights
from thbridge.api.learning.treasure_rule import TreasureRule
from thbridge.api.study import HuntStudy, setting_of
from thbridge.app.compose.setting import StudySetting
from thbridge.hunt.game import GameState
from thbridge.roles.shared.robot_requests import StationSend

try:
    from gymnasium.spaces import Box, Discrete, Space
    from pettingzoo import ParallelEnv
except ImportError as error:
    raise ImportError("environments need PettingZoo: pip install 'thbridge[learning]'") from error

Action: TypeAlias = int | np.int64 | Vector
Info: TypeAlias = "dict[str, object]"
Decision: TypeAlias = Literal["decision"]

LARGEST_SEED = 2**31 - 1
"""Largest seed that a study accepts."""


class TeamEnvironment(ParallelEnv[str, Vector, Action]):
    """Environment in which each agent `robot_1`, `robot_2`, ... decides for one robot of a hunt.

    Subclasses move the robots. `HuntEnv` describes the arguments.

    Attributes:
        study: the study.
        layout: positions of the parts of an observation in the vector.
    """

    def __init__(
        self,
        study: HuntStudy,
        name: str,
        step: float | Decision,
        max_seconds: float,
        *,
        shared: bool,
        room_reward: float,
        energy_cost: float,
        time_cost: float,
        render_mode: Literal["rgb_array"] | None,
        drives: bool = False,
    ) -> None:
        if not isinstance(step, str) and round(step * TICKS_PER_SECOND) < 1:
            raise HuntError(f"step: {step:g} s is less than a tick. Give at least {TICK:g} s.", key="step")
        self.metadata = {"name": name, "render_modes": ["rgb_array"], "is_parallelizable": True}
        self.study = study
        self.render_mode = render_mode
        self._ticks = None if isinstance(step, str) else round(step * TICKS_PER_SECOND)
        self._last_tick = round(max_seconds * TICKS_PER_SECOND)
        self._weights = RewardWeights(shared, room_reward, energy_cost, time_cost)
        self._drives = drives
        self._setting = setting_of(study)
        self._goals = tuple(room.goal for room in self._setting.map.rooms)
        self._encoder = ObservationEncoder(
            study.robots, self._goals, _scale(self._setting, max_seconds), with_scans=drives
        )
        self.layout: LayoutOfParts = self._encoder.layout
        self._rule = TreasureRule.of(self._setting.templates.kinds)
        self.possible_agents = [f"robot_{number_of(robot)}" for robot in range(study.robots)]
        self.agents: list[str] = []
        box = (-1.0, 1.0, (self._encoder.size,), np.float32)
        self.observation_spaces = {agent: Box(*box) for agent in self.possible_agents}
        self.action_spaces = {agent: self._action_space() for agent in self.possible_agents}
        self._seed, self._episode = study.seed, 0
        self._choices = RobotChoices(self._rule, len(self._goals))

    def _action_space(self) -> Space[Action]:
        space = Box(-1.0, 1.0, (2,), np.float32) if self._drives else Discrete(len(self._goals) + 1)
        return cast(Space[Action], space)

    def observation_space(self, agent: str) -> Space[Vector]:
        """Return the space of an agent's observations."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Space[Action]:
        """Return the space of an agent's actions."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: Mapping[str, object] | None = None
    ) -> tuple[dict[str, Vector], dict[str, Info]]:
        """Start an episode.

        Args:
            seed: seed of this episode. If None, the last given seed determines the seeds of the following episodes.
            options: `{"record": "episode.bag"}` records the episode; other options have no effect.

        Raises:
            HuntError: the episode cannot be recorded at this path, or this environment cannot record.
        """
        self.close()
        self._episode = self._episode + 1 if seed is None else 0
        self._seed = self._seed if seed is None else seed
        record = (options or {}).get("record")
        self._begin(_seed_of(self._seed, self._episode), None if record is None else str(record))
        self.agents = list(self.possible_agents)
        game, tick = self._now
        return self._observations(game, tick), self._infos(game, {})

    def step(
        self, actions: Mapping[str, Action]
    ) -> tuple[dict[str, Vector], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Info]]:
        """Apply actions, and run for the duration of a step. If an agent has no action, its robot waits or stops.

        Raises:
            HuntError: `reset` has not been called, or an action is outside its space.
        """
        before, began = self._now
        if not self.agents:
            # Wrappers also call this method after all agents are done.
            return {}, {}, {}, {}, {}
        accepted = self._act(before, actions)
        self._run()
        game, tick = self._now
        rewards = dict(
            zip(self.possible_agents, self._weights.rewards(before, game, (tick - began) * TICK), strict=True)
        )
        is_over = game.ended is not None
        is_late = not is_over and tick >= self._last_tick
        observations, infos = self._observations(game, tick), self._infos(game, accepted)
        agents = self.agents
        if is_over or is_late:
            self.agents = []
        return observations, rewards, dict.fromkeys(agents, is_over), dict.fromkeys(agents, is_late), infos

    def state(self) -> Vector:
        """Return the observations of all agents as one vector, for central critics.

        Raises:
            HuntError: `reset` has not been called.
        """
        return np.concatenate(list(self._observations(*self._now).values()))

    # Methods of the subclasses

    @abstractmethod
    def close(self) -> None:
        """End the episode."""

    @property
    @abstractmethod
    def _now(self) -> tuple[GameState, int]:
        """State of the game, and the current tick. Raises HuntError: no episode is in progress."""

    @abstractmethod
    def _begin(self, seed: int, record: str | None) -> None:
        """Start a game in which the caller commands all robots."""

    @abstractmethod
    def _send(self, request: StationSend) -> None:
        """Send a robot to a room."""

    @abstractmethod
    def _run(self) -> None:
        """Run for the duration of a step, or until the game or the episode ends."""

    @abstractmethod
    def _bodies(self) -> list[BodyNumbers]:
        """Return the numbers in observations that do not come from the game, for each robot."""

    # Actions

    def _act(self, game: GameState, actions: Mapping[str, Action]) -> dict[str, bool]:
        """Send robots to rooms; return one flag per agent, True if the agent's action counts."""
        taken: list[int] = []
        choices = self._choices.rooms(game)
        accepted = {}
        for robot, agent in enumerate(self.possible_agents):
            action = actions.get(agent, 0)
            room = action if isinstance(action, int) else int(np.asarray(action).item())
            if not 0 <= room <= len(self._goals):
                raise HuntError(f"{agent}: there is no action {room}. Choose an action from 0 to {len(self._goals)}.")
            counts = room == 0 or (room not in taken and any(room == each.people for each in choices[robot]))
            if counts and room > 0:
                taken.append(room)
                self._send(StationSend(robot, room))
            accepted[agent] = counts
        return accepted

    # Results for agents

    def _observations(self, game: GameState, tick: int) -> dict[str, Vector]:
        rows = self._encoder.encode(tick, self._bodies(), game, self._choices.ready(game))
        return dict(zip(self.possible_agents, rows, strict=True))

    def _infos(self, game: GameState, accepted: Mapping[str, bool]) -> dict[str, Info]:
        infos: dict[str, Info] = {agent: {"score": game.score} for agent in self.possible_agents}
        for agent, counts in accepted.items():
            infos[agent]["accepted"] = counts
        if not self._drives:
            for agent, mask in zip(self.possible_agents, self._choices.masks(game), strict=True):
                infos[agent]["action_mask"] = mask
        return infos


def _seed_of(seed: int, episode: int) -> int:
    """Return the seed of an episode: the given seed for the first episode, pseudo-random seeds for later episodes."""
    if episode == 0:
        return seed & LARGEST_SEED
    return int(noise.uniform(noise.key(seed, "episodes"), episode, 0) * LARGEST_SEED)


def _scale(setting: StudySetting, seconds: float) -> ObservationScale:
    """Return the magnitudes that are scaled to 1 in observations; `seconds` is the duration of an episode."""
    grid, world = setting.map.grid, setting.study.world
    width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
    corners = grid.origin.transform(np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]))
    (left, low), (right, high) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return ObservationScale(
        left,
        low,
        right - left,
        high - low,
        setting.study.game.energy,
        world.max_vel_x,
        world.max_vel_theta,
        world.laser.range_max,
        seconds,
    )

"""The environment: agents choose rooms, or velocities, for the robots of one hunt."""

from collections.abc import Mapping
from typing import Literal, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.observations import TICK, TICKS_PER_SECOND, Twist
from sim.common.robot_numbers import index_of, number_of
from sim.inputs import DriveManually
from sim.numerics import noise
from thbridge.api.errors import HuntError
from thbridge.api.learning.observation import (
    LayoutOfParts,
    Mask,
    ObservationEncoder,
    ObservationScale,
    Vector,
    action_masks,
)
from thbridge.api.learning.treasure_rule import TreasureRule
from thbridge.api.session import SENDER, HuntSession, inside
from thbridge.api.snapshot import team_of
from thbridge.api.study import HuntStudy, seeded, setting_of
from thbridge.hunt.events import Commander
from thbridge.hunt.game import GameState
from thbridge.roles.robot_requests import StationSend, TakeCommand

try:
    from gymnasium.spaces import Box, Discrete, Space
    from pettingzoo import ParallelEnv
except ImportError as error:
    raise ImportError("environments need PettingZoo: pip install 'thbridge[learning]'") from error

Action: TypeAlias = int | np.int64 | Vector
Info: TypeAlias = "dict[str, object]"
Decision: TypeAlias = Literal["decision"]

TOGETHER = 10 * TICKS_PER_SECOND
"""Ticks within which a game has begun and its treasures are hidden."""

LARGEST_SEED = 2**31 - 1
"""The largest that a study takes."""


class HuntEnv(ParallelEnv[str, Vector, Action]):
    """A hunt whose agents `robot_1`, `robot_2`, ... decide for one robot each; PettingZoo's parallel interface.

    With `control="rooms"` an action is 0 to wait, or the number of a room to go to; it counts when the robot is ready,
    and the room free and within its energy (`infos[agent]["action_mask"]`), else the robot goes on with what it does.
    With `control="velocity"` it is (2,), speed forward and rate of turn to the left, in [-1, 1] of what motors reach;
    a robot that comes within `reach` of a free room's goal is driven into it by its own software, by the game's rules.

    Treasures are sensed, pictured and named by a rule (`TreasureRule`). Observations are what a robot believes and its
    team knows, never the truth; `layout` names their parts.

    Args:
        study: the study; None: the default one with `robots`.
        robots: size of the team, where there is no study.
        control: what agents choose.
        step: simulated seconds of a step, by default 1, or 0.1 for velocities; "decision": until a robot is ready.
        max_seconds: simulated seconds after which an episode is truncated.
        shared: every agent gets the reward of the team; False: each that of its own robot.
        room_reward: reward of a room reached, beside the points of treasures.
        energy_cost: cost of a unit of energy.
        time_cost: cost of a simulated second.
        reach: metres, see above.
        render_mode: "rgb_array" for pictures by `render`.

    Raises:
        HuntError: an argument does not fit.

    Attributes:
        study: the study.
        layout: places of the parts of an observation.
        session: the hunt that is being played.
    """

    def __init__(
        self,
        study: HuntStudy | None = None,
        *,
        robots: int = 2,
        control: Literal["rooms", "velocity"] = "rooms",
        step: float | Decision | None = None,
        max_seconds: float = 600.0,
        shared: bool = True,
        room_reward: float = 0.0,
        energy_cost: float = 0.0,
        time_cost: float = 0.0,
        reach: float = 0.6,
        render_mode: Literal["rgb_array"] | None = None,
    ) -> None:
        if control not in {"rooms", "velocity"}:
            raise HuntError(
                f"control: {control!r} is nothing that agents choose. Write rooms or velocity.", key="control"
            )
        drives = control == "velocity"
        if step is None:
            step = 0.1 if drives else 1.0
        if step == "decision" and drives:
            raise HuntError("step: who drives decides all the time. Give seconds.", key="step")
        if not isinstance(step, str) and round(step * TICKS_PER_SECOND) < 1:
            raise HuntError(f"step: {step:g} s is less than a tick. Give at least {TICK:g}.", key="step")
        self.metadata = {"name": "thbridge_hunt_v0", "render_modes": ["rgb_array"], "is_parallelizable": True}
        self.study = HuntStudy(robots=robots) if study is None else study
        self.render_mode = render_mode
        self._ticks = None if isinstance(step, str) else round(step * TICKS_PER_SECOND)
        self._last_tick = round(max_seconds * TICKS_PER_SECOND)
        self._shared = shared
        self._room_reward, self._energy_cost, self._time_cost = room_reward, energy_cost, time_cost
        self._drives, self._reach = drives, reach
        setting = setting_of(self.study)
        place, world = setting.map, setting.study.world
        self._speed, self._turn = world.max_vel_x, world.max_vel_theta
        grid = place.grid
        width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
        corners = grid.origin.transform(np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]))
        (left, low), (right, high) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
        energy = setting.study.game.energy
        scale = ObservationScale(
            left, low, right - left, high - low, energy, self._speed, self._turn, world.laser.range_max, max_seconds
        )
        self._goals = tuple(room.goal for room in place.rooms)
        self._encoder = ObservationEncoder(self.study.robots, self._goals, scale, with_scans=drives)
        self.layout: LayoutOfParts = self._encoder.layout
        self._rule = TreasureRule.of(setting.templates.kinds)
        self.possible_agents = [f"robot_{number_of(robot)}" for robot in range(self.study.robots)]
        self.agents: list[str] = []
        box = (-1.0, 1.0, (self._encoder.size,), np.float32)
        self.observation_spaces = {agent: Box(*box) for agent in self.possible_agents}
        self.action_spaces = {agent: self._action_space() for agent in self.possible_agents}
        self.session: HuntSession | None = None
        self._seed, self._episode = self.study.seed, 0
        self._decided: GameState | None = None
        self._masked: GameState | None = None
        self._masks: list[Mask] = []

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
        """Begin an episode.

        Args:
            seed: of this episode and those that follow; None: the next of the last one given.
            options: `{"record": "episode.bag"}` records the episode; others have no effect.

        Raises:
            HuntError: it cannot be recorded there.
        """
        self.close()
        self._episode = self._episode + 1 if seed is None else 0
        self._seed = self._seed if seed is None else seed
        record = (options or {}).get("record")
        study = seeded(self.study, _seed_of(self._seed, self._episode))
        self.session = HuntSession(study, record=None if record is None else str(record))
        self.agents = list(self.possible_agents)
        self._decided = self._masked = None
        game = self._begin(self.session)
        return self._observations(self.session, game), self._infos(game, {})

    def step(
        self, actions: Mapping[str, Action]
    ) -> tuple[dict[str, Vector], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Info]]:
        """Act, and run for the time of a step; an agent without an action waits, or stands.

        Raises:
            HuntError: the environment is not reset, or an action is outside its space.
        """
        session = self.session
        if session is None:
            raise HuntError("no episode is under way. Reset the environment first.")
        if not self.agents:
            # Wrappers step on when all agents are done.
            return {}, {}, {}, {}, {}
        before = self._game(session)
        # What was refused because somebody else commanded a robot is asked for again.
        self._decided = None
        accepted = self._drive(session, before, actions) if self._drives else self._send(session, before, actions)
        began, seen = session.tick, len(session.events)
        game = self._run(session)
        rewards = self._rewards(before, game, session, seen, (session.tick - began) * TICK)
        is_over = game.ended is not None
        is_late = not is_over and session.tick >= self._last_tick
        observations, infos = self._observations(session, game), self._infos(game, accepted)
        agents = self.agents
        if is_over or is_late:
            self.agents = []
        return observations, rewards, dict.fromkeys(agents, is_over), dict.fromkeys(agents, is_late), infos

    def state(self) -> Vector:
        """Return what all agents observe together, for central critics: their observations one after the other.

        Raises:
            HuntError: the environment is not reset.
        """
        if self.session is None:
            raise HuntError("no episode is under way. Reset the environment first.")
        return np.concatenate(list(self._observations(self.session, self._game(self.session)).values()))

    def render(self) -> NDArray[np.uint8] | None:
        """Return a picture of the hunt, (rows, cols, 3), where `render_mode` asks for one: truth and estimates."""
        if self.render_mode is None or self.session is None:
            return None
        from thbridge.api.learning.picture import picture_of  # noqa: PLC0415  # only who asks for pictures needs it

        return picture_of(setting_of(self.study), self.session.snapshot)

    def close(self) -> None:
        """End the episode; a recording is complete then."""
        if self.session is not None:
            self.session.close()
            self.session = None
        self.agents = []

    # The session

    def _begin(self, session: HuntSession) -> GameState:
        """Run until treasures are hidden and the caller commands all robots."""
        hunt = inside(session)
        while hunt.game is None or hunt.game.treasures is None:
            if hunt.tick > TOGETHER:
                raise HuntError("no game begins with this study. Look at its templates and map with `thbridge play`.")
            session.step()
        for robot in range(self.study.robots):
            hunt.ask(SENDER, TakeCommand(robot, SENDER))
        session.step()
        return self._game(session)

    @staticmethod
    def _game(session: HuntSession) -> GameState:
        game = inside(session).game
        assert game is not None  # noqa: S101  # it has begun in `reset`
        return game

    def _run(self, session: HuntSession) -> GameState:
        """Run for the time of a step, and no further than the end of the game or of the episode."""
        hunt, ticks = inside(session), self._ticks
        while True:
            session.step()
            game = self._game(session)
            if game is not self._decided:
                self._decided = game
                for robot in range(len(game.robots)):
                    request = self._rule.request(game, robot)
                    if request is not None:
                        hunt.ask(SENDER, request)
            if ticks is not None:
                ticks -= 1
            elif any(mask.sum() > 1 for mask in self._masks_of(game)):
                return game
            if ticks == 0 or game.ended is not None or session.tick >= self._last_tick:
                return game

    def _is_ready(self, game: GameState, robot: int) -> bool:
        """Return True when a robot could be sent: it stands, is able, and has nothing to decide where it stands."""
        state = game.robots[robot]
        return (
            state.bound_for is None
            and not state.is_blocked
            and not state.is_silent
            and game.ended is None
            and state.command.by is Commander.GROUND_STATION
            and self._rule.request(game, robot) is None
        )

    # Actions

    def _send(self, session: HuntSession, game: GameState, actions: Mapping[str, Action]) -> dict[str, bool]:
        """Send robots to rooms; return for each agent whether its choice counts."""
        masks, taken = self._masks_of(game), set[int]()
        accepted = {}
        for robot, agent in enumerate(self.possible_agents):
            room = int(np.asarray(actions.get(agent, 0)).item())
            if not 0 <= room <= len(self._goals):
                raise HuntError(f"{agent}: there is no action {room}. Choose one of 0 to {len(self._goals)}.")
            counts = bool(masks[robot][room]) and room not in taken
            if counts and room > 0:
                taken.add(room)
                inside(session).ask(SENDER, StationSend(robot, room))
            accepted[agent] = counts
        return accepted

    def _drive(self, session: HuntSession, game: GameState, actions: Mapping[str, Action]) -> dict[str, bool]:
        """Drive robots; those at a free room's goal are sent into it instead, and drive there by themselves."""
        hunt, (team, _) = inside(session), team_of(session.snapshot)
        accepted = {}
        for robot, agent in enumerate(self.possible_agents):
            linear, angular = np.asarray(actions.get(agent, (0.0, 0.0)), dtype=np.float64).tolist()
            if not (abs(linear) <= 1.0 and abs(angular) <= 1.0):
                raise HuntError(f"{agent}: ({linear:g}, {angular:g}) is outside of [-1, 1]. Clip it.")
            state, room = game.robots[robot], self._room_at(game, robot, team.robots[robot].estimate.base_in_map)
            if room is not None and self._is_ready(game, robot):
                hunt.ask(SENDER, StationSend(robot, room))
            free = state.bound_for is None and room is None and self._rule.request(game, robot) is None
            if free and not state.is_silent:
                # A tick longer than a step: who drives on keeps command between two steps.
                twist = Twist(linear * self._speed, angular * self._turn)
                hunt.ask(SENDER, DriveManually(robot, twist, (self._ticks or 1) + 1))
            accepted[agent] = free
        return accepted

    def _room_at(self, game: GameState, robot: int, base_in_map: Pose2) -> int | None:
        """Return the number of the free room, within a robot's energy, whose goal it believes to have reached."""
        state = game.robots[robot]
        for room in game.free_rooms:
            near = base_in_map.distance(self._goals[room.wire]) <= self._reach
            if near and game.cost(robot, room) <= state.energy and not state.is_blocked:
                return room.people
        return None

    # What agents get

    def _observations(self, session: HuntSession, game: GameState) -> dict[str, Vector]:
        team, scans = team_of(session.snapshot)
        rows = self._encoder.encode(team, game, scans, lambda robot: self._is_ready(game, robot))
        return {agent: rows[robot] for robot, agent in enumerate(self.possible_agents)}

    def _infos(self, game: GameState, accepted: Mapping[str, bool]) -> dict[str, Info]:
        infos: dict[str, Info] = {agent: {"score": game.score} for agent in self.possible_agents}
        for agent, counts in accepted.items():
            infos[agent]["accepted"] = counts
        if not self._drives:
            for agent, mask in zip(self.possible_agents, self._masks_of(game), strict=True):
                infos[agent]["action_mask"] = mask
        return infos

    def _masks_of(self, game: GameState) -> list[Mask]:
        if game is not self._masked:
            self._masked = game
            self._masks = action_masks(game, lambda robot: self._is_ready(game, robot))
        return self._masks

    def _rewards(
        self, before: GameState, now: GameState, session: HuntSession, seen: int, seconds: float
    ) -> dict[str, float]:
        own = [-self._time_cost * seconds] * len(self.possible_agents)
        if now is not before:
            for robot, (was, state) in enumerate(zip(before.robots, now.robots, strict=True)):
                own[robot] -= self._energy_cost * (was.energy - state.energy)
            for event in session.events[seen:]:
                points = event.data.get("points")
                if event.robot is None:
                    continue
                if event.kind == "arrived":
                    own[index_of(event.robot)] += self._room_reward
                elif event.kind == "identified" and isinstance(points, int):
                    own[index_of(event.robot)] += points
        if self._shared:
            own = [sum(own)] * len(own)
        return dict(zip(self.possible_agents, own, strict=True))


parallel_env = HuntEnv
"""The name by which PettingZoo's own environments are made."""


def _seed_of(seed: int, episode: int) -> int:
    """Return the seed of an episode: the given one for the first, then drawn ones."""
    if episode == 0:
        return seed & LARGEST_SEED
    return int(noise.uniform(noise.key(seed, "episodes"), episode, 0) * LARGEST_SEED)

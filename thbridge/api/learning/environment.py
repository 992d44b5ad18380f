"""Environment with fully simulated robots: agents choose rooms or velocities for the robots of one session."""

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Twist
from sim.inputs import DriveManually
from thbridge.api.errors import HuntError
from thbridge.api.learning.observation import BodyNumbers
from thbridge.api.learning.team_environment import Action, Decision, TeamEnvironment
from thbridge.api.session import SENDER, HuntSession, inside
from thbridge.api.snapshot import team_of
from thbridge.api.study import HuntStudy, seeded
from thbridge.hunt.game import GameState
from thbridge.roles.shared.robot_requests import CommandRequest, StationSend, TakeCommand

TOGETHER = 10 * TICKS_PER_SECOND
"""Maximum number of ticks until a game has started and its treasures are hidden."""


class HuntEnv(TeamEnvironment):
    """Hunt in which each agent `robot_1`, `robot_2`, ... decides for one robot (PettingZoo's parallel interface).

    With `control="rooms"`, an action is 0 to wait, or the number of a room to go to. The action counts if the robot is
    ready, the room is free, and the robot has enough energy (`infos[agent]["action_mask"]`). Otherwise the robot
    continues its activity.

    With `control="velocity"`, an action is an array (2,) in [-1, 1]: forward speed and rate of turn to the left, as
    fractions of the motors' largest values. When a robot comes within `reach` of the goal of a free room, its own
    software drives it into the room. The rules of the game apply.

    Treasures are sensed, photographed and named by a rule (`TreasureRule`). Observations contain the beliefs of a robot
    and the knowledge of the team, but never the truth; `layout` names the parts of an observation.

    Args:
        study: the study. If None, the default study with `robots` robots is used.
        robots: number of robots, used if no study is given.
        control: kind of the agents' actions, "rooms" or "velocity".
        step: duration of a step in simulated seconds; by default 1, or 0.1 with velocities. "decision" runs until a
            robot is ready.
        max_seconds: simulated seconds after which an episode is truncated.
        shared: If True, each agent gets the reward of the team. If False, each agent gets the reward of its robot.
        room_reward: reward for each room reached, in addition to the points for treasures.
        energy_cost: cost per unit of energy.
        time_cost: cost per simulated second.
        reach: distance to the goal of a room in meters, used with velocities; see above.
        render_mode: "rgb_array" makes `render` return images.

    Raises:
        HuntError: an argument is invalid.

    Attributes:
        study: the study.
        layout: positions of the parts of an observation in the vector.
        session: session of the hunt in progress.
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
            raise HuntError(f"control: unknown value {control!r}. Write rooms or velocity.", key="control")
        drives = control == "velocity"
        if step is None:
            step = 0.1 if drives else 1.0
        if step == "decision" and drives:
            raise HuntError("step: 'decision' requires control='rooms'. Give a number of seconds.", key="step")
        super().__init__(
            HuntStudy(robots=robots) if study is None else study,
            "thbridge_hunt_v0",
            step,
            max_seconds,
            shared=shared,
            room_reward=room_reward,
            energy_cost=energy_cost,
            time_cost=time_cost,
            render_mode=render_mode,
            drives=drives,
        )
        self.session: HuntSession | None = None
        self._reach = reach
        # State of the game when treasures were last considered.
        self._decided: GameState | None = None

    def render(self) -> NDArray[np.uint8] | None:
        """Return an image of the hunt with true and estimated poses, (rows, cols, 3).

        Return None if `render_mode` does not request images.
        """
        if self.render_mode is None or self.session is None:
            return None
        from thbridge.api.learning.picture import picture_of  # noqa: PLC0415  # only needed for images

        now = self.session.snapshot
        return picture_of(self._setting, now.visited.tolist(), now.poses, now.true_poses)

    def close(self) -> None:
        """End the episode, and complete its recording."""
        if self.session is not None:
            self.session.close()
            self.session = None
        self.agents = []

    # The session

    @property
    def _playing(self) -> HuntSession:
        if self.session is None:
            raise HuntError("no episode is in progress. Call `reset` first.")
        return self.session

    @property
    def _now(self) -> tuple[GameState, int]:
        hunt = inside(self._playing)
        assert hunt.game is not None  # noqa: S101  # `reset` started it
        return hunt.game, hunt.tick

    def _begin(self, seed: int, record: str | None) -> None:
        """Run until the treasures are hidden, and the caller commands all robots."""
        self.session = session = HuntSession(seeded(self.study, seed), record=record)
        self._decided = None
        hunt = inside(session)
        while hunt.game is None or hunt.game.treasures is None:
            if hunt.tick > TOGETHER:
                raise HuntError("no game starts with this study. Check its templates and map with `thbridge play`.")
            session.step()
        for robot in range(self.study.robots):
            self._ask(TakeCommand(robot, SENDER))
        session.step()

    def _send(self, request: StationSend) -> None:
        self._ask(request)

    def _ask(self, request: CommandRequest) -> None:
        inside(self._playing).ask(SENDER, request)

    def _run(self) -> None:
        session, ticks = self._playing, self._ticks
        while True:
            session.step()
            game, tick = self._now
            if game is not self._decided:
                self._decided = game
                for robot in range(len(game.robots)):
                    request = self._rule.request(game, robot)
                    if request is not None:
                        self._ask(request)
            if ticks is not None:
                ticks -= 1
            elif any(self._choices.rooms(game)):
                return
            if ticks == 0 or game.ended is not None or tick >= self._last_tick:
                return

    def _act(self, game: GameState, actions: Mapping[str, Action]) -> dict[str, bool]:
        # Repeat requests that were refused because the caller did not command the robot yet.
        self._decided = None
        return self._drive(game, actions) if self._drives else super()._act(game, actions)

    def _drive(self, game: GameState, actions: Mapping[str, Action]) -> dict[str, bool]:
        """Drive the robots. If a robot is at the goal of a free room, its own software drives it into the room."""
        (team, _), world = team_of(self._playing.snapshot), self._setting.study.world
        accepted = {}
        for robot, agent in enumerate(self.possible_agents):
            linear, angular = np.asarray(actions.get(agent, (0.0, 0.0)), dtype=np.float64).tolist()
            if not (abs(linear) <= 1.0 and abs(angular) <= 1.0):
                raise HuntError(f"{agent}: ({linear:g}, {angular:g}) is outside [-1, 1]. Clip the action.")
            state, room = game.robots[robot], self._room_at(game, robot, team.robots[robot].estimate.base_in_map)
            if room is not None and self._choices.is_ready(game, robot):
                self._ask(StationSend(robot, room))
            free = state.bound_for is None and room is None and self._rule.request(game, robot) is None
            if free and not state.is_silent:
                # The command lasts one tick longer than a step, so that the robot does not stop between two steps.
                twist = Twist(linear * world.max_vel_x, angular * world.max_vel_theta)
                inside(self._playing).ask(SENDER, DriveManually(robot, twist, (self._ticks or 1) + 1))
            accepted[agent] = free
        return accepted

    def _room_at(self, game: GameState, robot: int, base_in_map: Pose2) -> int | None:
        """Return the number of a free room if the robot believes that it is at the room's goal; otherwise None.

        The robot must have enough energy for the room.
        """
        state = game.robots[robot]
        for room in game.free_rooms:
            near = base_in_map.distance(self._goals[room.wire]) <= self._reach
            if near and game.cost(robot, room) <= state.energy and not state.is_blocked:
                return room.people
        return None

    def _bodies(self) -> list[BodyNumbers]:
        team, scans = team_of(self._playing.snapshot)
        return [self._encoder.of_output(output, scan) for output, scan in zip(team.robots, scans, strict=True)]


parallel_env = HuntEnv
"""`HuntEnv`, under the usual name in PettingZoo."""

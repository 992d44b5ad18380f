"""Environment of the abstract hunt: agents make the same decisions, but robots are not simulated.

It runs thousands of decisions per second.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, TICK, Twist
from sim.numerics import elementary
from thbridge.api.errors import HuntError, as_hunt_errors
from thbridge.api.learning.abstract_hunt import AbstractHunt, HuntOpening, MoveTimes
from thbridge.api.learning.observation import BodyNumbers
from thbridge.api.learning.team_environment import Decision, TeamEnvironment
from thbridge.api.session import HuntEvent, noted
from thbridge.api.study import HuntStudy
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room
from thbridge.roles.shared.robot_requests import StationSend


class AbstractHuntEnv(TeamEnvironment):
    """Environment with the same game, seeds, actions and observations as `HuntEnv`, but without simulated robots.

    The same study and seed hide the same treasures. The rules about energy, rooms and points are the same. Because
    robots are not simulated, every move succeeds and takes the number of seconds given in the map's `mapTimes`.
    Decisions about treasures take no time. In observations, a robot knows its pose and drives in a straight line.
    docs/how-to/learning.md lists the differences.

    Args:
        study: the study. This and all other arguments have the same meaning as in `HuntEnv`.
        robots: number of robots, used if no study is given.
        step: duration of a step in simulated seconds, or "decision" to run until a robot is ready.
        max_seconds: simulated seconds after which an episode is truncated.
        shared: If True, each agent gets the reward of the team. If False, each agent gets the reward of its robot.
        room_reward: reward for each room reached, in addition to the points for treasures.
        energy_cost: cost per unit of energy.
        time_cost: cost per simulated second.
        render_mode: "rgb_array" makes `render` return images.

    Raises:
        HuntError: an argument is invalid, or the study has obstacles or scheduled failures.

    Attributes:
        study: the study.
        layout: positions of the parts of an observation in the vector.
    """

    def __init__(
        self,
        study: HuntStudy | None = None,
        *,
        robots: int = 2,
        step: float | Decision = 1.0,
        max_seconds: float = 600.0,
        shared: bool = True,
        room_reward: float = 0.0,
        energy_cost: float = 0.0,
        time_cost: float = 0.0,
        render_mode: Literal["rgb_array"] | None = None,
    ) -> None:
        super().__init__(
            HuntStudy(robots=robots) if study is None else study,
            "thbridge_abstract_hunt_v0",
            step,
            max_seconds,
            shared=shared,
            room_reward=room_reward,
            energy_cost=energy_cost,
            time_cost=time_cost,
            render_mode=render_mode,
        )
        for key, entries in (("things", self._setting.study.things), ("mishaps", self._setting.study.mishaps)):
            if entries:
                problem = "the abstract hunt does not simulate robots, so this key cannot have an effect"
                raise HuntError(f"{key}: {problem}. Remove the key from the study, or use HuntEnv.", key=key)
        with as_hunt_errors():
            self._times = MoveTimes.of(self._setting)
        self._opening = HuntOpening.of(self._setting, self._times)
        self._hunt: AbstractHunt | None = None
        self._starts = self._setting.map.starts[: self.study.robots]
        # Numbers of each robot at rest in a room, and during a drive between two rooms that takes a number of ticks.
        self._standing: dict[tuple[int, int], BodyNumbers] = {}
        self._straight: dict[tuple[int, int, int, int], tuple[BodyNumbers, BodyNumbers]] = {}

    @property
    def events(self) -> list[HuntEvent]:
        """Events so far, oldest first, as in `HuntSession.events`; empty before the first episode."""
        return [] if self._hunt is None else [noted(tick * TICK, event) for tick, event in self._hunt.events]

    def render(self) -> NDArray[np.uint8] | None:
        """Return an image of the hunt, (rows, cols, 3); None if `render_mode` does not request images."""
        if self.render_mode is None or self._hunt is None:
            return None
        from thbridge.api.learning.picture import picture_of  # noqa: PLC0415  # only needed for images

        poses = self._encoder.poses(self._bodies())
        return picture_of(self._setting, [room.visited for room in self._hunt.game.rooms], poses, poses)

    def close(self) -> None:
        """End the episode."""
        self._hunt = None
        self.agents = []

    # The hunt

    @property
    def _playing(self) -> AbstractHunt:
        if self._hunt is None:
            raise HuntError("no episode is in progress. Call `reset` first.")
        return self._hunt

    @property
    def _now(self) -> tuple[GameState, int]:
        hunt = self._playing
        return hunt.game, hunt.tick

    def _begin(self, seed: int, record: str | None) -> None:
        if record is not None:
            problem = "the abstract hunt cannot be recorded, because it does not simulate robots"
            raise HuntError(f"record: {problem}. Use HuntEnv.", key="record")
        self._hunt = AbstractHunt(self._setting, self._opening, self._times, self._rule, seed)

    def _send(self, request: StationSend) -> None:
        self._playing.ask(request)

    def _run(self) -> None:
        hunt = self._playing
        # While a robot waits, one tick passes even if no other robot is driving.
        last = min(hunt.tick + (self._ticks or 1), self._last_tick)
        while True:
            hunt.run_to(last)
            if hunt.game.ended is not None or hunt.tick >= self._last_tick:
                return
            if self._ticks is None:
                if any(self._choices.rooms(hunt.game)):
                    return
                last = self._last_tick
            elif hunt.tick >= last:
                return

    def _bodies(self) -> list[BodyNumbers]:
        hunt = self._playing
        bodies = []
        for robot, (state, move) in enumerate(zip(hunt.game.robots, hunt.moves, strict=True)):
            at, goal = state.at, state.bound_for
            if move is None or goal is None:
                standing = robot, at.people
                if standing not in self._standing:
                    self._standing[standing] = self._encoder.of_pose(self._place(robot, at), STANDSTILL, 0.0)
                bodies.append(self._standing[standing])
                continue
            ticks = move.arrives - move.departed
            leg = robot, at.people, goal.people, ticks
            if leg not in self._straight:
                ends = self._place(robot, at), self._place(robot, goal)
                self._straight[leg] = self._straight_line(*ends, ticks)
            bodies.append(_between(*self._straight[leg], (hunt.tick - move.departed) / ticks))
        return bodies

    def _place(self, robot: int, room: Room) -> Pose2:
        return self._starts[robot] if room.is_corridor else self._goals[room.wire]

    def _straight_line(self, start: Pose2, goal: Pose2, ticks: int) -> tuple[BodyNumbers, BodyNumbers]:
        """Return the numbers of a robot that observations need, at the start and at the end of a straight line."""
        x, y = goal.x - start.x, goal.y - start.y
        length, heading = elementary.hypot(x, y), elementary.atan2(y, x)
        twist = Twist(length / (ticks * TICK), 0.0)
        first = self._encoder.of_pose(Pose2(start.x, start.y, heading), twist, length)
        return first, self._encoder.of_pose(Pose2(goal.x, goal.y, heading), twist, 0.0)


def _between(first: BodyNumbers, last: BodyNumbers, share: float) -> BodyNumbers:
    motion = first.motion.copy()
    motion[:2] = [start + share * (end - start) for start, end in zip(motion[:2], last.motion[:2], strict=True)]
    return BodyNumbers(motion, 0.0, first.remaining * (1.0 - share), [])

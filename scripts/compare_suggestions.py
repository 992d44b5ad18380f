"""Compare the planners with which robots advise a person, in whole games.

Run this script from the project's folder: `.venv/bin/python scripts/compare_suggestions.py`. It prints a Markdown table
of rooms visited and energy left to the whole team. Programs play whole games by the rules, without a simulator. The
seconds of a drive are about equal to its energy cost. A robot identifies each treasure that it finds, and asks for the
next room. The person usually follows the suggestion, but sometimes chooses another affordable room. Moves have the
costs of arena8, from the start poses and between rooms. All planners play the same games with the same seeds.
"""

import argparse
import heapq
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.numerics import noise
from thbridge.app.compose.robots import build_travel_times
from thbridge.app.compose.setting import read_setting
from thbridge.hunt import rules
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import GameStarted, TreasuresHidden
from thbridge.hunt.game import GameState, apply, begin
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.keeper.advice.adviser import Adviser
from thbridge.study.study_file import CostModel, GameSection, Study

TREASURE = TreasureKind({"colour": "Green", "footprint": "Round and Small"}, 10, "bottle", None)
IDENTIFY_COST = 2.0
SPREAD = 0.3
"""Maximum deviation of a drive's duration from its cost in seconds, as a share of the cost."""

PriceRow = tuple[float | None, ...]


@dataclass(frozen=True, slots=True)
class GameResult:
    """Result of a game: rooms visited, and energy left to the whole team."""

    rooms: int
    energy: float


def play(
    costs: CostMatrix, from_starts: Sequence[PriceRow], energy: float, follows: float, seed: int, adviser: Adviser
) -> GameResult:
    """Play a game to its end.

    Args:
        costs: energy from room to room.
        from_starts: energy from the start of each robot to each place.
        energy: energy of each robot.
        follows: share of suggestions that the person follows.
        seed: random seed of durations and of the person's choices.
        adviser: adviser of all robots.
    """
    robots = len(from_starts)
    started = GameStarted(seed, 1, robots, energy, 5.0, IDENTIFY_COST, 1.0, costs)
    state = apply(begin(started), TreasuresHidden((TREASURE,) * len(costs.rooms)))
    for robot, row in enumerate(from_starts):
        state = _after(state, rules.price(state, robot, row))
    durations, whims = noise.key(seed, "durations"), noise.key(seed, "whims")
    # For each robot: the time at which it can be sent, and its index.
    free = [(noise.uniform(durations, 0, robot), robot) for robot in range(robots)]
    heapq.heapify(free)
    sent = 0
    while free:
        now, robot = heapq.heappop(free)
        going = state.robots[robot].bound_for
        if going is not None:
            state = _after(state, rules.arrive(state, robot, going))
            state = _after(state, rules.sense(state, going))
            named = rules.identify(state, going, TREASURE.name)
            state = _after(state, rules.leave(state, going) if isinstance(named, RequestRefused) else named)
        advice = adviser.advise(state, (), robot)
        if isinstance(advice, RequestRefused):
            # From now on, the robot cannot move: the number of free rooms and the robot's energy never increase.
            continue
        room = advice.room
        sent += 1
        if noise.uniform(whims, sent, 0) >= follows:
            open_to_it = rules.affordable(state, robot)
            room = open_to_it[int(noise.uniform(whims, sent, 1) * len(open_to_it))]
        cost = state.cost(robot, room)
        state = _after(state, rules.move(state, robot, room))
        stretch = 1.0 + SPREAD * (2.0 * noise.uniform(durations, robot + 1, room.people) - 1.0)
        heapq.heappush(free, (now + cost * stretch, robot))
    return GameResult(sum(room.visited for room in state.rooms), sum(robot.energy for robot in state.robots))


def _after(state: GameState, ruling: rules.Ruling) -> GameState:
    if isinstance(ruling, RequestRefused):
        raise RuntimeError(ruling.sentence)
    for event in ruling:
        state = apply(state, event)
    return state


def main() -> None:
    """Play all games and write the table."""
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--games", type=int, default=500, help="games of each kind (default: 500)")
    games: int = arguments.parse_args().games
    print(f"| robots | energy of each | suggestions followed | {' | '.join(TeamPlanner)} |")
    print("|---|---|---|" + "---|" * len(TeamPlanner))
    for robots, energy, follows in itertools.product((2, 3), (30.0, 45.0, 60.0, 80.0, 100.0), (1.0, 0.7)):
        setting = read_setting(Study(robots=robots, game=GameSection(cost_model=CostModel.POSITION)), Path())
        travel = build_travel_times(setting)
        starts = [travel.costs_from(start) for start in setting.map.starts[:robots]]
        cells = [f"{robots}", f"{energy:g}", f"{follows:.0%}"]
        for planner in TeamPlanner:
            adviser = Adviser(planner)
            results = [play(setting.costs, starts, energy, follows, seed, adviser) for seed in range(games)]
            rooms, left = np.mean([one.rooms for one in results]), np.mean([one.energy for one in results])
            cells.append(f"{rooms:.2f}, {left:.1f}")
        print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()

"""Compare two ways of advising a team: each robot by its own tour, and all by their joint plan.

Run it from the project's folder: `.venv/bin/python scripts/compare_suggestions.py`. Programs play whole games by the
rules, without a simulator: a robot drives for as many seconds as the move costs, more or less, names what it finds,
asks where to go, and goes there. Both ways play the same games, drawn by their seeds. Writes a table in Markdown.
"""

import argparse
import heapq
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.common import noise
from thbridge.files.map_times import MAP_TIMES, read_map_times
from thbridge.files.resources import shipped
from thbridge.hunt import rules
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import GameStarted, TreasuresHidden
from thbridge.hunt.game import GameState, apply, begin
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.tour import best_tour
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.keeper.advice import advise

TREASURE = TreasureKind("Green", "Round and Small", 10, "bottle", None)
IDENTIFY_COST = 2.0
SPREAD = 0.3
"""Greatest share by which a drive takes longer or shorter than its cost in seconds."""

Adviser = Callable[[GameState, int], Room | RequestRefused]


@dataclass(frozen=True, slots=True)
class GameResult:
    """Rooms visited, and energy left to the whole team."""

    rooms: int
    energy: float


def own_tour(state: GameState, robot: int) -> Room | RequestRefused:
    """The first room of the robot's own tour through all rooms that are free."""
    mover, started = state.robots[robot], state.started
    tour = best_tour(started.costs, mover.at, state.free_rooms, mover.energy, started.identify_cost)
    return tour if isinstance(tour, RequestRefused) else tour.rooms[0]


def joint_plan(state: GameState, robot: int) -> Room | RequestRefused:
    """The first room of the robot in the joint plan."""
    advice = advise(state, (), robot)
    return advice if isinstance(advice, RequestRefused) else advice.room


def play(costs: CostMatrix, robots: int, energy: float, seed: int, adviser: Adviser) -> GameResult:
    """Play a game to its end."""
    started = GameStarted(seed, 1, robots, energy, 5.0, IDENTIFY_COST, 1.0, costs)
    state = apply(begin(started), TreasuresHidden((TREASURE,) * len(costs.rooms)))
    durations = noise.key(seed, "durations")
    # Time at which each robot can be sent, and its number.
    free = [(noise.uniform(durations, 0, robot), robot) for robot in range(robots)]
    heapq.heapify(free)
    while free:
        now, robot = heapq.heappop(free)
        going = state.robots[robot].bound_for
        if going is not None:
            state = _after(state, rules.arrive(state, robot, going))
            state = _after(state, rules.sense(state, going))
            named = rules.identify(state, going, TREASURE.name)
            state = _after(state, rules.leave(state, going) if isinstance(named, RequestRefused) else named)
        room = adviser(state, robot)
        if isinstance(room, RequestRefused):
            continue  # It can go nowhere any more: rooms do not become free again, nor energy more.
        cost = costs.cost(state.robots[robot].at, room)
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
    costs = read_map_times(shipped().find("templates", "original-2016", Path()) / MAP_TIMES)
    print("| robots | energy each | rooms, own tours | joint plan | energy left, own tours | joint plan |")
    print("|---|---|---|---|---|---|")
    for robots in (2, 3):
        for energy in (30.0, 45.0, 60.0, 80.0, 100.0):
            means = []
            for adviser in (own_tour, joint_plan):
                results = [play(costs, robots, energy, seed, adviser) for seed in range(games)]
                means.append((np.mean([one.rooms for one in results]), np.mean([one.energy for one in results])))
            (rooms, left), (joint_rooms, joint_left) = means
            print(f"| {robots} | {energy:g} | {rooms:.2f} | {joint_rooms:.2f} | {left:.1f} | {joint_left:.1f} |")


if __name__ == "__main__":
    main()

"""Compare the planners of a team on random hunts: rooms visited, and energy of all moves.

Run this script from the project's folder: `.venv/bin/python scripts/compare_planners.py`. It prints a Markdown table. A
plan counts as best if it visits the same number of rooms as the exact joint plan, with the same energy. If there are
too many rooms for the exact plan, the last column is empty, and `search` is the joint plan.
"""

import argparse
import time
from collections.abc import Sequence

from tests.support.hunts.random_hunts import random_hunt
from thbridge.hunt.planners import PLANNERS, PlanTours
from thbridge.hunt.rooms import all_rooms
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.hunt.team_tour import most_rooms_shared_out
from thbridge.hunt.team_tour_search import search_team_tours
from thbridge.hunt.tour import MOST_ROOMS, Tour

HUNTS = ((8, 2, 30.0), (12, 2, 60.0), (12, 3, 25.0), (12, 3, 200.0), (12, 4, 45.0), (16, 3, 50.0), (50, 3, 80.0))
"""Number of rooms, number of robots, and energy of each robot."""
VISIT = 2.0
LARGE = 30
"""Least number of rooms with which only a tenth of the hunts is planned."""


def value(tours: Sequence[Tour]) -> tuple[int, float]:
    """Return the number of rooms visited, and the energy of all moves without floating-point errors of the sum."""
    return sum(len(tour.rooms) for tour in tours), round(sum(tour.cost for tour in tours), 6)


def main() -> None:
    """Plan all hunts and write the table."""
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--hunts", type=int, default=100, help="hunts of each kind (default: 100)")
    hunts: int = arguments.parse_args().hunts
    planners: dict[str, PlanTours] = {str(name): plan for name, plan in PLANNERS.items()}
    planners["search"] = lambda costs, starts, unvisited, visit=0.0, sent=-1: search_team_tours(
        costs, starts, unvisited, visit
    )
    print("| rooms | robots | energy of each | planner | rooms visited | energy used | longest time, s | best plans |")
    print("|---|---|---|---|---|---|---|---|")
    for rooms, robots, energy in HUNTS:
        exact = rooms <= most_rooms_shared_out(robots)
        seeds = range(hunts if rooms < LARGE else max(hunts // 10, 1))
        best: list[tuple[int, float]] = []
        left_out = {TeamPlanner.TOUR} if rooms > MOST_ROOMS else set[str]()
        for name, plan in planners.items():
            if name in left_out or (name == TeamPlanner.JOINT and not exact):
                continue
            values, longest = [], 0.0
            for seed in seeds:
                costs, starts = random_hunt(rooms, robots, energy, seed)
                began = time.perf_counter()
                values.append(value(plan(costs, starts, all_rooms(rooms), VISIT)))
                longest = max(longest, time.perf_counter() - began)
            best = best or values
            visited, spent = (sum(column) / len(seeds) for column in zip(*values, strict=True))
            met = (
                f"{sum(one == other for one, other in zip(values, best, strict=True))} of {len(seeds)}" if exact else ""
            )
            print(f"| {rooms} | {robots} | {energy:g} | {name} | {visited:.2f} | {spent:.1f} | {longest:.3f} | {met} |")


if __name__ == "__main__":
    main()

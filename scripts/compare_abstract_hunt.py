"""Compare the abstract hunt with simulated robots: the same policies in the same games.

Run these commands from the project's folder. The first plays the games of one policy in both environments, which takes
about two seconds per game. The second prints the tables of docs/how-to/learning.md:

    .venv/bin/python scripts/compare_abstract_hunt.py play cheapest --to games
    .venv/bin/python scripts/compare_abstract_hunt.py table games
"""

import argparse
import csv
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from learners.policies import CheapestPolicy, Env, Policy, RandomPolicy, TablePolicy, play

from thbridge import api
from thbridge.api.learning import AbstractHuntEnv, HuntEnv
from thbridge.api.session import HuntEvent

ENERGY, ROBOTS, GAMES = 60.0, 2, 200
LEARNED = Path("docs/learning/table.npy")
HEAD = ("hunt", "seed", "score", "rooms", "energy", "seconds", "failed", "order", "tours", "moves", "cpu_seconds")


def study() -> api.HuntStudy:
    """Return the study to play."""
    return api.HuntStudy("standard", robots=ROBOTS, game={"energy": ENERGY})


def policy_of(name: str) -> Policy:
    """Return the policy with this name."""
    policies: dict[str, Callable[[], Policy]] = {
        "random": RandomPolicy,
        "cheapest": CheapestPolicy,
        "learned": lambda: TablePolicy.read(LEARNED),
    }
    return policies[name]()


def events_of(env: Env) -> Sequence[HuntEvent]:
    """Return the events of the last episode."""
    return env.events if isinstance(env, AbstractHuntEnv) else env.session.events if env.session else []


def row_of(env: Env, policy: Policy, seed: int) -> list[object]:
    """Play a game, and return its row."""
    began = time.process_time()
    score = play(env, policy, seed)
    spent = time.process_time() - began
    events = events_of(env)
    arrivals = [event for event in events if event.kind == "arrived"]
    tours = ["-".join(str(each.room) for each in arrivals if each.robot == robot + 1) for robot in range(ROBOTS)]
    left: dict[int | None, float] = {}
    at: dict[int | None, int | None] = {}
    moves: list[str] = []
    energy = ENERGY * ROBOTS
    for event in events:
        if event.kind == "departed":
            left[event.robot] = event.seconds
        elif event.kind == "arrived":
            moves.append(f"{event.robot}:{at.get(event.robot, 0)}>{event.room}={event.seconds - left[event.robot]:.2f}")
            at[event.robot] = event.room
        elif event.kind == "failed":
            energy += float(str(event.data["refund"]))
        energy -= float(str(event.data.get("cost", 0.0)))
    order = "-".join(str(each.room) for each in arrivals)
    failed = sum(event.kind == "failed" for event in events)
    kind = "abstract" if isinstance(env, AbstractHuntEnv) else "whole"
    seconds = f"{events[-1].seconds:.2f}"
    return [
        kind,
        seed,
        score,
        len(arrivals),
        f"{energy:.2f}",
        seconds,
        failed,
        order,
        "/".join(tours),
        "/".join(moves),
        f"{spent:.5f}",
    ]


def games(name: str, number: int, to: Path) -> None:
    """Play the games of a policy in both environments, and write a CSV file."""
    to.mkdir(parents=True, exist_ok=True)
    environments = [make(study(), step="decision") for make in (AbstractHuntEnv, HuntEnv)]
    with (to / f"{name}.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEAD)
        for seed in range(number):
            writer.writerows(row_of(env, policy_of(name), seed) for env in environments)
            file.flush()


def tables(folder: Path) -> None:
    """Write the tables of all games in a folder."""
    print("| policy | hunt | score | rooms | energy left | seconds | failed moves |\n|---|---|---|---|---|---|---|")
    pairs: list[str] = []
    for name in ("random", "cheapest", "learned"):
        file = folder / f"{name}.csv"
        if not file.exists():
            continue
        with file.open(newline="") as opened:
            rows = list(csv.DictReader(opened))
        by = {kind: {row["seed"]: row for row in rows if row["hunt"] == kind} for kind in ("abstract", "whole")}
        for kind, played in by.items():
            cells = [
                mean_and_sd([float(row[key]) for row in played.values()])
                for key in ("score", "rooms", "energy", "seconds")
            ]
            print(f"| {name} | {kind} | {' | '.join(cells)} | {sum(int(row['failed']) for row in played.values())} |")
        both = [(row, by["whole"][seed]) for seed, row in by["abstract"].items() if seed in by["whole"]]
        same = [
            f"{np.mean([one[key] == other[key] for one, other in both]):.0%}" for key in ("order", "tours", "score")
        ]
        rooms = np.mean([set(one["order"].split("-")) == set(other["order"].split("-")) for one, other in both])
        off = [[float(other[key]) - float(one[key]) for one, other in both] for key in ("score", "energy")]
        late: list[float] = []
        for one, other in both:
            here, there = (dict(move.split("=") for move in row["moves"].split("/")) for row in (one, other))
            late += [float(there[move]) - float(here[move]) for move in here.keys() & there.keys()]
        moves = mean_and_sd(late) if late else ""
        shares = [name, same[0], same[1], f"{rooms:.0%}", same[2]]
        pairs.append(f"| {' | '.join([*shares, *map(mean_and_sd, off), moves])} |")
    print("\nSimulated robots minus the abstract hunt, in the same games:\n")
    print("| policy | same order | same tours | same rooms | same score | score | energy left | seconds of a move |")
    print("|---|---|---|---|---|---|---|---|")
    print("\n".join(pairs))


def mean_and_sd(values: Sequence[float]) -> str:
    """Return the mean and the standard deviation as text."""
    return f"{np.mean(values):.2f} ± {np.std(values):.2f}"


def main() -> None:
    """Play games, or write the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    playing = commands.add_parser("play", help="play the games of a policy")
    playing.add_argument("policy", choices=("random", "cheapest", "learned"))
    playing.add_argument(
        "--games", type=int, default=GAMES, help=f"number of games, with seeds from 0 on (default: {GAMES})"
    )
    playing.add_argument("--to", type=Path, required=True, help="folder for the games")
    table = commands.add_parser("table", help="write the tables")
    table.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    if arguments.command == "play":
        games(arguments.policy, arguments.games, arguments.to)
    else:
        tables(arguments.folder)


if __name__ == "__main__":
    main()

"""Learn in the abstract hunt which room each robot visits next, and draw the learning curve.

Run this script from the project's folder: `.venv/bin/python scripts/learn_rooms.py`. The learner is REINFORCE
(Williams, Simple statistical gradient-following algorithms, 1992) with a table of preferences for the next room by
robot and place, and the mean of each batch as its baseline. The return is the score. Several learners have different
random seeds. The table of the first learner is saved as `table.npy`, all curves as `curve.csv` and `curve.svg`.
"""

import argparse
import csv
from pathlib import Path

import matplotlib
import matplotlib.figure
import numpy as np
from compare_abstract_hunt import study
from learners.policies import CheapestPolicy, Policy, RandomPolicy, TablePolicy, play
from numpy.typing import NDArray

from thbridge.analysis.plot.style import INK
from thbridge.api.learning import AbstractHuntEnv

BATCH = 50
"""Number of episodes per learning step."""
FIRST_SEED = 100_000
"""Seed of the first training game; smaller seeds are used for evaluation."""


def learn(env: AbstractHuntEnv, seed: int, batches: int, rate: float) -> tuple[NDArray[np.float64], list[float]]:
    """Return the learned table, and the mean score of each batch.

    Args:
        env: abstract hunt.
        seed: random seed of the learner's choices and of its games.
        batches: number of learning steps.
        rate: change of preferences for a gradient of one and an advantage of one standard deviation.
    """
    costs = env.layout["costs"]
    rooms = costs.stop - costs.start
    policy = TablePolicy(np.zeros((len(env.possible_agents), rooms + 1, rooms)), np.random.default_rng(seed))
    curve = []
    for batch in range(batches):
        scores, gradients = np.zeros(BATCH), np.zeros((BATCH, *policy.table.shape))
        for episode in range(BATCH):
            game = FIRST_SEED + (seed * batches + batch) * BATCH + episode
            scores[episode] = play(env, policy, game)
            gradients[episode] = policy.gradient
        advantages = (scores - scores.mean()) / (scores.std() + 1e-9)
        policy.table += rate * np.tensordot(advantages, gradients, 1) / BATCH
        curve.append(float(scores.mean()))
    return policy.table, curve


def mean_score(env: AbstractHuntEnv, policy: Policy, games: int) -> float:
    """Return the mean score of a policy in the games with seed 0, 1, 2, ..."""
    return float(np.mean([play(env, policy, seed) for seed in range(games)]))


def draw(curves: NDArray[np.float64], levels: dict[str, float], file: Path) -> None:
    """Draw the (learners, batches) mean scores, and the mean scores of other policies."""
    matplotlib.rcParams["svg.hashsalt"] = "thbridge"
    figure = matplotlib.figure.Figure(figsize=(6.0, 3.4), layout="constrained")
    axes = figure.subplots()
    games = (np.arange(curves.shape[1]) + 1) * BATCH
    axes.fill_between(games, curves.min(axis=0), curves.max(axis=0), color="#0072B2", alpha=0.18, linewidth=0)
    axes.plot(games, curves.mean(axis=0), color="#0072B2", label=f"learner, mean and range of {len(curves)}")
    for (name, level), color in zip(levels.items(), ("#D55E00", "#4D4D4D"), strict=True):
        axes.axhline(level, color=color, linestyle="--", label=name)
    axes.set_xlabel("games", color=INK)
    axes.set_ylabel("score", color=INK)
    axes.legend(frameon=False)
    figure.savefig(file, metadata={"Date": None})


def main() -> None:
    """Learn, and write table, curve and picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--to", type=Path, default=Path("docs/learning"), help="folder for the results")
    parser.add_argument(
        "--learners", type=int, default=5, help="number of learners with different random seeds (default: 5)"
    )
    parser.add_argument(
        "--batches", type=int, default=100, help=f"number of steps of {BATCH} games each (default: 100)"
    )
    parser.add_argument("--rate", type=float, default=1.5, help="learning rate (default: 1.5)")
    arguments = parser.parse_args()
    arguments.to.mkdir(parents=True, exist_ok=True)
    env = AbstractHuntEnv(study(), step="decision")
    learned = [learn(env, seed, arguments.batches, arguments.rate) for seed in range(arguments.learners)]
    curves = np.array([curve for _, curve in learned])
    np.save(arguments.to / "table.npy", learned[0][0])
    with (arguments.to / "curve.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("games", *(f"learner_{seed + 1}" for seed in range(len(curves)))))
        for batch, row in enumerate(curves.T.tolist()):
            writer.writerow(((batch + 1) * BATCH, *row))
    levels = {"cheapest": mean_score(env, CheapestPolicy(), 1000), "random": mean_score(env, RandomPolicy(), 1000)}
    draw(curves, levels, arguments.to / "curve.svg")
    final = [mean_score(env, TablePolicy(table), 1000) for table, _ in learned]
    print(f"mean score of each learner in 1000 other games: {', '.join(f'{each:.1f}' for each in final)}; {levels}")


if __name__ == "__main__":
    main()

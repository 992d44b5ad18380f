"""Fit the probability that a pose is wrong (`sim.robot.localization.wrong_pose`) to simulated runs, and check it.

Run this script from the project's folder after each change of a filter: `.venv/bin/python scripts/fit_wrong_pose.py`.
For some seeds, it simulates robots on two maps: with each disturbance of `tests/bench/robots/troubled_runs.py`,
kidnapped, with a wrong first pose, and without disturbance. Both filters localize these robots. A logistic regression
is fitted to the evidence of each filter, and written to `sim/robot/localization/wrong_pose_coefficients.py`. For
further seeds, the script prints the share of wrong poses among the updates that report p. Simulated runs do not depend
on the filter. They are stored in the folder of --runs.
"""

import argparse
import pickle
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from sim.numerics.float_array import FloatArray
from sim.robot.localization import wrong_pose
from sim.robot.localization.wrong_pose import GaussianEvidence, ParticleEvidence, probability
from tests.bench.robots.wrong_pose_runs import HEAD, StartedRun, UpdateRow, calibration, started_runs, updates_of
from thbridge.files.map_files import Map, read_map
from thbridge.files.resources import shipped

COEFFICIENTS = Path(wrong_pose.__file__).with_name("wrong_pose_coefficients.py")
MODELS: dict[str, tuple[str, type[ParticleEvidence] | type[GaussianEvidence]]] = {
    "amcl": ("PARTICLES", ParticleEvidence),
    "ekf": ("GAUSSIANS", GaussianEvidence),
}
"""Name of the coefficients and type of the evidence, for each localizer."""
HELD_OUT = 100
"""First of the seeds that are used only for checking."""
RIDGE = 1.0
"""Weight of the squared coefficients.

It keeps the coefficients finite if one kind of evidence alone separates right from wrong poses.
"""
STEPS = 50


def _map(name: str) -> Map:
    return read_map(shipped().find("maps", name, Path()))


def _runs_of(seed: int, folder: Path) -> list[StartedRun]:
    kept = folder / f"{seed}.pickle"
    if kept.exists():
        runs: list[StartedRun] = pickle.loads(kept.read_bytes())
        return runs
    runs = list(started_runs(seed, _map("office"), _map("arena8")))
    folder.mkdir(parents=True, exist_ok=True)
    kept.write_bytes(pickle.dumps(runs))
    return runs


Runs = list[list[UpdateRow]]


def _followed(seed: int, folder: Path) -> dict[str, Runs]:
    """Return the updates of each run of a seed, by localizer."""
    started = _runs_of(seed, folder)
    return {name: [list(updates_of(each, seed, name)) for each in started] for name in MODELS}


def _gathered(followed: Iterable[dict[str, Runs]]) -> dict[str, Runs]:
    runs: dict[str, Runs] = {name: [] for name in MODELS}
    for of_seed in followed:
        for name, rows in of_seed.items():
            runs[name] += [each for each in rows if each]
    return runs


def fitted(evidence: FloatArray, wrong: FloatArray) -> FloatArray:
    """Return (k,) coefficients of a logistic regression that predicts (n,) zeros and ones from (n, k) evidence
    (Newton's method)."""
    coefficients = np.zeros(evidence.shape[1])
    for _ in range(STEPS):
        p = 1.0 / (1.0 + np.exp(-np.clip(evidence @ coefficients, -30.0, 30.0)))
        gradient = evidence.T @ (wrong - p) - RIDGE * coefficients
        curvature = (evidence * (p * (1.0 - p))[:, np.newaxis]).T @ evidence + RIDGE * np.eye(len(coefficients))
        step = np.linalg.solve(curvature, gradient)
        coefficients += step
        if np.abs(step).max() < 1e-6:
            break
    return coefficients


def written(coefficients: Mapping[str, FloatArray]) -> str:
    """Return the text of the module with the coefficients."""
    text = (
        '"""Coefficients of the models in `wrong_pose`, written by `scripts/fit_wrong_pose.py`."""\n\n'
        "from sim.robot.localization.wrong_pose import GaussianEvidence, ParticleEvidence\n"
    )
    for name, (variable, kind) in MODELS.items():
        values = zip(kind._fields, coefficients[name].tolist(), strict=True)
        lines = "".join(f"    {field}={value:.4f},\n" for field, value in values)
        text += f"\n{variable} = {kind.__name__}(\n{lines})\n"
    return text


def _scored(runs: Runs, coefficients: Sequence[float]) -> Runs:
    """Return the same updates with the probabilities that these coefficients give."""
    return [[replace(row, p_wrong=probability(coefficients, row.evidence)) for row in rows] for rows in runs]


def _report(runs: Runs) -> Iterator[str]:
    rows = [row for run in runs for row in run]
    reported, wrong = np.array([row.p_wrong for row in rows]), np.array([row.wrong for row in rows], dtype=np.float64)
    bounded = np.clip(reported, 1e-6, 1.0 - 1e-6)
    loss = -np.mean(wrong * np.log(bounded) + (1.0 - wrong) * np.log(1.0 - bounded))
    yield f"{len(rows)} updates of {len(runs)} runs: share wrong {wrong.mean():.4f}, mean p {reported.mean():.4f}"
    yield f"Brier score {np.mean((reported - wrong) ** 2):.4f}, logarithmic loss {loss:.4f}\n"
    yield HEAD
    yield from map(str, calibration(runs))


def main() -> None:
    """Fit, write and check."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=8, help="number of seeds for fitting")
    parser.add_argument("--check", type=int, default=8, help="number of further seeds for checking")
    parser.add_argument("--runs", type=Path, default=Path("/tmp/thbridge-wrong-pose"), help="folder of simulated runs")
    parser.add_argument("--jobs", type=int, default=1, help="number of processes")
    parser.add_argument("--only-check", action="store_true", help="check the current coefficients, and write nothing")
    given = parser.parse_args()
    fit_seeds = [] if given.only_check else range(1, given.seeds + 1)
    check_seeds = range(HELD_OUT + 1, HELD_OUT + given.check + 1)
    with ProcessPoolExecutor(given.jobs) as pool:
        follow = partial(_followed, folder=given.runs)
        fit_runs, check_runs = (_gathered(pool.map(follow, seeds)) for seeds in (fit_seeds, check_seeds))
    if fit_seeds:
        coefficients = {name: _fit(runs) for name, runs in fit_runs.items()}
        COEFFICIENTS.write_text(written(coefficients))
        check_runs = {name: _scored(runs, coefficients[name].tolist()) for name, runs in check_runs.items()}
    for name, runs in check_runs.items():
        print(f"\n# {name}", *_report(runs), sep="\n")
        for group in dict.fromkeys(run[0].group for run in runs):
            print(f"\n## {name}, {group}", *_report([run for run in runs if run[0].group == group]), sep="\n")


def _fit(runs: Runs) -> FloatArray:
    rows = [row for run in runs for row in run]
    coefficients = fitted(np.array([row.evidence for row in rows]), np.array([row.wrong for row in rows], float))
    return coefficients.round(4)


if __name__ == "__main__":
    main()

"""How long a prediction and an update of the Kalman filters take, and how well they track meanwhile."""

import time

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.parameters import EkfParameters, RobotParameters
from sim.robot.localization.ekf import KalmanLocalizer
from tests.bench.budget import Budgets
from tests.bench.robots.recorded_run import tour
from thbridge.files.map_files import Map

pytestmark = pytest.mark.bench

SEEDS = (1, 2)


@pytest.mark.parametrize("kind", ["ekf", "ukf"])
def test_a_prediction_and_an_update(
    kind: str, office: Map, budgets: Budgets, capsys: pytest.CaptureFixture[str]
) -> None:
    # Recorded runs have the gyroscope of the ticks with a scan only.
    software = RobotParameters(localization=kind, ekf=EkfParameters(imu_used=False))
    predictions, updates, errors = [], [], []
    for seed in SEEDS:
        run = tour(office, seed)
        localizer = KalmanLocalizer(software, office.grid, run.mount)
        localizer.start(Pose2(*run.truth[0]), np.diag([0.25, 0.25, (np.pi / 12) ** 2]))
        for (odometry, imu, scan), truth in zip(run.observations, run.truth, strict=True):
            began = time.process_time()
            estimate = localizer.update(odometry, imu, scan)
            (updates if estimate.updated else predictions).append(time.process_time() - began)
            errors.append(estimate.base_in_map.distance(Pose2(*truth)))
    with capsys.disabled():
        print(
            f"\n{kind}: {1e3 * np.median(predictions):.3f} ms a prediction, {1e3 * np.median(updates):.2f} ms an "
            f"update with a scan matched, at most {1e3 * max(updates):.1f} ms; mean {100 * np.mean(errors):.1f} cm, "
            f"worst {100 * max(errors):.1f} cm"
        )
    assert np.mean(errors) < 0.04
    budgets.time(f"{kind}: a prediction", float(np.median(predictions)))
    budgets.time(f"{kind}: an update", float(np.median(updates)))

"""Calibration of the probability that a pose is wrong, on seeds that it was not fitted to."""

from pathlib import Path

import numpy as np
import pytest

from tests.bench.robots.wrong_pose_runs import HEAD, calibration, started_runs, updates_of
from thbridge.files.map_files import Map, read_map
from thbridge.files.resources import shipped

pytestmark = [pytest.mark.bench, pytest.mark.timeout(1800)]

SEEDS = range(101, 105)


@pytest.mark.parametrize("localizer", ["amcl", "ekf"])
def test_of_updates_that_report_p_a_share_p_is_wrong(
    localizer: str, office: Map, capsys: pytest.CaptureFixture[str]
) -> None:
    arena = read_map(shipped().find("maps", "arena8", Path()))
    runs = [list(updates_of(run, seed, localizer)) for seed in SEEDS for run in started_runs(seed, office, arena)]
    with capsys.disabled():
        print("", HEAD, *calibration(runs), sep="\n")
    rows = [row for run in runs for row in run]
    reported, wrong = np.array([row.p_wrong for row in rows]), np.array([row.wrong for row in rows])
    assert abs(reported.mean() - wrong.mean()) < 0.02
    assert wrong[reported < 0.01].mean() < 0.01
    assert wrong[reported > 0.9].mean() > 0.8

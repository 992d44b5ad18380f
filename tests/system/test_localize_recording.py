"""A robot of a recorded hunt, localized again from its bag alone."""

import json
from pathlib import Path

import pytest

from tests.support.programs.processes import run_thbridge
from thbridge.files.map_files import read_map
from thbridge.recording.bag.reading.reader import messages
from thbridge.ros.messages import unpack

ARENA = Path(__file__).parents[2] / "maps" / "arena8"


@pytest.mark.slow
def test_a_recorded_robot_is_found_where_it_was(tmp_path: Path) -> None:
    run_thbridge(
        tmp_path, "play", "--headless", "--port", "0", "--robots", "2", "--max-seconds", "30", "--bag", "hunt.bag"
    )
    start = read_map(ARENA).starts[1]
    done = run_thbridge(
        tmp_path, "localize", "hunt.bag", "--map", str(ARENA / "map.yaml"), "--json", "--out", "est.tum",
        "--scan-topic", "/robot2/scan", "--odom-topic", "/robot2/odom",
        "--initial-pose", str(start.x), str(start.y), str(start.theta),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["updates"] == len((tmp_path / "est.tum").read_text().splitlines()) > 20
    raw = list(messages(tmp_path / "hunt.bag", ("/robot2/base_pose_ground_truth",)))[-1]
    truth = unpack.odometry(raw.data).pose
    x, y, _ = told["final_pose"]
    assert abs(x - truth.x) + abs(y - truth.y) < 0.2

"""`thbridge localize` as people and programs call it."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import Result

from sim.common.geometry import Pose2
from tests.support.bags.foreign_bags import FIRST, PERIOD_NS, START_NS, Robot, write, write_map
from tests.support.programs.commands import invoke
from tests.support.slow import slow

ORIGIN = Pose2(-3.0, 4.0, 0.5)
START = ORIGIN.compose(FIRST)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("localize")
    write(folder / "a.bag", Robot(), seconds=4.0)
    write_map(folder, ORIGIN)
    return folder


def run(folder: Path, *options: str) -> Result:
    return invoke("localize", folder / "a.bag", "--map", folder / "map.yaml", *options)


def start() -> list[str]:
    return ["--initial-pose", str(START.x), str(START.y), str(START.theta)]


def test_json(folder: Path) -> None:
    done = run(folder, *start(), "--json")
    assert done.exit_code == 0, done.output
    result = json.loads(done.stdout)
    assert result["updates"] > 5
    assert result["cpu_seconds"] > 0
    assert len(result["final_pose"]) == 3
    assert [len(row) for row in result["covariance"]] == [3, 3, 3]
    assert result["lost"] is False
    assert result["laser_pose"] == pytest.approx([0.2, 0.05, 0.0])


def test_what_files_leave_out_is_as_in_ros_and_told(folder: Path, tmp_path: Path) -> None:
    """Of amcl alone, also when files are for move_base; without files the filter begins there too."""
    file = tmp_path / "params.yaml"
    file.write_text("amcl: {max_particles: 5000}\nTrajectoryPlannerROS: {max_vel_x: 0.3, max_vel_y: 0.0}\n")
    done = run(folder, *start(), "--json", "--params", str(file))
    result = json.loads(done.stdout)
    names = [default["name"] for default in result["ros_defaults"]]
    assert names == ["amcl.kld_err", "amcl.laser_max_beams", "amcl.laser_sigma_hit"]
    assert any("max_vel_y has no effect" in notice for notice in result["notices"])
    assert "amcl: parameters left out, with ROS's defaults" in done.stderr
    plain = json.loads(run(folder, *start(), "--json").stdout)
    assert "ros_defaults" not in plain
    assert plain["final_pose"] == result["final_pose"]


def test_the_trajectory_has_a_line_for_each_update(folder: Path, tmp_path: Path) -> None:
    truth = write(tmp_path / "again.bag", Robot(), seconds=4.0)
    done = run(folder, *start(), "--json", "--out", str(tmp_path / "est.tum"))
    rows = [line.split() for line in (tmp_path / "est.tum").read_text().splitlines()]
    assert len(rows) == json.loads(done.stdout)["updates"]
    for stamp, *pose in rows:
        seconds, nanoseconds = stamp.split(".")
        index = (int(seconds) * 1_000_000_000 + int(nanoseconds) - START_NS) / PERIOD_NS
        x, y, z, qx, qy, qz, qw = map(float, pose)
        assert index == int(index)
        assert (z, qx, qy) == (0, 0, 0)
        assert qz * qz + qw * qw == pytest.approx(1)
        assert ORIGIN.compose(truth[int(index)]).distance(Pose2(x, y, 0.0)) < 0.3


def test_each_update_is_written_with_its_covariance_agreement_and_lost_flag(folder: Path, tmp_path: Path) -> None:
    table, lines = tmp_path / "updates.csv", tmp_path / "updates.jsonl"
    told = json.loads(run(folder, "--global", "--json", "--updates", str(table)).stdout)
    assert run(folder, "--global", "--updates", str(lines)).exit_code == 0
    rows = pd.read_csv(table)
    assert len(rows) == told["updates"]
    assert rows["lost"].dtype == bool
    assert rows["lost"].sum() == told["lost_updates"] > 0, "it begins anywhere"
    first = told["lost_stretches"][0]
    assert rows["stamp"][0] == first["start"]
    assert rows["lost"][: first["updates"]].all()
    last = rows.iloc[-1]
    covariance = [[last.cov_xx, last.cov_xy, last.cov_xa], [last.cov_xy, last.cov_yy, last.cov_ya]]
    assert covariance == pytest.approx(np.array(told["covariance"][:2]))
    assert rows["agreement"].between(0.0, 1.0).all()
    assert last.agreement > 0.8
    assert rows["p_wrong"].between(0.0, 1.0).all()
    assert last.p_wrong == told["p_wrong"]
    parsed = [json.loads(line) for line in lines.read_text().splitlines()]
    pd.testing.assert_frame_equal(pd.DataFrame(parsed), rows)


def test_odometry_that_cannot_be_true_is_reported_and_moves_nothing(tmp_path: Path) -> None:
    truth = write(tmp_path / "a.bag", Robot(spikes={20: 1000.0}, reset_at=50), seconds=4.0)
    write_map(tmp_path, ORIGIN)
    done = run(tmp_path, *start(), "--json", "--out", str(tmp_path / "est.tum"))
    told = json.loads(done.stdout)
    assert [fault["kind"] for fault in told["odometry_faults"]] == ["outlier", "reset"]
    assert told["odometry_faults"][0]["meters"] == pytest.approx(1000.0, abs=0.1)
    why = "messages left out as outliers, because the robot cannot have driven there"
    assert f"/odom: {why}: 1 (after " in " ".join(told["notices"])
    for line in (tmp_path / "est.tum").read_text().splitlines():
        stamp, x, y, *_ = map(float, line.split())
        true = ORIGIN.compose(truth[round((stamp - START_NS / 1e9) * 10)])
        assert true.distance(Pose2(x, y, 0.0)) < 0.3
    assert told["p_wrong"] < 0.1


def test_the_fastest_speed_of_odometry_can_be_given(tmp_path: Path) -> None:
    write(tmp_path / "a.bag", Robot(spikes={20: 0.15}), seconds=2.0)
    write_map(tmp_path, ORIGIN)
    plain, bounded = (
        json.loads(run(tmp_path, *start(), "--json", *more).stdout) for more in ([], ["--max-odom-speed", "1.0"])
    )
    assert (plain["odometry_faults"], len(bounded["odometry_faults"])) == ([], 1)


@pytest.mark.parametrize("suffix", ["svg", *slow("png", "pdf")])
def test_the_path_is_drawn_over_the_map_the_same_each_time(folder: Path, tmp_path: Path, suffix: str) -> None:
    pictures = [tmp_path / f"{number}.{suffix}" for number in range(2)]
    for picture in pictures:
        done = run(folder, "--global", "--plot", str(picture))
        assert done.exit_code == 0, done.output
    assert pictures[0].read_bytes() == pictures[1].read_bytes()


def test_times_without_a_place_are_told(folder: Path) -> None:
    assert "The robot was lost at" in run(folder, "--global").stdout
    assert "The robot was not lost at any update." in run(folder, *start()).stdout


def test_the_only_odometry_is_taken_whatever_its_name(tmp_path: Path) -> None:
    write(tmp_path / "a.bag", Robot(odom_topic="/vesc/odom"), seconds=4.0)
    write_map(tmp_path, ORIGIN)
    told = json.loads(run(tmp_path, *start(), "--json").stdout)
    assert told["odometry"] == "/vesc/odom"


def test_anywhere(folder: Path) -> None:
    done = run(folder, "--global")
    assert done.exit_code == 0, done.output
    assert "updates from 41 scans" in " ".join(done.stdout.split())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "--initial-pose X Y YAW, or --global"),
        (["--global", "--initial-pose", "0", "0", "0"], "--initial-pose X Y YAW, or --global"),
        (["--initial-pose", "nan", "0", "0"], "three finite numbers"),
        (["--global", "--scan-topic", "/base_scan"], "LaserScan is on /scan"),
        (["--global", "--out", "/nowhere/at/all.tum"], "--out"),
        (["--global", "--updates", "/nowhere/at/all.csv"], "--updates"),
        (["--global", "--updates", "updates.xlsx"], ".csv or .jsonl"),
        (["--global", "--plot", "/nowhere/at/all.png"], "--plot"),
        (["--global", "--plot", "path.bmp"], ".png or .svg or .pdf"),
    ],
)
def test_bad_input_is_told_and_ends_with_2(folder: Path, options: list[str], message: str) -> None:
    done = run(folder, *options)
    assert done.exit_code == 2
    assert message in done.stderr


def test_parameters_of_a_real_robot(folder: Path, tmp_path: Path) -> None:
    """The filter does as they say: with update_min_d at half a meter it is updated half as often."""
    sparse = tmp_path / "amcl.yaml"
    sparse.write_text("update_min_d: 0.5\nmin_particles: 200\n")
    often = json.loads(run(folder, *start(), "--json").stdout)["updates"]
    seldom = json.loads(run(folder, *start(), "--json", "--params", str(sparse)).stdout)["updates"]
    assert 1 < seldom < 0.7 * often


@pytest.mark.parametrize("kind", ["ekf", "ukf"])
def test_a_kalman_filter_with_its_parameters(folder: Path, tmp_path: Path, kind: str) -> None:
    sparse, table = tmp_path / "filter.yaml", tmp_path / "updates.csv"
    sparse.write_text("ekf: {update_min_d: 0.5}\n")
    chosen = ("--localization", kind, "--json")
    often = json.loads(run(folder, *start(), *chosen, "--updates", str(table)).stdout)
    seldom = json.loads(run(folder, *start(), *chosen, "--params", str(sparse)).stdout)
    assert 1 < seldom["updates"] < 0.7 * often["updates"]
    assert seldom["ros_defaults"] == []
    rows = pd.read_csv(table)
    assert len(rows) == often["updates"]
    assert rows["agreement"].isna().all()
    assert rows["p_wrong"].between(0.0, 1.0).all()
    amcl = json.loads(run(folder, *start(), "--json").stdout)
    assert often["final_pose"] == pytest.approx(amcl["final_pose"], abs=0.1)
    assert often["final_pose"] != amcl["final_pose"]


def test_a_wrong_parameter_is_told_with_its_place(folder: Path, tmp_path: Path) -> None:
    wrong = tmp_path / "amcl.yaml"
    wrong.write_text("max_particles: 900\nupdate_min_dd: 0.5\n")
    done = run(folder, *start(), "--params", str(wrong))
    assert done.exit_code == 2
    assert "line 2, amcl.update_min_dd: unknown key. The nearest name is update_min_d" in done.stderr


def test_the_time_offset_of_odometry_is_reported_and_corrected(tmp_path: Path) -> None:
    # All odometry of this robot is 25 ms early.
    write(tmp_path / "a.bag", Robot(weave=0.06, odom_early_ns=125_000_000), seconds=9.0)
    write_map(tmp_path, ORIGIN)
    plain, *corrected = (
        run(tmp_path, *start(), "--json", *more) for more in ([], ["--time-offset", "auto"], ["--time-offset", "0.15"])
    )
    assert "Correct this with --time-offset auto" in plain.stderr
    told = json.loads(plain.stdout)
    assert told["time_offset"]["seconds"] == pytest.approx(0.15, abs=0.02)
    assert told["time_offset"]["deviation"] < 0.02
    assert told["time_offset_applied"] == 0.0
    for done in corrected:
        assert "Correct this with" not in done.stderr
        told = json.loads(done.stdout)
        assert told["time_offset"]["seconds"] == pytest.approx(0.15, abs=0.02)
        assert told["time_offset_applied"] == pytest.approx(0.15, abs=0.02)
    lines = " ".join(run(tmp_path, *start(), "--time-offset", "0.15").stdout.split())
    assert "The odometry is 0.1" in lines
    assert "An offset of 0.150 s is corrected." in lines


def test_a_drive_without_turns_says_nothing_about_the_clocks(folder: Path) -> None:
    assert json.loads(run(folder, *start(), "--json").stdout)["time_offset"] is None


@pytest.mark.parametrize("given", ["soon", "nan", "11"])
def test_a_time_offset_that_is_none_is_refused(folder: Path, given: str) -> None:
    done = run(folder, *start(), "--time-offset", given)
    assert done.exit_code == 2
    assert "--time-offset" in done.stderr

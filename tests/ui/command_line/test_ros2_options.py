"""Options for ROS 2: `--carrier zenoh` with what a session needs for it, and `rviz --ros2`."""

import importlib.util
from pathlib import Path

import pytest

from tests.support.programs.commands import invoke
from tests.support.programs.ports import free_port


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def refusal(*options: str) -> str:
    done = invoke("play", *options, "--headless", "--ros2", "--carrier", "zenoh")
    assert done.exit_code == 2, (done.output, done.exception)
    assert not [*Path().rglob("*.bag"), *Path().rglob("*.journal")]
    return done.stderr


def test_a_session_without_a_router_names_the_command_that_starts_one() -> None:
    port = free_port()
    Path("study.yaml").write_text(f"ros2:\n  router: 127.0.0.1:{port}\n")
    told = refusal("study.yaml")
    assert f"ROS 2: no zenoh router at 127.0.0.1:{port}: Connection refused" in told
    assert "thbridge ros2 router" in told


def test_missing_packages_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    found = importlib.util.find_spec
    monkeypatch.setattr("ui.command_line.ros2.find_spec", lambda name: None if name == "zenoh" else found(name))
    told = refusal()
    assert "--carrier zenoh: eclipse-zenoh is not installed. Run: pip install 'thbridge[ros2]'" in told


def test_rviz2_is_started_with_simulated_time() -> None:
    done = invoke("ros", "rviz", "--ros2", "--to", "team.rviz")
    assert "rviz2 -d team.rviz --ros-args -p use_sim_time:=true" in done.output + done.stderr
    assert "use_sim_time" not in invoke("ros", "rviz", "--to", "team.rviz").stderr

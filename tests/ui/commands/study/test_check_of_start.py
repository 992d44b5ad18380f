"""`thbridge study check` refuses what a start of the study would refuse, with the same sentence."""

from pathlib import Path

import pytest

from tests.support.programs.commands import invoke, refusal

STARTS = {
    "simr": "robots_from: ros2\nros2: {host: 192.168.1.5}\n",
    "server": "server: {host: 0.0.0.0}\n",
    "play": "mavlink: {on: true, tcp: '0.0.0.0:5760'}\n",
    "simr robots": "robots: 2\nrobots_from: ros2\nfleet: {robot: {nav2: {action: /navigate}}}\n",
    "server keys": "keys: keys\n",
    "simr key": "watch: {port: 6010, key: key}\n",
    "play key": "mavlink: {on: true, signing_key: key}\n",
}


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("start", STARTS)
def test_check_and_start_refuse_with_one_sentence(start: str) -> None:
    Path("study.yaml").write_text(STARTS[start])
    options = ["--headless"] if start.startswith("play") else []
    refused = refusal(start.partition(" ")[0], "study.yaml", *options)
    assert refusal("study", "check", "study.yaml").splitlines()[-1] == refused.splitlines()[-1]


def test_the_network_of_a_graph_that_an_option_joins_is_checked() -> None:
    Path("study.yaml").write_text("ros2: {host: 192.168.1.5}\n")
    assert "ROS 2: other machines could reach 192.168.1.5" in refusal("study", "check", "study.yaml")
    Path("study.yaml").write_text("ros2: {host: 192.168.1.5}\nopen_to: [192.168.1.0/24]\n")
    assert invoke("study", "check", "study.yaml").exit_code == 0


def test_names_of_move_base_have_no_effect_on_nav2_robots() -> None:
    Path("study.yaml").write_text("robots_from: ros2\nfleet: {robot: {move_base: drive}}\n")
    notes = invoke("study", "check", "study.yaml").stderr
    assert "fleet.robot.move_base has no effect here: Nav2 robots have fleet.robot.nav2.action instead." in notes


def test_names_that_suit_one_source_of_robots_are_accepted_until_the_source_is_known() -> None:
    Path("study.yaml").write_text("robots: 2\nfleet: {robot: {odom_frame: odom}}\n")
    assert invoke("study", "check", "study.yaml").exit_code == 0
    assert "odom is both odom_frame of robot 1" in refusal("simr", "study.yaml", "--robots-from", "ros")

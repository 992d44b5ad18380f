"""`thbridge play`, whole, with the real robots."""

import json
import socket

import pytest

from tests.support.bags.rosbags_reader import messages
from tests.support.programs import commands
from tests.support.programs.processes import play_headless


@pytest.mark.slow
def test_the_same_seed_gives_the_same_hunt_and_the_same_bag(tmp_path):
    (tmp_path / "short.yaml").write_text("game: {energy: 40}\n")
    first, second = (play_headless(tmp_path, "short.yaml", "--robots", "2", "--seed", "7") for _ in range(2))
    del first["wall_seconds"], second["wall_seconds"]
    assert first == second
    assert first["score"] > 0
    older, newer = sorted((tmp_path / "bags").glob("*.bag"))
    assert messages(older) == messages(newer)


@pytest.mark.parametrize(
    ("robots", "rooms"), [(3, 8), *(pytest.param(*team, marks=pytest.mark.slow) for team in ((1, 5), (6, 8)))]
)
def test_teams_of_any_size_hunt_without_touching(tmp_path, robots, rooms):
    told = play_headless(tmp_path, "--robots", str(robots), "--seed", "3", "--bag", "hunt.bag")
    assert told["collisions"] == 0
    assert told["rooms_visited"] >= rooms
    assert len(told["energy"]) == robots


@pytest.mark.slow
def test_another_map_is_only_another_file(tmp_path):
    told = play_headless(tmp_path, "--map", "warehouse12", "--robots", "3", "--seed", "2", "--participant", "nearest")
    assert told["collisions"] == 0
    assert told["rooms_visited"] == 12


def test_a_taken_port_keeps_nobody_from_playing_alone(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        done = commands.thbridge(tmp_path, "play", "--headless", "--json", "--port", port, "--max-seconds", 5)
    assert done.exit_code == 1
    assert "cannot listen" in done.stderr
    assert json.loads(done.stdout)["sim_seconds"] == 5.0


def test_a_broken_study_is_refused_before_anything_starts(tmp_path):
    (tmp_path / "study.yaml").write_text("robts: 3\n")
    done = commands.thbridge(tmp_path, "play", "study.yaml", "--headless")
    assert done.exit_code == 2
    assert "study.yaml, line 1" in done.stderr.replace("\n", " ")
    assert "robots" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "bags").exists()

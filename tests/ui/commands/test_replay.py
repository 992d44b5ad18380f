"""`thbridge replay` from the user's seat."""

import json
from pathlib import Path

import pytest
from typer.testing import Result

from tests.support.bags.small_bags import write_hundred_messages
from tests.support.programs.commands import invoke
from thbridge.app.replay.replay import session_of
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.publisher import RosMessage, Topic
from thbridge.study.study_file import read_study_text


def progress_of(done: Result) -> tuple[object, ...]:
    """Return the values of the last line of --progress json."""
    return tuple(json.loads([line for line in done.stderr.splitlines() if line.startswith("{")][-1]).values())


@pytest.fixture(scope="module")
def hunt(tmp_path_factory: pytest.TempPathFactory) -> Path:
    bag = tmp_path_factory.mktemp("hunt") / "hunt.bag"
    limits = ("--seed", "7", "--max-seconds", "18", "--progress", "json")
    done = invoke("play", "--json", "--port", "0", *limits, "--bag", bag)
    assert done.exit_code == 1  # not over yet
    assert progress_of(done)[:3] == ("simulated seconds", 17, None)
    return bag


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_same_again(hunt: Path) -> None:
    done = invoke("replay", hunt, "--to", "again.bag", "--json", "--progress", "json")
    assert done.exit_code == 0, done.output
    assert progress_of(done)[:3] == ("simulated seconds", 17, 18)
    result = json.loads(done.stdout)
    assert (result["equal"], result["first_difference"], result["ticks"], result["bag"]) == (
        True,
        None,
        900,
        "again.bag",
    )
    assert Path("again.bag").read_bytes() == hunt.read_bytes()
    assert "recorded" not in result


def test_for_people_it_tells_the_hunt_from_a_time_on(hunt: Path) -> None:
    done = invoke("replay", hunt, "--from", "14")
    assert done.exit_code == 0
    assert "Game 1 begins" not in done.stdout
    assert "is in room" in done.stdout
    assert "the same, bit for bit" in done.stdout


def test_a_difference_is_told_and_ends_with_1(hunt: Path) -> None:
    recorded = list(messages(hunt))
    victim = next(n for n, m in enumerate(recorded) if n > 1500 and m.topic.endswith("/odom"))
    with BagWriter(Path("forged.bag")) as writer:
        for number, message in enumerate(recorded):
            data = message.data[:-8] + bytes(8) if number == victim else message.data
            writer.write(RosMessage(Topic(message.topic, message.msgtype), message.stamp_ns, data))
    done = invoke("replay", "forged.bag")
    assert done.exit_code == 1
    assert f"First difference: message {victim} (" in done.stdout.replace("\n", " ")
    assert "twist.covariance[35]" in done.stdout


def test_what_if_compares_both_runs(hunt: Path) -> None:
    done = invoke("replay", hunt, "--with", "seed=8", "--with", "robot.amcl.max_particles=300", "--json")
    assert done.exit_code == 0, done.output
    result = json.loads(done.stdout)
    assert result["first_difference"]["topic"] == "/hunt/events"
    for run in ("recorded", "replayed"):
        assert [robot["name"] for robot in result[run]["robots"]] == ["robot1", "robot2"]
        assert all(robot["error_mean"] > 0.0 for robot in result[run]["robots"])
    assert result["recorded"] != result["replayed"]
    assert not list(Path().iterdir())


def test_what_if_for_people_is_a_table(hunt: Path) -> None:
    Path("other.yaml").write_text("noise: {preset: bad wheels}\n")
    done = invoke("replay", hunt, "--with", "other.yaml", "--participant", "nearest")
    assert done.exit_code == 0, done.output
    assert "Recorded and replayed" in done.stdout
    assert "robot 2: energy left" in done.stdout
    assert "refused" not in done.stderr


def test_requests_that_come_too_early_for_the_changed_robots_are_counted(hunt: Path) -> None:
    done = invoke("replay", hunt, "--with", "robot.TrajectoryPlannerROS.max_vel_x=0.2", "--json")
    assert done.exit_code == 0, done.output
    assert "Requests of the participant that were refused: " in done.stderr
    assert "use a simulated participant instead of the recorded one: --participant" in done.stderr


def test_the_recorded_study_names_who_played() -> None:
    played = invoke("play", "--json", "--port", "0", "--participant", "nearest", "--max-seconds", "1", "--bag", "a.bag")
    assert played.exit_code == 1  # not over yet
    assert invoke("replay", "a.bag").exit_code == 0
    assert invoke("replay", "a.bag", "--participant", "random", "--to", "b.bag").exit_code == 0
    for bag, strategy in (("a.bag", "nearest"), ("b.bag", "random")):
        record = session_of(Path(bag))
        assert record.participant == strategy
        assert read_study_text(Path(bag), record.study).participant.strategy == strategy


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--with", "seed"], "'seed' is neither KEY=VALUE nor a study file"),
        (["--with", "sed=3"], "sed: unknown key. The nearest name is seed"),
        (["--with", "robots=50"], "there are start poses for"),
        (["--with", "map=./nowhere"], "nowhere"),
        (["--with", "none.yaml"], "none.yaml"),
        (["--to", "bag.txt"], "--to: bag.txt is not the name of a recording"),
    ],
)
def test_bad_input_is_refused(hunt: Path, arguments: list[str], message: str) -> None:
    done = invoke("replay", hunt, *arguments)
    assert done.exit_code == 2
    assert message in done.stderr.replace("\n", " ")
    assert done.stdout == ""


def test_a_recording_is_not_replayed_onto_itself(hunt: Path) -> None:
    before = hunt.read_bytes()
    assert invoke("replay", hunt, "--to", hunt).exit_code == 2
    assert hunt.read_bytes() == before


def test_foreign_and_broken_bags_are_refused(folder: Path) -> None:
    write_hundred_messages(folder / "foreign.bag")
    (folder / "broken.bag").write_bytes(b"#ROSBAG V2.0\nnonsense")
    for name in ("foreign.bag", "broken.bag", "missing.bag"):
        done = invoke("replay", name)
        assert done.exit_code == 2
        assert name in done.stderr

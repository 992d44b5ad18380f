"""The Java programs of 2016's manner with our server and our robots, as processes: the whole of what they relied on."""

import json
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.support.programs import processes
from tests.support.programs.peer_programs import run_peer, skipping_if_crashed
from thbridge.recording.bag.reading.reader import messages

SOURCES = sorted(Path(__file__).parent.glob("*.java"))

Program, until, kinds, journal = processes.Program, processes.until, processes.kinds, processes.journal

pytestmark = pytest.mark.skipif(
    shutil.which("javac") is None or shutil.which("java") is None, reason="no JDK: javac and java are not installed"
)


@pytest.fixture(scope="module")
def classes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("java")
    done = run_peer(["javac", "-encoding", "UTF-8", "-d", folder, *SOURCES])
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture
def robots(tmp_path):
    """Our server and SimR; what joins them is up to the test."""
    running = [Program(tmp_path, "server", "--port", "0")]
    try:
        port = processes.port_of(running[0], running)
        running.append(Program(tmp_path, "simr", "--server", f"127.0.0.1:{port}", "--rate", "20"))
        until("the robots to be ready", lambda: "started" in kinds(tmp_path), running)
        yield port, running
    finally:
        for program in running:
            program.close()


def java(classes: Path, name: str, port: int, *arguments: str) -> list[str]:
    command = ["java", "-Xmx32m", "-XX:TieredStopAtLevel=1", "-cp", str(classes), name, "127.0.0.1", str(port)]
    return [*command, *arguments]


def tabui_says(classes: Path, port: int, *visits: str) -> str:
    return run_peer(java(classes, "TabUi", port, *visits), timeout=120).stdout


@contextmanager
def old_hider(classes: Path, port: int, *treasures: str) -> Iterator[None]:
    command = java(classes, "Hider", port, *treasures)
    hider = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        with skipping_if_crashed("java Hider", hider):
            assert hider.stdout.readline() == "acknowledged\n"
            yield
    finally:
        hider.kill()
        hider.communicate()


def test_old_participant_and_old_hider(classes, robots, tmp_path):
    port, running = robots
    with old_hider(classes, port, "3:Orange:Round and Large:10:Orange Bottle:rsz_t1.jpg"):
        said = tabui_says(classes, port, "0:3:Orange Bottle")
    assert said.splitlines() == [
        "reached robot=0 room=3",
        "found room=3 [Colour: Orange Footprint: Round and Large]",
        "image room=3 [rsz_t1.jpg]",
        "score 10",
        "total 10",
    ]
    # The game knows it all, though neither of them told it anything.
    until("the score to be journalled", lambda: "identified" in kinds(tmp_path), running)
    events = {event["event"]: event for event in journal(tmp_path)}
    assert events["arrived"]["room"] == 4
    assert events["sensed"]["colour"] == "Orange"
    assert events["identified"]["points"] == 10
    assert "hidden" not in events


@pytest.mark.slow
def test_old_participant_and_our_hider(classes, robots, tmp_path):
    port, running = robots
    running.append(Program(tmp_path, "hider", "--server", f"127.0.0.1:{port}"))
    until("the treasures to be hidden", lambda: "hidden" in kinds(tmp_path), running)
    treasure = next(event for event in journal(tmp_path) if event["event"] == "hidden")["treasures"][6]
    said = tabui_says(classes, port, f"1:6:{treasure['name']}")
    assert said.splitlines() == [
        "reached robot=1 room=6",
        f"found room=6 [Colour: {treasure['colour']} Footprint: {treasure['footprint']}]",
        f"image room=6 [{treasure['image']}]",
        f"score {treasure['points']}",
        f"total {treasure['points']}",
    ]


@pytest.mark.slow
def test_our_participant_and_old_hider(classes, robots, tmp_path):
    port, running = robots
    rooms = [f"{room}:Orange:Round and Large:10:Orange Bottle:rsz_t1.jpg" for room in range(8)]
    with old_hider(classes, port, *rooms):
        tabui = Program(tmp_path, "tabui", "--server", f"127.0.0.1:{port}", "--json")
        running.append(tabui)
        until("the end of the hunt", lambda: tabui.process.poll() is not None, running, 200)
    told = json.loads(tabui.text.splitlines()[-1])
    assert told["rooms_visited"] == 8
    assert told["score"] == 80


@pytest.mark.slow
def test_old_participant_joins_play_which_is_then_stopped(classes, tmp_path):
    play = Program(
        tmp_path, "play", "--outside", "TabUI", "--port", "0", "--rate", "20", "--bag", "a.bag", "--no-report"
    )
    try:
        until("play to listen", lambda: "can join at" in play.text, [play])
        port = int(play.text.split("can join at ")[1].split(".\n")[0].rpartition(":")[2])
        until("the treasures to be hidden", lambda: "treasures are hidden" in play.text, [play])
        (record,) = (tmp_path / "a.journal").glob("*.jsonl")
        events = [json.loads(line) for line in record.read_text().splitlines()]
        treasure = next(event for event in events if event["event"] == "hidden")["treasures"][3]
        said = tabui_says(classes, port, f"0:3:{treasure['name']}")
        assert said.splitlines()[-1] == f"total {treasure['points']}"
        assert play.stop() == 1
    finally:
        play.close()
    assert "The recording is complete up to this point" in play.text
    assert not (tmp_path / "a.bag.active").exists()
    recorded = [json.loads(line) for line in record.read_text().splitlines()]
    said_in_bag = [message.data for message in messages(tmp_path / "a.bag") if message.topic == "/hunt/events"]
    for event in recorded:
        kind = f'"event":"{event["event"]}"'.encode()
        assert any(kind in data.replace(b" ", b"") for data in said_in_bag), event

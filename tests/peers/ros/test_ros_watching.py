"""ROS 1's own rosbag judges what a session says at its watch door, once it is in a file."""

import asyncio
import dataclasses
import json
import shutil
from pathlib import Path

import pytest

from tests.peers.ros_programs import NEEDS_ROS, PYTHON, clean
from tests.support.programs.peer_programs import run_peer
from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import read_setting
from thbridge.app.listeners import StartupCallbacks, WatchAddress
from thbridge.app.play import HuntUnfinished, PlayOptions, play
from thbridge.recording.bag.reading.reader import info
from thbridge.recording.bag.repair import reindex
from thbridge.roles.participant.tabui import TabUI
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.study.study_file import Study

STUDY = dataclasses.replace(Study(), seed=7, server=dataclasses.replace(Study().server, port=0))


@pytest.fixture(scope="module")
def captured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Some seconds of a hunt, as `nc HOST PORT > x.bag` would have them."""
    bag = tmp_path_factory.mktemp("watched") / "x.bag"
    setting, copying = read_setting(STUDY, Path()), list[asyncio.Task[None]]()

    async def copy(where: ListeningAddress) -> None:
        reader, _ = await asyncio.open_connection(where.host, where.port)
        with bag.open("wb") as file:
            while data := await reader.read(65536):
                file.write(data)

    def come(where: ListeningAddress | CannotListen) -> None:
        assert isinstance(where, ListeningAddress)
        copying.append(asyncio.ensure_future(copy(where)))

    async def whole() -> None:
        watch = WatchAddress("127.0.0.1", 0, None)
        options = PlayOptions(20.0, None, frozenset(), "suggestion", 8.0, watch=watch)
        bot = TabUI(build_bot(setting.templates, STUDY.participant.strategy, STUDY.seed))
        told = StartupCallbacks(lambda master: None, come)
        try:
            await play(setting, (bot,), options, lambda where: None, lambda moment: None, told)
        finally:
            await copying[0]

    with pytest.raises(HuntUnfinished):
        asyncio.run(whole())
    return bag


def run(*command: str) -> str:
    done = run_peer(command, env=clean(), timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def copied(captured: Path, folder: Path) -> Path:
    return Path(shutil.copy(captured, folder / "x.bag"))


@NEEDS_ROS
def test_rosbag_reindexes_it_and_finds_what_we_find(captured: Path, tmp_path: Path) -> None:
    theirs = copied(captured, tmp_path)
    run("rosbag", "reindex", "-q", str(theirs))
    (tmp_path / "ours").mkdir()
    ours = info(reindex(copied(captured, tmp_path / "ours")).path)
    said = run("rosbag", "info", "--yaml", str(theirs))
    assert f"messages: {ours.messages}\n" in said
    for topic in ours.topics:
        assert f"- topic: {topic.name}\n      type: {topic.msgtype}\n      messages: {topic.messages}\n" in said
    assert {"/map", "/thbridge/session", "/tf_static", "/watch/status"} <= {topic.name for topic in ours.topics}
    assert next(topic.messages for topic in ours.topics if topic.name == "/tf") > 300


@NEEDS_ROS
def test_its_reader_reads_the_doors_status(captured: Path, tmp_path: Path) -> None:
    bag = copied(captured, tmp_path)
    run("rosbag", "reindex", "-q", str(bag))
    script = (
        "import rosbag, sys\n"
        "for _, message, _ in rosbag.Bag(sys.argv[1]).read_messages(['/watch/status']): print(message.data)\n"
    )
    first = json.loads(run(PYTHON, "-c", script, str(bag)).splitlines()[0])
    assert (first["watchers"], first["rate"], first["paused"], first["dropped"]) == (1, 20.0, False, 0)

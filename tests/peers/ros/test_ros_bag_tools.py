"""ROS 1's own tools judge our bags: Debian's rosbag and rostopic, and the real Python reader from PyPI."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
import xmlrpc.client
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import rosbag
from rosbags.rosbag1 import Reader

from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from tests.support.bags.inline_queue import InlineQueue
from tests.support.programs.peer_programs import run_peer, skipping_if_crashed
from tests.support.programs.ports import free_port
from tests.support.ros.type_lists import STANDARD_TYPES
from thbridge.app.session.broadcast import Broadcast
from thbridge.files.ros.definitions import ROS_SHARES, Definitions
from thbridge.recording.bag.options import ROS1_COMPRESSIONS, Compression, SplitLimits
from thbridge.recording.bag.reading.reader import info, messages
from thbridge.recording.bag.repair import reindex
from thbridge.recording.bag.writing.writer import WHOLE, BagWriter
from thbridge.recording.recordings import parts_of
from thbridge.ros.messages.records import MavlinkFrame, VehicleFrame, VehicleState
from thbridge.ros.messages.types import MARKER_ARRAY, MAVROS_TYPES, OWN_TYPES
from thbridge.ros.publisher import RosMessage, TeamPublisher, Topic

PYTHON = "/usr/bin/python3"
TOOLS = ("rosbag", "rostopic", "roscore")
PACKED = [Compression.LZ4, pytest.param(Compression.BZ2, marks=pytest.mark.slow)]
needs_ros = pytest.mark.skipif(
    any(shutil.which(tool) is None for tool in TOOLS),
    reason=f"not installed: {', '.join(TOOLS)} (see scripts/install_peers.sh)",
)


def knows_our_messages() -> bool:
    """Whether the installed ROS has been made to know our types."""
    if any(shutil.which(tool) is None for tool in TOOLS):
        return False
    asked = [PYTHON, "-c", "import thbridge_msgs.msg, mavros_msgs.msg"]
    return subprocess.run(asked, capture_output=True, env=_environment(""), check=False).returncode == 0


needs_our_messages = pytest.mark.skipif(
    "not knows_our_messages()",
    reason="ROS, or the packages of our messages for it (scripts/install_ros_messages.sh), is not installed",
)
TICKS = 200
ROBOTS = 2
PATIENCE = 60.0


def run(*command: str, master: str = "") -> str:
    done = run_peer(command, env=_environment(master), timeout=PATIENCE)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def _environment(master: str) -> dict[str, str]:
    # Debian's Python must not see this environment's packages.
    kept = {
        name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")
    }
    return {**kept, "ROS_MASTER_URI": master, "ROS_IP": "127.0.0.1", "PYTHONUNBUFFERED": "1"}


def eventually(true: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + PATIENCE
    while not true():
        if time.monotonic() > end:
            pytest.fail(f"waited in vain: {what}")
        time.sleep(0.05)


INSTALLED = Definitions(ROS_SHARES)


def record(
    path: Path,
    definitions: Definitions,
    compression: Compression = Compression.NONE,
    splitting: SplitLimits = WHOLE,
) -> Path:
    writer = BagWriter(path, definitions, compression=compression, splitting=splitting)
    with writer:
        recorder = Broadcast(TeamPublisher(ROBOTS, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
        for snapshot in snapshots(ROBOTS, TICKS):
            recorder.record(snapshot, records(snapshot.tick))
    return path


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("bags") / "a.bag", Definitions())


@pytest.fixture(scope="module")
def packed(tmp_path_factory: pytest.TempPathFactory) -> dict[Compression, Path]:
    """The same recording with the texts of the installed ROS, packed in every way."""
    folder = tmp_path_factory.mktemp("packed")
    return {kind: record(folder / f"{kind}.bag", INSTALLED, kind) for kind in ROS1_COMPRESSIONS}


@needs_ros
def test_rosbag_info_agrees_with_ours(bag: Path) -> None:
    said = run("rosbag", "info", "--yaml", str(bag))
    ours = info(bag)
    assert f"messages: {ours.messages}\n" in said
    assert f"duration: {ours.duration:.6f}\n" in said
    assert "indexed: True" in said
    for topic in ours.topics:
        assert f"- topic: {topic.name}\n      type: {topic.msgtype}\n      messages: {topic.messages}\n" in said


@needs_our_messages
def test_rosbag_check_wants_no_migration_at_all(packed: dict[Compression, Path]) -> None:
    assert run("rosbag", "check", str(packed[Compression.NONE])).strip() == "Bag file does not need any migrations."


@needs_our_messages
def test_rosbag_check_wants_no_migration_of_any_type(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "types.bag", INSTALLED) as writer:
        for number, msgtype in enumerate((*STANDARD_TYPES, *OWN_TYPES, *MAVROS_TYPES)):
            writer.write(RosMessage(Topic(f"/type{number}", msgtype), 1_000_000_000 + number, b""))
    assert run("rosbag", "check", str(tmp_path / "types.bag")).strip() == "Bag file does not need any migrations."


@needs_ros
def test_rostopic_reads_our_own_types_though_no_package_has_them(bag: Path, tmp_path: Path) -> None:
    assert "text: " in first_on(bag, "/dialogue/utterances", tmp_path)


def first_on(bag: Path, topic: str, folder: Path) -> str:
    """What rostopic says of a topic's first message, on a machine whose ROS knows no types of ours."""
    for package in ("thbridge_msgs", "mavros_msgs"):
        (folder / package).mkdir(exist_ok=True)
        (folder / package / "__init__.py").write_text("raise ImportError")
    command = ["rostopic", "echo", "-b", str(bag), "-n", "1", topic]
    environment = {**_environment(""), "PYTHONPATH": str(folder)}
    done = run_peer(command, env=environment, timeout=PATIENCE)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@needs_ros
def test_rostopic_reads_frames_and_states_of_vehicles(tmp_path: Path) -> None:
    told = MavlinkFrame("udp 127.0.0.1:14550", 253, 0, 0, 7, 255, 190, 0, 11100, bytes(range(9)))
    heard = VehicleFrame(0, True, told)
    state = VehicleState(0, True, True, False, False, "GUIDED", 4)
    bag = tmp_path / "vehicles.bag"
    with BagWriter(bag) as writer:
        publisher = TeamPublisher(1, MOUNT, SCAN_PERIOD, vehicles=True)
        Broadcast(publisher, SESSION, arena(), [writer]).record(next(snapshots(1, 1)), [heard, state])
    said = first_on(bag, "/robot1/mavlink/to", tmp_path)
    assert 'frame_id: "udp 127.0.0.1:14550"' in said
    assert "sysid: 255\ncompid: 190\nmsgid: 0\nchecksum: 11100\n" in said
    assert "payload64: [506097522914230528, 8]\nsignature: []" in said
    said = first_on(bag, "/robot1/mavros/state", tmp_path)
    assert 'guided: False\nmanual_input: False\nmode: "GUIDED"\nsystem_status: 4' in said


@pytest.mark.slow
@needs_our_messages
def test_with_texts_of_our_own_texts_differ_and_nothing_else(bag: Path) -> None:
    said = run("rosbag", "check", str(bag))
    lines = [line.split() for line in said.splitlines()]
    changed = {words[-2]: words[-1] for words in lines if "From:" in words}
    target = {words[-2]: words[-1] for words in lines if "To:" in words}
    assert changed
    assert changed == target  # name and md5 the same on both sides: a text-only migration


@needs_ros
def test_sums_and_texts_are_those_of_the_installed_ros() -> None:
    script = (
        "import json, sys, genpy.message as m\n"
        "classes = {t: m.get_message_class(t) for t in sys.argv[1:]}\n"
        "print(json.dumps({t: [c._md5sum, c._full_text.strip()] for t, c in classes.items() if c}))\n"
    )
    types = (*STANDARD_TYPES, *OWN_TYPES, *MAVROS_TYPES) if knows_our_messages() else STANDARD_TYPES
    theirs = json.loads(run(PYTHON, "-c", script, *types))
    # Only studies with things in the way have markers; not every ROS knows them.
    assert set(types) - set(theirs) <= {MARKER_ARRAY}
    ours = {msgtype: INSTALLED.of(msgtype) for msgtype in theirs}
    assert {name: Definitions().of(name).md5 for name in ours} == {name: md5 for name, (md5, _) in theirs.items()}
    assert {name: [ours[name].md5, ours[name].text.strip()] for name in ours} == theirs


def test_the_ros_python_reader_reads_every_message(bag: Path) -> None:
    with rosbag.Bag(str(bag)) as reader:
        said = [(topic, stamp.to_nsec(), message) for topic, message, stamp in reader.read_messages()]
    assert Counter(topic for topic, _, _ in said) == {topic.name: topic.messages for topic in info(bag).topics}
    first = next(message for topic, _, message in said if topic == "/robot1/odom")
    assert (first.header.frame_id, first.child_frame_id) == ("robot1/odom", "robot1/base_footprint")
    session = said[0][2] if said[0][0] == "/thbridge/session" else None
    assert session is None or session.study == SESSION.study
    assert all(message.intensities == () for topic, _, message in said if topic.endswith("/scan"))


def contents(path: Path) -> list[tuple[str, int, bytes]]:
    return sorted((message.topic, message.stamp_ns, message.data) for message in messages(path))


@needs_ros
@pytest.mark.parametrize("compression", ROS1_COMPRESSIONS)
def test_rosbag_filter_reads_every_compression(
    tmp_path: Path, packed: dict[Compression, Path], compression: Compression
) -> None:
    assert f"compression: {compression}\n" in run("rosbag", "info", "--yaml", str(packed[compression]))
    run("rosbag", "filter", str(packed[compression]), str(tmp_path / "some.bag"), "topic != '/tf'")
    expected = [item for item in contents(packed[Compression.NONE]) if item[0] != "/tf"]
    assert contents(tmp_path / "some.bag") == expected


@needs_our_messages
@pytest.mark.parametrize("compression", PACKED)
def test_rosbag_check_wants_nothing_of_packed_bags(packed: dict[Compression, Path], compression: Compression) -> None:
    assert run("rosbag", "check", str(packed[compression])).strip() == "Bag file does not need any migrations."


@needs_ros
@pytest.mark.parametrize("compression", PACKED)
def test_rosbag_packs_our_bags_and_unpacks_them(
    tmp_path: Path, packed: dict[Compression, Path], compression: Compression
) -> None:
    path = tmp_path / "a.bag"
    shutil.copy(packed[Compression.NONE], path)
    run("rosbag", "compress", "--quiet", f"--{compression}", str(path))
    assert contents(path) == contents(packed[Compression.NONE])
    shutil.copy(packed[compression], path)
    (tmp_path / "a.orig.bag").unlink()
    run("rosbag", "decompress", "--quiet", str(path))
    assert f"compression: {Compression.NONE}\n" in run("rosbag", "info", "--yaml", str(path))
    assert contents(path) == contents(packed[Compression.NONE])


@needs_ros
@pytest.mark.parametrize("compression", PACKED)
def test_we_recover_of_a_packed_bag_all_that_rosbag_recovers(
    tmp_path: Path, packed: dict[Compression, Path], compression: Compression
) -> None:
    whole = packed[compression].read_bytes()
    for name in ("ours", "theirs"):
        (tmp_path / f"{name}.bag").write_bytes(whole[: len(whole) * 2 // 3])
    run("rosbag", "reindex", "--quiet", str(tmp_path / "theirs.bag"))
    assert reindex(tmp_path / "ours.bag").messages > 500
    # A packed chunk that is cut off is lost to rosbag, and we unpack what is there of it.
    ours, theirs = (Counter(contents(tmp_path / f"{name}.bag")) for name in ("ours", "theirs"))
    assert theirs <= ours <= Counter(contents(packed[compression]))
    assert f"compression: {compression}\n" in run("rosbag", "info", "--yaml", str(tmp_path / "ours.bag"))


@needs_ros
@pytest.mark.parametrize("compression", ROS1_COMPRESSIONS)
def test_rosbag_reindex_recovers_a_chunk_that_was_growing(tmp_path: Path, compression: Compression) -> None:
    seconds = iter(range(1000))
    writer = BagWriter(
        tmp_path / "a.bag",
        clock=lambda: float(next(seconds)),
        compression=compression,
        make_queue=lambda _: InlineQueue(),
    )
    with writer:
        recorder = Broadcast(TeamPublisher(ROBOTS, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
        for snapshot in snapshots(ROBOTS, TICKS):
            recorder.record(snapshot)
        shutil.copy(tmp_path / "a.bag.active", tmp_path / "growing.bag")
    run("rosbag", "reindex", "--quiet", str(tmp_path / "growing.bag"))
    assert contents(tmp_path / "growing.bag") == contents(tmp_path / "a.bag")


@pytest.mark.parametrize("compression", ROS1_COMPRESSIONS)
def test_the_ros_python_reader_and_rosbags_read_every_compression(
    packed: dict[Compression, Path], compression: Compression
) -> None:
    expected = contents(packed[Compression.NONE])
    with rosbag.Bag(str(packed[compression])) as reader:
        said = [(topic, stamp.to_nsec(), raw[1]) for topic, raw, stamp in reader.read_messages(raw=True)]
    assert sorted(said) == expected
    with Reader(packed[compression]) as reader:
        assert sorted((c.topic, stamp, bytes(data)) for c, stamp, data in reader.messages()) == expected


@needs_ros
def test_each_part_of_a_split_recording_is_a_bag_to_rosbag(tmp_path: Path) -> None:
    record(tmp_path / "a.bag", Definitions(), Compression.LZ4, SplitLimits(duration_ns=1_500_000_000))
    parts = parts_of(tmp_path / "a.bag")
    assert len(parts) == 3
    for part in parts:
        said = run("rosbag", "info", "--yaml", str(part))
        assert f"messages: {info(part).messages}\n" in said
        assert f"duration: {info(part).duration:.6f}\n" in said
        assert "- topic: /map\n" in said


WRITE = """
import sys
from pathlib import Path
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, snapshots
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.app.session.broadcast import Broadcast
from thbridge.ros.publisher import TeamPublisher

writer = BagWriter(Path(sys.argv[1]))
recorder = Broadcast(TeamPublisher(2, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
for snapshot in snapshots(2, 100_000):
    recorder.record(snapshot)
    print(snapshot.tick, flush=True)
"""


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, int]:
    """A recording ended by SIGKILL, and the last tick that it had taken."""
    path = tmp_path_factory.mktemp("killed") / "k.bag"
    process = subprocess.Popen([sys.executable, "-c", WRITE, str(path)], stdout=subprocess.PIPE)
    assert process.stdout is not None
    ticks = [int(line) for _, line in zip(range(777), process.stdout, strict=False)]
    process.kill()
    ticks += [int(line) for line in process.stdout if line.endswith(b"\n")]
    process.stdout.close()
    process.wait()
    return path.with_name("k.bag.active"), ticks[-1]


def ticks_of(path: Path) -> list[int]:
    with rosbag.Bag(str(path)) as reader:
        return [message.header.seq for _, message, _ in reader.read_messages(topics=["/robot1/odom"])]


@pytest.mark.parametrize("judge", [pytest.param("rosbag", marks=needs_ros), "rosbag-standalone", "thbridge"])
def test_a_killed_recording_is_recovered_but_for_its_last_second(
    tmp_path: Path, killed: tuple[Path, int], judge: str
) -> None:
    active, last = killed
    path = tmp_path / "k.bag"
    shutil.copy(active, path)
    if judge == "rosbag":
        run("rosbag", "reindex", "--quiet", str(path))
    elif judge == "thbridge":
        reindex(path)
    else:
        with rosbag.Bag(str(path), "a", allow_unindexed=True) as broken:
            for _ in broken.reindex():
                pass
    ticks = ticks_of(path)
    assert ticks == list(range(len(ticks)))
    assert last - ticks[-1] <= 50


@needs_ros
def test_what_we_repair_is_whole_to_rosbag(tmp_path: Path, killed: tuple[Path, int]) -> None:
    path = tmp_path / "k.bag"
    shutil.copy(killed[0], path)
    repaired = reindex(path)
    assert f"messages: {repaired.messages}\n" in run("rosbag", "info", "--yaml", str(path))


@needs_ros
def test_a_kill_between_index_and_header_is_recovered_by_rosbag(tmp_path: Path, bag: Path) -> None:
    data = bytearray(bag.read_bytes())
    for name, size in ((b"index_pos=", 8), (b"conn_count=", 4), (b"chunk_count=", 4)):
        at = data.index(name) + len(name)
        data[at : at + size] = bytes(size)
    path = tmp_path / "a.bag"
    path.write_bytes(data)
    run("rosbag", "reindex", "--quiet", str(path))
    assert [m.data for m in messages(path)] == [m.data for m in messages(bag)]


@pytest.fixture(scope="module")
def master(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A roscore of our own."""
    port = free_port()
    uri = f"http://127.0.0.1:{port}"
    environment = {**_environment(uri), "ROS_LOG_DIR": str(tmp_path_factory.mktemp("log"))}
    core = subprocess.Popen(
        ["roscore", "-p", str(port)],
        env=environment,
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        with skipping_if_crashed("roscore", core):
            eventually(lambda: "/rosout" in subscribed(uri), "roscore to start")
        yield uri
    finally:
        ended(core)


def ended(program: subprocess.Popen[bytes]) -> None:
    """End a program of ROS as a person does."""
    if program.poll() is None:
        os.killpg(program.pid, signal.SIGINT)
    try:
        program.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        os.killpg(program.pid, signal.SIGKILL)
        program.wait()


def subscribed(master: str) -> set[str]:
    """Topics that somebody listens to."""
    try:
        _, _, state = xmlrpc.client.ServerProxy(master).getSystemState("/judge")
    except OSError:
        return set()
    return {topic for topic, _ in state[1]}


@contextmanager
def playing(master: str, *options: str) -> Iterator[subprocess.Popen[bytes]]:
    """A player that drops nothing where a listener is slow; what it has advertised is gone when it is."""
    player = subprocess.Popen(
        ["rosbag", "play", "--quiet", f"--queue={10 * TICKS}", *options],
        env=_environment(master),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        with skipping_if_crashed("rosbag play", player):
            yield player
    finally:
        ended(player)


@needs_ros
def test_rosbag_play_says_everything_from_the_first_message_on(bag: Path, master: str) -> None:
    topic = "/robot1/base_pose_ground_truth"
    with playing(master, "--rate=4", "--keep-alive", "--wait-for-subscribers", str(bag), "--topics", topic):
        eventually(lambda: topic in published(master), "play to advertise")
        said = run("rostopic", "echo", "-n", str(TICKS), f"{topic}/header/seq", master=master)
    assert [int(line) for line in said.split() if line != "---"] == list(range(TICKS))


@needs_ros
def test_rosbag_play_plays_every_topic_and_late_listeners_get_the_map(bag: Path, master: str) -> None:
    with playing(master, "--rate=100", "--keep-alive", str(bag)) as player:
        eventually(lambda: {topic.name for topic in info(bag).topics} <= published(master), "play to advertise")
        assert run("rostopic", "echo", "-n", "1", "/map/info/width", master=master).split()[0] == "160"
        last_frame = run("rostopic", "echo", "-n", "1", "/tf_static/transforms[3]/child_frame_id", master=master)
        assert "robot2/base_laser" in last_frame
        assert player.poll() is None


@needs_ros
def test_rosbag_plays_the_parts_of_a_packed_recording_as_one(tmp_path: Path, master: str) -> None:
    record(tmp_path / "a.bag", Definitions(), Compression.LZ4, SplitLimits(duration_ns=1_500_000_000))
    topic, parts = "/robot1/base_pose_ground_truth", map(str, parts_of(tmp_path / "a.bag"))
    with playing(master, "--rate=4", "--keep-alive", "--wait-for-subscribers", *parts, "--topics", topic):
        eventually(lambda: topic in published(master), "play to advertise")
        said = run("rostopic", "echo", "-n", str(TICKS), f"{topic}/header/seq", master=master)
    assert [int(line) for line in said.split() if line != "---"] == list(range(TICKS))


@pytest.mark.slow
@needs_ros
def test_rostopic_hz_finds_odometry_at_fifty_hertz(bag: Path, master: str) -> None:
    with playing(master, "--loop", str(bag), "--topics", "/robot1/odom"):
        hz = subprocess.Popen(
            ["rostopic", "hz", "--window=50", "/robot1/odom"],
            env=_environment(master),
            stdout=subprocess.PIPE,
            text=True,
        )
        assert hz.stdout is not None
        try:
            rates = (float(line.split()[-1]) for line in hz.stdout if line.startswith("average rate"))
            with skipping_if_crashed("rostopic hz", hz):
                assert any(45 < rate < 55 for _, rate in zip(range(10), rates, strict=False))
        finally:
            hz.kill()
            hz.wait()
            hz.stdout.close()


def published(master: str) -> set[str]:
    """Topics that somebody publishes."""
    _, _, state = xmlrpc.client.ServerProxy(master).getSystemState("/judge")
    return {topic for topic, _ in state[0]}

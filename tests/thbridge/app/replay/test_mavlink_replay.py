"""Recordings of hunts in which ground stations took part, run again: whole, or by their frames alone."""

import json
import random
from dataclasses import replace
from pathlib import Path

import pytest

from tests.support.hunts.recorded_hunts import assert_equal_replay, replay_again
from tests.support.mavlink.hostile_frames import Foe
from tests.support.mavlink.recorded_stations import STUDY, Follower, Station, Tour, beating, by_frames, record
from thbridge.app.compose.setting import read_setting
from thbridge.app.replay.mavlink_replay import has_session
from thbridge.app.session.session import Session
from thbridge.files.errors import BadFile
from thbridge.mavlink.role.parameters import PARAMETERS
from thbridge.mavlink.wire.dialect import decoded, mav
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.framer import FrameParser
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros.topics import RosMessage, Topic
from thbridge.study.mavlink import MavlinkSection
from thbridge.study.overrides import StudyChange
from thbridge.study.study_file import Study

OPEN, BURST = 4, 15
"""Of MAV_FTP_OPCODE."""

TO = Topic("/robot1/mavlink/to", types.MAVLINK)


def test_links_and_frames_are_replayed_bit_for_bit(tmp_path: Path):
    bag = tmp_path / "hunt.bag"
    record(bag, 120, beating({}))
    assert_equal_replay(bag, 120)


def test_a_home_that_was_set_is_set_again(tmp_path: Path):
    bag = tmp_path / "hunt.bag"
    stations: dict[str, Station] = {}
    place = (0, 0, 0, 0, 14_000, -27_000, 0)  # north and east, units of 0.1 mm

    def set_home(tick: int, session: Session) -> None:
        beating(stations)(tick, session)
        if tick == 20:
            stations["a"].say(mav.MAVLink_command_int_message(1, 1, 1, mav.MAV_CMD_DO_SET_HOME, 0, 0, *place))

    record(bag, 60, set_home)
    frames = [unpack.mavlink(message.data) for message in messages(bag, ["/robot1/mavlink/from"])]
    (home,) = [frame for frame in frames if frame.message_id == mav.MAVLINK_MSG_ID_HOME_POSITION]
    told = decoded(home.message_id, home.payload)
    assert (told.x, told.y) == pytest.approx((1.4, -2.7))
    assert_equal_replay(bag, 60)


def test_a_file_that_a_station_read_is_read_again_bit_for_bit(tmp_path: Path):
    bag = tmp_path / "hunt.bag"
    name = b"/parameters.json"

    def reading(tick: int, session: Session) -> None:
        if tick == 10:
            station = Station(session)
            for sequence, opcode, size, data in ((1, OPEN, len(name), name), (3, BURST, 239, b"")):
                asked = bytes((sequence, 0, 0, opcode, size, *[0] * 7)) + data
                station.say(mav.MAVLink_file_transfer_protocol_message(0, 1, 1, list(asked.ljust(251, b"\0"))))

    record(bag, 100, reading)
    told = [unpack.mavlink(raw.data) for raw in messages(bag, ["/robot1/mavlink/from"])]
    pieces = [frame.payload for frame in told if frame.message_id == mav.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL]
    content = b"".join(piece.ljust(254, b"\0")[15 : 15 + piece[7]] for piece in pieces[1:])
    assert {each["name"] for each in json.loads(content)["parameters"]} >= {each.name for each in PARAMETERS}
    assert_equal_replay(bag, 100)


def test_frames_say_nothing_to_robots_that_are_no_vehicles_any_more(tmp_path: Path):
    bag = tmp_path / "hunt.bag"
    record(bag, 120, beating({}))
    done = replay_again(bag, StudyChange("mavlink.on", "false"), to_the_end=True)
    assert done.difference is not None
    assert done.ticks == 120


def test_frames_alone_are_heard_by_the_same_robots_in_the_same_ticks_on_links_of_the_same_names(tmp_path: Path):
    bag, fresh = tmp_path / "hunt.bag", tmp_path / "fresh.bag"
    record(bag, 120, beating({}))
    done = by_frames(bag, to=fresh)
    topics = ["/robot1/mavlink/to", "/robot2/mavlink/to"]
    was, now = list(messages(bag, topics)), list(messages(fresh, topics))
    assert now == was
    assert (done.frames, done.unusable, done.ticks, done.finished) == (len(was), 0, 120, True)
    assert done.parted is None
    assert replay_again(fresh).difference is None


def test_robots_that_the_study_has_not_hear_nothing(tmp_path: Path):
    bag = tmp_path / "hunt.bag"
    record(bag, 120, beating({}))
    done = by_frames(bag, replace(STUDY, robots=1))
    assert done.unusable == len(list(messages(bag, ["/robot2/mavlink/to"]))) > 0


def test_a_bag_of_strangers_drives_robots_whose_study_has_no_vehicles(tmp_path: Path):
    bag, ours = tmp_path / "mavros.bag", tmp_path / "hunt.bag"
    record(ours, 120, beating({}))
    started = 1_600_000_000_000_000_000
    with BagWriter(bag) as writer:
        for number, message in enumerate(messages(ours, [TO.name])):
            stamp = started + number * 500_000_000
            truth = Topic("/robot1/base_pose_ground_truth", types.ODOMETRY)
            writer.take(number, [RosMessage(TO._replace(name="/mavlink/to"), stamp, message.data)])
            writer.take(number, [RosMessage(truth, stamp, b"of another simulator")])
    assert has_session(ours)
    assert not has_session(bag)
    done = by_frames(bag, replace(Study(), robots=1))
    assert (done.recorded, done.parted, done.unusable) == (None, None, 0)
    assert done.frames == number + 1
    assert done.ticks == 50 + 25 * number


def test_of_a_bag_that_was_cut_to_its_frames_nothing_is_claimed(tmp_path: Path):
    ours, cut = tmp_path / "hunt.bag", tmp_path / "cut.bag"
    record(ours, 120, beating({}))
    with BagWriter(cut) as writer:
        for number, message in enumerate(messages(ours, [names.SESSION, TO.name])):
            topic = Topic(message.topic, types.SESSION if message.topic == names.SESSION else TO.msgtype)
            writer.take(number, [RosMessage(topic, message.stamp_ns, message.data)])
    done = by_frames(cut)
    assert (done.recorded, done.compared, done.parted) == (None, 0, None)
    assert not done.same
    assert by_frames(ours).compared > 0


def test_a_bag_without_frames_is_refused_with_what_to_do(tmp_path: Path):
    bag = tmp_path / "hunt.bag"
    record(bag, 3, lambda tick, session: None, replace(STUDY, mavlink=MavlinkSection()))
    with pytest.raises(BadFile, match="it has no topic /robot1/mavlink/to of type mavros_msgs/Mavlink"):
        by_frames(bag)


def events(bag: Path) -> list[str]:
    return [unpack.game_event(message.data).kind for message in messages(bag, [names.GAME_EVENTS])]


def test_a_hunt_that_ground_stations_drove_and_a_window_followed_is_driven_again_by_its_frames_alone(tmp_path: Path):
    bag = tmp_path / "hunt.bag"
    record(bag, 950, Tour({1: [5, 2], 2: [4, 8]}), follower=Follower())
    assert {"commanded", "arrived", "sensed", "pictured", "identified"} <= set(events(bag))
    done = by_frames(bag)
    assert done.recorded is not None
    assert [arrival.room for arrival in done.recorded.arrivals] == [5, 4]
    assert done.recorded.score != 0
    assert done.replayed == done.recorded
    assert done.same
    assert done.parted is None
    assert_equal_replay(bag, 950)


class Storm:
    """Somebody who says all that should not be said, on several links."""

    def __init__(self, seed: int) -> None:
        self._chance = random.Random(seed)
        self._foe = Foe(self._chance, range(1, STUDY.robots + 1), [parameter.name for parameter in PARAMETERS])
        self._framer = FrameParser()

    def __call__(self, tick: int, session: Session) -> None:
        if tick % 40 == 10:
            if tick > 10:
                session.links.close_link(self._link)
            self._link = session.links.open_link(f"tcp {tick}")
        for _ in range(10 if tick > 10 else 0):
            for found in self._framer.receive_data(self._foe.says()):
                if isinstance(found, Frame):
                    session.transmit(session.links.receive_frame(self._link, found).replies)


@pytest.mark.parametrize("ticks", [150, pytest.param(1500, marks=pytest.mark.slow)])
def test_a_storm_of_frames_does_the_same_again(tmp_path: Path, ticks: int):
    bag = tmp_path / "hunt.bag"
    record(bag, ticks, Storm(3))
    assert_equal_replay(bag, ticks)
    done = by_frames(bag)
    assert done.frames > ticks
    assert (done.replayed, done.parted) == (done.recorded, None)


@pytest.mark.slow
def test_a_whole_hunt_by_ground_stations_comes_out_the_same_and_with_another_seed_it_goes_other_ways(tmp_path: Path):
    bag = tmp_path / "hunt.bag"
    study = replace(STUDY, map="practice", templates="practice")
    rooms = len(read_setting(study, Path()).map.rooms)
    numbers = [*range(1, rooms + 1)]
    tour = Tour({1: numbers[: rooms // 2], 2: numbers[rooms // 2 :]}, study)
    record(bag, 6000, tour, study, Follower())
    assert events(bag)[-1] == "ended"
    done = by_frames(bag, study)
    assert done.recorded is not None
    assert sorted(arrival.room for arrival in done.recorded.arrivals) == numbers
    assert (done.replayed, done.parted) == (done.recorded, None)
    other = by_frames(bag, replace(study, seed=8))
    assert other.parted is not None
    assert other.frames == done.frames
    assert_equal_replay(bag, 6000)

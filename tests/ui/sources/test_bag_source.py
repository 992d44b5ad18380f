import random
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Writer

from sim.common.grid import OccupancyGrid
from tests.support.bags.foreign_bags import Robot, write
from tests.ui.sources.scanned_bags import TICKS, opened, scanned
from thbridge.analysis.report.builder import read_report
from thbridge.files.errors import BadFile
from thbridge.recording.bag.reading import reader as bag_reader
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros import names
from thbridge.ros.publisher import RosMessage, Topic
from ui.model.watching.curves import Curve
from ui.model.watching.live import LiveSource
from ui.model.watching.robot_scene_builder import THINNED
from ui.model.watching.scene import RobotScene, Scene, ShownLayers
from ui.sources.bag import TICK_NS, BagSource
from ui.windows.map.points import pieces

ALL = ShownLayers(selected=0, global_costmap=True, local_costmap=True)


@pytest.fixture(scope="module")
def source(hunt: Path) -> Iterator[BagSource]:
    whole = scanned(hunt)
    yield whole
    whole.close()


def differences(one: Scene, other: Scene) -> list[str]:
    """Names of what two scenes differ in; what is compared by identity elsewhere is compared by value here."""
    found = [name for name in ("stamp_ns", "grid", "wizard") if getattr(one, name) != getattr(other, name)]
    found += ["things"] * ([t.name for t in one.things] != [t.name for t in other.things])
    found += ["rooms"] * ([(r.state, r.robot) for r in one.rooms] != [(r.state, r.robot) for r in other.rooms])
    found += ["robots"] * (len(one.robots) != len(other.robots))
    for mine, theirs in zip(one.robots, other.robots, strict=True):
        for field in fields(RobotScene):
            a, b = getattr(mine, field.name), getattr(theirs, field.name)
            same = np.array_equal(a, b, equal_nan=a.dtype.kind == "f") if isinstance(a, np.ndarray) else a == b
            found += [] if same else [f"{mine.name}: {field.name}"]
    return found


class TestSeeking:
    def test_any_moment_is_what_playing_up_to_it_gives(self, hunt: Path, source: BagSource) -> None:
        """Death, revival, a kidnapping and an obstacle among it; and to and fro, so that nothing depends on the way."""
        stamps = [source.start_ns + TICK_NS * tick for tick in (1, 2, 99, 101, 249, 260, 300, 352, 449, 455, 600, 649)]
        played: dict[int, Scene] = {}
        live = LiveSource()
        live.rooms = source.rooms
        waiting = list(stamps)
        for message in bag_reader.messages(hunt):
            while waiting and message.stamp_ns > waiting[0]:
                played[waiting.pop(0)] = live.scene(ALL)
            live.take([message], 0.0)
        for stamp in waiting:
            played[stamp] = live.scene(ALL)
        order = stamps * 2
        random.Random(1).shuffle(order)
        for stamp in order:
            assert differences(source.scene(stamp, ALL), played[stamp]) == [], stamp

    def test_before_and_after_all_is_the_first_and_the_last(self, source: BagSource) -> None:
        assert source.scene(0, ALL).stamp_ns == source.start_ns
        assert source.scene(2**62, ALL).stamp_ns == source.end_ns

    def test_steps_go_by_ticks_and_back_again(self, source: BagSource) -> None:
        at = source.start_ns + 100 * TICK_NS
        assert source.step(at, 3) == at + 3 * TICK_NS
        assert source.step(source.step(at, 7), -7) == at
        assert source.step(source.end_ns, 1) == source.end_ns
        assert source.step(source.start_ns, -1) == source.start_ns

    def test_parts_are_one(self, split: Path, hunt: Path) -> None:
        assert not split.exists()
        parts, whole = scanned(split), scanned(hunt)
        for tick in (1, 99, 101, 130, 260, 320):
            stamp = whole.start_ns + tick * TICK_NS
            assert differences(parts.scene(stamp, ALL), whole.scene(stamp, ALL)) == [], tick


class TestScene:
    def test_a_robot_that_dies_is_told_dead_and_where_it_is(self, source: BagSource) -> None:
        states = {}
        for tick in (240, 300, 470):
            robot = source.scene(source.start_ns + tick * TICK_NS, ALL).robots[1]
            states[tick] = (robot.dead, robot.truth is not None, robot.trouble)
        assert states[240][0] is False
        assert states[300] == (True, True, True)
        assert states[470][0] is False

    def test_who_is_carried_away_believes_to_be_elsewhere(self, source: BagSource) -> None:
        before, after = (source.scene(source.start_ns + tick * TICK_NS, ALL).robots[2] for tick in (348, 353))
        assert before.error is not None
        assert after.error is not None
        assert before.error < 0.3 < 1.0 < after.error

    def test_scans_end_at_walls_as_seen_from_where_robots_believe_to_be(self, source: BagSource) -> None:
        scene = source.scene(source.start_ns + 200 * TICK_NS, ALL)
        grid = scene.grid
        assert isinstance(grid, OccupancyGrid)
        points = scene.robots[0].scan
        assert len(points) > 100
        near = [_distance_to_wall(grid, x, y) for x, y in points.tolist()]
        assert np.median(near) < 0.15

    def test_clouds_of_others_are_thinned_and_the_same_every_time(self, source: BagSource) -> None:
        at = source.start_ns + 200 * TICK_NS
        scene = source.scene(at, ShownLayers(selected=1))
        assert [len(scene.robots[robot].cloud) for robot in (0, 2)] == [THINNED, THINNED]
        assert len(scene.robots[1].cloud) > THINNED
        again = source.scene(at, ShownLayers(selected=1))
        assert np.array_equal(scene.robots[0].cloud, again.robots[0].cloud)

    def test_what_is_not_wanted_is_not_there(self, source: BagSource) -> None:
        none = ShownLayers(None, clouds=False, scans=False, plans=False, paths=False)
        for robot in source.scene(source.start_ns + 200 * TICK_NS, none).robots:
            parts = (robot.cloud, robot.scan, robot.plan, robot.local_plan, robot.truth_path)
            assert [len(part) for part in parts] == [0] * len(parts)
            assert (robot.global_costmap, robot.local_costmap) == (None, None)

    def test_costmaps_are_those_of_the_selected_robot(self, source: BagSource) -> None:
        scene = source.scene(source.start_ns + 200 * TICK_NS, ShownLayers(selected=2, local_costmap=True))
        assert [robot.local_costmap is not None for robot in scene.robots] == [False, False, True]

    def test_rooms_and_things_and_goals_are_those_of_the_moment(self, source: BagSource) -> None:
        early, late = (source.scene(source.start_ns + tick * TICK_NS, ALL) for tick in (50, TICKS - 1))
        assert [thing.name for thing in early.things] == []
        assert [thing.name for thing in late.things] == ["crate"]
        assert sorted(room.robot for room in early.rooms if room.state == "reserved" and room.robot is not None) == [
            0,
            1,
            2,
        ]
        assert all(robot.goal is not None for robot in early.robots)
        assert len(early.rooms) == 8
        assert {robot.state for robot in early.robots} == {"drives"}


def _distance_to_wall(grid: OccupancyGrid, x: float, y: float) -> float:
    rows, cols = np.nonzero(grid.cells == 100)
    return float(
        np.hypot(
            grid.origin.x + (cols + 0.5) * grid.resolution - x, grid.origin.y + (rows + 0.5) * grid.resolution - y
        ).min()
    )


class TestSeries:
    def test_they_are_the_report_s_at_ten_a_second(self, hunt: Path, source: BagSource) -> None:
        report = read_report(bag_reader.messages(hunt))
        for robot, track in enumerate(report.tracks):
            series = source.series.of(robot)
            mine = series.errors.rows()
            assert len(mine) >= (100 if robot != 1 else 60)
            for rows, theirs in ((mine, track.errors), (series.estimate.rows(), track.estimate)):
                at = np.searchsorted(theirs[:, 0], rows[:, 0] - 1e-9)
                assert rows == pytest.approx(theirs[at], abs=1e-9)
            assert series.energy.rows() == pytest.approx(track.energy)
            assert series.deviations.rows() == pytest.approx(track.deviations)

    def test_they_do_not_depend_on_how_they_are_come_by(self, hunt: Path, source: BagSource) -> None:
        live = LiveSource()
        live.take(list(bag_reader.messages(hunt)), 0.0)
        for robot in range(3):
            one, other = source.series.of(robot), live.series.of(robot)
            assert one.relocations == other.relocations
            for field in fields(one):
                if isinstance(curve := getattr(one, field.name), Curve):
                    assert np.array_equal(curve.rows(), getattr(other, field.name).rows())


class TestStory:
    def test_all_that_happened_is_in_its_list(self, hunt: Path, source: BagSource) -> None:
        counts = dict.fromkeys(("/hunt/events", "/dialogue/utterances", "/inputs", "/rosout"), 0)
        for message in bag_reader.messages(hunt, counts):
            counts[message.topic] += 1
        log = source.log
        kinds = ("event", "said", "input", "log")
        assert [len(log.entries(kind)) for kind in kinds] == list(counts.values())
        assert [entry.text.split()[0] for entry in log.entries("line")] == ["%%goto"] * 3

    def test_no_trail_leads_through_walls_to_where_a_robot_was_set_down(self, source: BagSource) -> None:
        robot = source.scene(source.end_ns, ALL).robots[2]
        for path in (robot.truth_path, robot.estimate_path):
            assert np.nanmax(np.hypot(*np.diff(path, axis=0).T)) < 0.5
        assert len(pieces(robot.truth_path)) == 2

    def test_marks_are_where_it_matters(self, source: BagSource) -> None:
        marks = {entry.what: (entry.stamp_ns - source.start_ns) // TICK_NS - 1 for entry in source.log.marks()}
        assert (marks["died"], marks["revived"], marks["carried"]) == (250, 450, 350)

    def test_rooms_of_an_older_recording_have_the_names_of_its_map(self, source: BagSource, hunt: Path, tmp_path: Path):
        with BagWriter(tmp_path / "older.bag") as writer:
            for message in bag_reader.messages(hunt):
                if message.topic != names.ROOMS:
                    topic = Topic(message.topic, message.msgtype)
                    writer.write(RosMessage(topic, message.stamp_ns, message.data))
        assert scanned(tmp_path / "older.bag").log.room_names == source.log.room_names
        assert source.log.room_names.titled(2) == "room 2 (West)"


class TestForeign:
    def test_a_bag_of_another_robot_is_shown_as_far_as_it_goes(self, tmp_path: Path) -> None:
        path = tmp_path / "foreign.bag"
        write(path, Robot(odom_frame="odom", base_frame="base_footprint"))
        source = scanned(path)
        scene = source.scene((source.start_ns + source.end_ns) // 2, ALL)
        (robot,) = scene.robots
        assert source.session is None
        assert (scene.grid, scene.rooms, robot.truth, robot.error) == (None, (), None, None)
        assert robot.estimate is not None  # on its own odometry, for nobody speaks of a map
        assert len(robot.scan) > 50
        assert len(robot.odometry_path) > 5

    def test_a_robot_of_whom_only_tf_speaks_leaves_a_path(self, tmp_path: Path) -> None:
        path = tmp_path / "foreign.bag"
        write(path, Robot(odom_topic=None))
        source = scanned(path)
        (robot,) = source.scene(source.end_ns, ALL).robots
        assert len(robot.estimate_path) > 30
        assert robot.estimate is not None
        assert robot.estimate_path[-1].tolist() == pytest.approx([robot.estimate.x, robot.estimate.y], abs=0.1)

    def test_where_no_frame_of_the_laser_is_known_nothing_is_guessed(self, tmp_path: Path) -> None:
        path = tmp_path / "foreign.bag"
        write(path, Robot(tf=False))
        source = scanned(path)
        (robot,) = source.scene(source.end_ns, ALL).robots
        assert robot.estimate is not None
        assert len(robot.scan) == 0

    def test_topics_of_another_release_are_told_and_left_out(self, hunt: Path, tmp_path: Path) -> None:
        path = tmp_path / "strange.bag"
        with Writer(path) as bag:
            known = bag.add_connection("/odom", "nav_msgs/msg/Odometry", msgdef="int32 x\n", md5sum="0" * 32)
            bag.write(known, 1, b"\0\0\0\0")
        source = scanned(path)
        assert source.unreadable == ("/odom has messages of another version of nav_msgs/Odometry.",)
        assert source.scene(1, ALL).robots == ()


def test_a_torn_bag_says_what_to_do(hunt: Path, tmp_path: Path) -> None:
    torn = tmp_path / "torn.bag.active"
    torn.write_bytes(hunt.read_bytes()[: hunt.stat().st_size // 2])
    with pytest.raises(BadFile, match="thbridge bag reindex"):
        opened(torn)

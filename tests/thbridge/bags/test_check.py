"""Each fault is planted into a bag that is clean without it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.geometry import IDENTITY, Pose2
from tests.thbridge.bags.planting import (
    MAP_LINE,
    SCAN_LINE,
    START,
    STATIC_LINE,
    STEP,
    TF_LINE,
    Entry,
    Form,
    Line,
    Planted,
    clean,
    content,
    fields,
    found,
    grid,
    judged,
    odom_message,
    record,
    scan_message,
    tf,
    uint32,
    uint64,
    write,
)
from tests.thbridge.offline.foreign import transform
from tests.thbridge.ros.drive import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.adapters.bag_scan import scan
from thbridge.adapters.bag_writer import BagWriter, Recorder
from thbridge.bags.check import Judgement, Severity, Tool, judge
from thbridge.ros.publisher import Publisher
from thbridge.ros.types import plain_definition


def test_the_bag_that_faults_are_planted_in_is_clean(tmp_path: Path) -> None:
    judgement = judged(tmp_path, clean())
    assert judgement.findings == ()
    assert (judgement.messages, judgement.seconds, judgement.start_ns) == (92, 2.9, START)


def test_a_recording_of_ours_is_clean(tmp_path: Path) -> None:
    path = tmp_path / "ours.bag"
    with Recorder(BagWriter(path), Publisher(2, MOUNT, SCAN_PERIOD), SESSION, arena()) as recorder:
        for snapshot in snapshots(2, 120):
            recorder.record(snapshot, records(snapshot.tick))
    judgement = judge(scan(path))
    assert {finding.rule for finding in judgement.findings} <= {"long-array"}
    assert judgement.ok


@pytest.mark.parametrize("ros_order", [False, True])
def test_heads_are_read_in_either_order(tmp_path: Path, ros_order: bool) -> None:
    assert judged(tmp_path, clean(), ros_order=ros_order).messages == 92


def test_missing_index(tmp_path: Path) -> None:
    finding = found(judged(tmp_path, clean(), indexed=False), "no-index")
    assert finding.severity is Severity.ERROR
    assert set(finding.tools) == set(Tool)
    assert "thbridge bag reindex" in finding.remedy


def test_index_that_lacks_messages(tmp_path: Path) -> None:
    data = content(clean())
    # The count of the first chunk's first connection, in the index behind it.
    at = data.index(b"count=") + len(b"count=")
    path = tmp_path / "a.bag"
    path.write_bytes(data[:at] + bytes([data[at] - 1]) + data[at + 1 :])
    assert found(judge(scan(path)), "index-wrong").severity is Severity.ERROR


@pytest.mark.parametrize("padded_to", [4088, 4092, 4097])
def test_first_record_of_another_length(tmp_path: Path, padded_to: int) -> None:
    finding = found(judged(tmp_path, clean(), padded_to=padded_to), "header-padding")
    assert finding.tools == (Tool.ROSBAG,)
    assert str(padded_to) in finding.what


def test_chunks_out_of_order(tmp_path: Path) -> None:
    judgement = judged(tmp_path, clean(), reverse_chunks=True)
    assert "says it lasts -2.7 s where it does 2.9 s" in found(judgement, "chunk-order").what
    assert found(judgement, "chunks-overlap").tools == (Tool.FOXGLOVE,)
    assert found(judgement, "back-in-time").count > 1


def test_an_empty_chunk_at_the_end(tmp_path: Path) -> None:
    assert "-100.0 s" in found(judged(tmp_path, clean(), empty_chunk=True), "chunk-order").what


ROS_LZ4 = {"block_linked": False, "store_size": False, "content_checksum": True}


@pytest.mark.parametrize("change", [{"block_checksum": True}, {"store_size": True}, {"content_checksum": False}])
def test_lz4_that_ros_cannot_unpack(tmp_path: Path, change: dict[str, bool]) -> None:
    assert judged(tmp_path, clean(), lz4_flags=ROS_LZ4).findings == ()
    finding = found(judged(tmp_path, clean(), lz4_flags={**ROS_LZ4, **change}), "lz4-frames")
    assert Tool.ROSBAG in finding.tools
    assert Tool.FOXGLOVE not in finding.tools


def test_messages_out_of_order_within_a_chunk(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[40] = replace(planted.entries[40], ns=planted.entries[40].ns - 2 * STEP)
    finding = found(judged(tmp_path, planted), "back-in-time")
    assert (finding.count, finding.first_ns) == (1, planted.entries[40].ns)
    assert "0.200 s" in finding.what


def test_a_cut_off_file(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    path.write_bytes(content(clean())[:-100])
    assert "100 bytes" not in found(judge(scan(path)), "torn").what
    path.write_bytes(content(clean())[:20000])
    judgement = judge(scan(path))
    assert found(judgement, "torn").severity is Severity.ERROR
    assert judgement.messages > 10


def test_a_chunk_that_cannot_be_unpacked_does_not_hide_the_others(tmp_path: Path) -> None:
    data = content(clean())
    at = data.index(b"compression=none") + len(b"compression=")
    path = tmp_path / "a.bag"
    path.write_bytes(data[:at] + b"zstd" + data[at + 4 :])
    judgement = judge(scan(path))
    assert "zstd" in found(judgement, "torn").what
    assert judgement.messages > 40


def test_no_messages(tmp_path: Path) -> None:
    assert found(judged(tmp_path, Planted([])), "empty")


def test_stamp_of_zero(tmp_path: Path) -> None:
    planted = clean()
    planted.entries.insert(0, Entry(SCAN_LINE, 0, scan_message(START)))
    finding = found(judged(tmp_path, planted), "stamp-zero")
    assert (finding.topic, finding.count, finding.first_ns) == ("/scan", 1, 0)
    assert Tool.ROSBAG in finding.tools


@pytest.mark.parametrize("topic", ["/map", "/tf_static"])
@pytest.mark.parametrize("latching", ["0", None])
def test_unlatched(tmp_path: Path, topic: str, latching: str | None) -> None:
    planted = clean()
    planted.change(topic, latching=latching)
    finding = found(judged(tmp_path, planted), "unlatched")
    assert (finding.topic, finding.severity) == (topic, Severity.ERROR)
    assert Tool.RVIZ in finding.tools


def test_a_map_that_is_said_again_and_again_needs_no_latching(tmp_path: Path) -> None:
    planted = clean()
    line = replace(MAP_LINE, topic="/costmap", latching="0")
    planted.entries += [Entry(line, START + second * 1_000_000_000, grid(START)) for second in range(3, 20)]
    assert "unlatched" not in rules(judged(tmp_path, planted))


@pytest.mark.parametrize("latching", ["2", "true", "yes"])
def test_latching_that_is_neither_0_nor_1(tmp_path: Path, latching: str) -> None:
    planted = clean()
    planted.change("/odom", latching=latching)
    finding = found(judged(tmp_path, planted), "latching-word")
    assert finding.topic == "/odom"
    assert {Tool.ROSBAG, Tool.EVO} <= set(finding.tools)


def test_two_publishers_of_static_transforms(tmp_path: Path) -> None:
    planted = clean()
    other = replace(STATIC_LINE, caller="/camera")
    planted.entries.insert(2, Entry(other, START, tf(transform(START, "base_link", "camera", IDENTITY))))
    finding = found(judged(tmp_path, planted), "two-latched")
    assert (finding.topic, finding.severity) == ("/tf_static", Severity.ERROR)
    assert "/camera" in finding.what


def test_static_transforms_that_replace_each_other(tmp_path: Path) -> None:
    planted = clean()
    planted.entries.insert(2, Entry(STATIC_LINE, START, tf(transform(START, "base_link", "camera", IDENTITY))))
    assert "laser" in found(judged(tmp_path, planted), "static-partial").what


def test_publishers_that_disagree_on_the_type(tmp_path: Path) -> None:
    planted = clean()
    planted.entries.append(Entry(Line("/odom", "std_msgs/String"), START + 30 * STEP, data=b"\0\0\0\0"))
    assert found(judged(tmp_path, planted), "two-types").topic == "/odom"


def test_wrong_md5(tmp_path: Path) -> None:
    planted = clean()
    planted.change("/odom", md5="0" * 32)
    finding = found(judged(tmp_path, planted), "md5-wrong")
    assert (finding.topic, finding.severity) == ("/odom", Severity.ERROR)
    assert plain_definition("nav_msgs/Odometry").md5 in finding.what


def test_fields_of_another_release(tmp_path: Path) -> None:
    planted = clean()
    line = Line(
        "/battery", "std_msgs/String", md5="01c7df3b0e90f2ac49bbd1ecef2a6b6b", definition="string d\nstring e\n"
    )
    planted.entries.append(Entry(line, START + 30 * STEP, data=b"\0" * 8))
    judgement = judged(tmp_path, planted)
    wrong = [finding for finding in judgement.findings if finding.topic == "/battery"]
    assert {finding.rule for finding in wrong} <= {"md5-wrong", "other-release"}
    assert wrong


def test_definition_without_a_nested_type(tmp_path: Path) -> None:
    planted = clean()
    text = plain_definition("nav_msgs/Odometry").text
    planted.change("/odom", definition=text.partition("=" * 80)[0])
    finding = found(judged(tmp_path, planted), "definition-missing")
    assert finding.topic == "/odom"
    assert "geometry_msgs/PoseWithCovariance" in finding.what


def test_no_definition_at_all(tmp_path: Path) -> None:
    planted = clean()
    planted.change("/odom", definition="")
    assert found(judged(tmp_path, planted), "definition-missing").topic == "/odom"


def test_definition_that_names_a_type_twice(tmp_path: Path) -> None:
    planted = clean()
    text = plain_definition("nav_msgs/Odometry").text
    separator = "=" * 80
    planted.change("/odom", definition=text + separator + text.partition(separator)[2])
    assert "std_msgs/Header" in found(judged(tmp_path, planted), "definition-twice").what


def test_connection_without_messages(tmp_path: Path) -> None:
    line = Line("/silent", "std_msgs/String")
    assert found(judged(tmp_path, clean(), extra_lines=(line,)), "unused").topic == "/silent"


def test_headers_far_from_the_recording(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[-1] = replace(planted.entries[-1], message=scan_message(START + 30 * 1_000_000_000))
    finding = found(judged(tmp_path, planted), "header-far")
    assert (finding.topic, finding.count) == ("/scan", 1)
    assert "27.1 s after" in finding.what


def test_old_headers_of_what_is_latched_are_in_order(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[0] = replace(planted.entries[0], message=grid(START - 60 * 1_000_000_000))
    assert "header-far" not in rules(judged(tmp_path, planted))


def test_odometry_that_is_not_stamped(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [
        replace(entry, message=odom_message(0)) if entry.line.topic == "/odom" else entry for entry in planted.entries
    ]
    finding = found(judged(tmp_path, planted), "header-zero")
    assert (finding.tools, finding.count) == ((Tool.EVO,), 30)


def test_headers_that_go_back(tmp_path: Path) -> None:
    planted = clean()
    last = planted.of("/odom")[-1]
    planted.entries[planted.entries.index(last)] = replace(last, message=odom_message(START))
    assert found(judged(tmp_path, planted), "header-back").tools == (Tool.EVO,)


def test_headers_that_repeat(tmp_path: Path) -> None:
    planted = clean()
    last = planted.of("/odom")[-1]
    planted.entries[planted.entries.index(last)] = replace(last, message=odom_message(last.ns - STEP))
    finding = found(judged(tmp_path, planted), "header-repeated")
    assert (finding.severity, finding.count, finding.tools) == (Severity.WARNING, 1, (Tool.EVO,))


def test_frame_that_nothing_joins(tmp_path: Path) -> None:
    planted = clean()
    planted.drop("/tf_static")
    finding = found(judged(tmp_path, planted), "tf-missing")
    assert (finding.topic, finding.count, finding.first_ns) == ("/scan", 30, START)
    assert "'laser'" in finding.what
    assert "'map'" in finding.what
    assert set(finding.tools) == {Tool.RVIZ, Tool.FOXGLOVE}


def test_no_transforms_at_all_are_one_finding(tmp_path: Path) -> None:
    planted = clean()
    planted.drop("/tf_static")
    planted.drop("/tf")
    (finding,) = judged(tmp_path, planted).findings
    assert (finding.rule, finding.topic, finding.severity) == ("tf-missing", None, Severity.ERROR)
    assert "laser, map, odom" in finding.what


def test_one_frame_needs_no_transforms(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = planted.of("/odom")
    assert judged(tmp_path, planted).findings == ()


def test_what_is_not_shown_hangs_loose_with_a_warning(tmp_path: Path) -> None:
    planted = clean()
    line = Line("/battery", "sensor_msgs/BatteryState")
    data = b"\0" * 4 + (START // 10**9).to_bytes(4, "little") + b"\0" * 4 + b"\x03\0\0\0gps" + b"\0" * 48
    planted.entries.append(Entry(line, START + 30 * STEP, data=data))
    assert found(judged(tmp_path, planted), "tf-missing").severity is Severity.WARNING


def test_everybody_latches_the_log(tmp_path: Path) -> None:
    planted = clean()
    text = "string msg\n"
    for caller in ("/amcl", "/move_base"):
        line = Line("/rosout", "rosgraph_msgs/Log", "1", caller, definition=text)
        planted.entries.append(Entry(line, START + 30 * STEP, data=b"\0\0\0\0"))
    assert "two-latched" not in rules(judged(tmp_path, planted))


def test_tree_in_two_pieces(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [
        replace(entry, message=tf(transform(entry.ns, "odom", "base_link", IDENTITY)))
        if entry.line.topic == "/tf"
        else entry
        for entry in planted.entries
    ]
    missing = [finding for finding in judged(tmp_path, planted).findings if finding.rule == "tf-missing"]
    assert {finding.topic for finding in missing} == {"/odom", "/scan"}


def test_transforms_that_come_late(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [e for e in planted.entries if e.line.topic != "/tf" or e.ns >= START + 15 * STEP]
    finding = found(judged(tmp_path, planted), "tf-late")
    assert finding.severity is Severity.WARNING
    assert "1.500 s" in finding.what


def test_slashed_frames(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[-1] = replace(planted.entries[-1], message=scan_message(START + 29 * STEP, "/laser"))
    judgement = judged(tmp_path, planted)
    finding = found(judgement, "frame-slash")
    assert (finding.topic, finding.severity, finding.tools) == ("/scan", Severity.ERROR, (Tool.RVIZ,))
    assert "tf-missing" not in rules(judgement)


def test_slashes_in_transforms_hurt_less(tmp_path: Path) -> None:
    judgement = judged(tmp_path, extra_tf(clean(), transform(START, "/map", "/box", IDENTITY)))
    assert {finding.severity for finding in judgement.findings} == {Severity.WARNING}
    assert {finding.rule for finding in judgement.findings} == {"frame-slash"}


def test_frame_that_is_not_named(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[-1] = replace(planted.entries[-1], message=scan_message(START + 29 * STEP, ""))
    assert found(judged(tmp_path, planted), "frame-empty").topic == "/scan"


def extra_tf(planted: Planted, *transforms: object) -> Planted:
    for index in range(30):
        planted.entries.append(Entry(TF_LINE, START + 30 * STEP + index, tf(*transforms)))
    return planted


def test_frame_with_two_parents(tmp_path: Path) -> None:
    both = (transform(START, "map", "box", IDENTITY), transform(START, "odom", "box", IDENTITY))
    finding = found(judged(tmp_path, extra_tf(clean(), *both)), "tf-two-parents")
    assert finding.severity is Severity.ERROR
    assert "'box'" in finding.what


def test_loop_of_transforms(tmp_path: Path) -> None:
    judgement = judged(tmp_path, extra_tf(clean(), transform(START, "base_link", "map", IDENTITY)))
    assert "base_link -> odom -> map -> base_link" in found(judgement, "tf-loop").what


@pytest.mark.parametrize(("parent", "child"), [("", "box"), ("map", ""), ("box", "box")])
def test_transform_without_two_names(tmp_path: Path, parent: str, child: str) -> None:
    assert found(judged(tmp_path, extra_tf(clean(), transform(START, parent, child, IDENTITY))), "tf-names")


@pytest.mark.parametrize(
    ("quaternion", "fault"),
    [((0, 0, 0, 0), "all zero"), ((0, 0, 0, 2), "not of length one"), ((0, 0, 0, float("nan")), "not finite")],
)
@pytest.mark.parametrize("topic", ["/odom", "/tf"])
def test_quaternions(tmp_path: Path, topic: str, quaternion: tuple[float, ...], fault: str) -> None:
    planted = clean()
    message = planted.of(topic)[-1].message
    rotation = message.pose.pose.orientation if topic == "/odom" else message.transforms[0].transform.rotation  # type: ignore[attr-defined]
    rotation.x, rotation.y, rotation.z, rotation.w = map(float, quaternion)
    finding = found(judged(tmp_path, planted), "quaternion")
    forgiven = topic == "/odom" and fault == "all zero"
    severity = Severity.WARNING if forgiven else Severity.ERROR
    assert (finding.topic, finding.count, finding.severity) == (topic, 1, severity)
    assert (Tool.RVIZ in finding.tools) is not forgiven
    assert fault in finding.what


def test_a_bad_quaternion_in_an_array(tmp_path: Path) -> None:
    planted = clean()
    count = 50
    poses = np.zeros((count, 7))
    poses[:, 6] = 1.0
    poses[33, 6] = 0.5
    head = b"\0" * 4 + (START // 10**9).to_bytes(4, "little") + b"\0" * 4 + b"\x03\0\0\0map"
    line = Line("/particlecloud", "geometry_msgs/PoseArray")
    planted.entries.append(
        Entry(line, START + 30 * STEP, data=head + count.to_bytes(4, "little") + poses.astype("<f8").tobytes())
    )
    assert found(judged(tmp_path, planted), "quaternion").topic == "/particlecloud"


def test_place_that_is_not_a_number(tmp_path: Path) -> None:
    planted = clean()
    planted.of("/odom")[-1].message.pose.pose.position.x = float("inf")  # type: ignore[attr-defined]
    assert found(judged(tmp_path, planted), "not-finite").topic == "/odom"


def test_odometry_without_covariance(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = [
        replace(entry, message=odom_message(entry.ns, sure=True)) if entry.line.topic == "/odom" else entry
        for entry in planted.entries
    ]
    finding = found(judged(tmp_path, planted), "covariance-zero")
    assert (finding.topic, finding.count) == ("/odom", 30)


def test_one_message_with_covariance_is_enough(tmp_path: Path) -> None:
    planted = clean()
    first = planted.of("/odom")[0]
    planted.entries[planted.entries.index(first)] = replace(first, message=odom_message(first.ns, sure=True))
    assert "covariance-zero" not in rules(judged(tmp_path, planted))


@pytest.mark.parametrize(("ranges", "intensities"), [(80, 0), (100, 0), (91, 90)])
def test_scan_whose_arrays_do_not_match(tmp_path: Path, ranges: int, intensities: int) -> None:
    planted = clean()
    message = scan_message(START + 29 * STEP, ranges=ranges, intensities=intensities)
    planted.entries[-1] = replace(planted.entries[-1], message=message)
    assert found(judged(tmp_path, planted), "length-wrong").topic == "/scan"


def test_map_with_too_few_cells(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[0] = replace(planted.entries[0], message=grid(START, cells=11))
    assert found(judged(tmp_path, planted), "length-wrong").topic == "/map"


def test_arrays_too_long_to_plot(tmp_path: Path) -> None:
    planted = clean()
    planted.entries[0] = replace(planted.entries[0], message=grid(START, 40, 30, 1200))
    finding = found(judged(tmp_path, planted), "long-array")
    assert (finding.severity, finding.tools) == (Severity.NOTE, (Tool.PLOTJUGGLER,))


@pytest.mark.parametrize("change", [lambda data: data[:-3], lambda data: data + b"\0\0", lambda data: b""])
def test_data_that_do_not_fit_the_definition(tmp_path: Path, change: object) -> None:
    planted = clean()
    last = planted.entries[-1]
    planted.entries[-1] = Entry(last.line, last.ns, data=change(last.bytes()))  # type: ignore[operator]
    finding = found(judged(tmp_path, planted), "data-wrong")
    assert (finding.topic, finding.count, finding.first_ns) == ("/scan", 1, last.ns)
    assert set(finding.tools) == set(Tool) - {Tool.EVO}, "evo does not read scans"


def test_nothing_for_evo(tmp_path: Path) -> None:
    planted = clean()
    planted.entries = planted.of("/scan")
    finding = found(judged(tmp_path, planted), "no-trajectory")
    assert (finding.severity, finding.tools) == (Severity.NOTE, (Tool.EVO,))


def test_messages_of_no_connection(tmp_path: Path) -> None:
    data = content(clean())
    # The number of the connection of the first message of /scan, of which there are more in this chunk.
    at = data.rindex(b"conn=", 0, data.index(b"laser", data.index(b"/scan"))) + len(b"conn=")
    path = tmp_path / "a.bag"
    path.write_bytes(data[:at] + b"\x63" + data[at + 1 :])
    finding = found(judge(scan(path)), "unknown-source")
    assert (finding.severity, finding.count) == (Severity.ERROR, 1)


def test_an_encrypted_bag(tmp_path: Path) -> None:
    data = content(clean())
    head = fields(op=b"\x03", index_pos=uint64(0), conn_count=uint32(0), chunk_count=uint32(0), encryptor=b"rosbag/Aes")
    path = tmp_path / "a.bag"
    path.write_bytes(data[:13] + record(head, b" " * (4096 - len(head))) + data[13 + 4104 :])
    assert Tool.FOXGLOVE in found(judge(scan(path)), "encrypted").tools


def test_verdict_of_each_tool(tmp_path: Path) -> None:
    planted = clean()
    planted.drop("/tf_static")
    judgement = judged(tmp_path, planted)
    assert judgement.worst(Tool.RVIZ) is Severity.ERROR
    assert judgement.worst(Tool.ROSBAG) is None
    assert not judgement.ok


def rules(judgement: Judgement) -> set[str]:
    return {finding.rule for finding in judgement.findings}


CLEAN = content(clean(), Form(chunk_bytes=20000))


@given(
    st.lists(st.tuples(st.integers(13, len(CLEAN) - 1), st.binary(min_size=1, max_size=6)), min_size=1, max_size=8),
    st.integers(1, len(CLEAN)),
)
@settings(max_examples=80, deadline=None)
def test_damage_never_ends_in_a_traceback(
    tmp_path_factory: pytest.TempPathFactory, cuts: list[tuple[int, bytes]], keep: int
) -> None:
    data = bytearray(CLEAN)
    for at, change in cuts:
        data[at : at + len(change)] = change
    path = tmp_path_factory.getbasetemp() / "damaged.bag"
    path.write_bytes(bytes(data[: max(keep, 13)]))
    judge(scan(path))


def test_another_branch_of_the_tree_is_fine(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", extra_tf(clean(), transform(START, "map", "box", Pose2(1.0, 2.0, 0.5))))
    assert judge(scan(path)).ok

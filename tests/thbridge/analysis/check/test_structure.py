"""Each fault is planted into a bag that is clean without it: rules of `structure`."""

from pathlib import Path

import pytest

from tests.support.bags.bags_with_faults import Planted, clean, content, fields, found, judged, record, uint32, uint64
from thbridge.analysis.check import BagTool, FindingSeverity, judge
from thbridge.recording.bag.reading.scan import scan


def test_missing_index(tmp_path: Path) -> None:
    finding = found(judged(tmp_path, clean(), indexed=False), "no-index")
    assert finding.severity is FindingSeverity.ERROR
    assert set(finding.tools) == set(BagTool)
    assert "thbridge bag reindex" in finding.remedy


def test_index_that_lacks_messages(tmp_path: Path) -> None:
    data = content(clean())
    # The count of the first chunk's first connection, in the index behind it.
    at = data.index(b"count=") + len(b"count=")
    path = tmp_path / "a.bag"
    path.write_bytes(data[:at] + bytes([data[at] - 1]) + data[at + 1 :])
    assert found(judge(scan(path)), "index-wrong").severity is FindingSeverity.ERROR


@pytest.mark.parametrize("padded_to", [4088, 4092, 4097])
def test_first_record_of_another_length(tmp_path: Path, padded_to: int) -> None:
    finding = found(judged(tmp_path, clean(), padded_to=padded_to), "header-padding")
    assert finding.tools == (BagTool.ROSBAG,)
    assert str(padded_to) in finding.what


def test_chunks_out_of_order(tmp_path: Path) -> None:
    judgement = judged(tmp_path, clean(), reverse_chunks=True)
    finding = found(judgement, "chunk-order")
    assert (finding.severity, finding.tools) == (FindingSeverity.ERROR, (BagTool.ROSBAG, BagTool.FOXGLOVE))
    assert "reports -2.7 s instead of 2.9 s, and Foxglove omits all messages before 2.9 s" in finding.what
    assert found(judgement, "chunks-overlap").tools == (BagTool.FOXGLOVE,)
    assert found(judgement, "back-in-time").count > 1


def test_an_empty_chunk_at_the_end(tmp_path: Path) -> None:
    finding = found(judged(tmp_path, clean(), empty_chunk=True), "chunk-order")
    assert "-100.0 s" in finding.what
    assert (finding.severity, finding.tools) == (FindingSeverity.WARNING, (BagTool.ROSBAG,))


ROS_LZ4 = {"block_linked": False, "store_size": False, "content_checksum": True}


@pytest.mark.parametrize("change", [{"block_checksum": True}, {"store_size": True}, {"content_checksum": False}])
def test_lz4_that_ros_cannot_unpack(tmp_path: Path, change: dict[str, bool]) -> None:
    assert judged(tmp_path, clean(), lz4_flags=ROS_LZ4).findings == ()
    finding = found(judged(tmp_path, clean(), lz4_flags={**ROS_LZ4, **change}), "lz4-frames")
    assert BagTool.ROSBAG in finding.tools
    assert BagTool.FOXGLOVE not in finding.tools


def test_a_cut_off_file(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    path.write_bytes(content(clean())[:-100])
    assert "100 bytes" not in found(judge(scan(path)), "torn").what
    path.write_bytes(content(clean())[:20000])
    judgement = judge(scan(path))
    assert found(judgement, "torn").severity is FindingSeverity.ERROR
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


def test_an_encrypted_bag(tmp_path: Path) -> None:
    data = content(clean())
    head = fields(op=b"\x03", index_pos=uint64(0), conn_count=uint32(0), chunk_count=uint32(0), encryptor=b"rosbag/Aes")
    path = tmp_path / "a.bag"
    path.write_bytes(data[:13] + record(head, b" " * (4096 - len(head))) + data[13 + 4104 :])
    assert BagTool.FOXGLOVE in found(judge(scan(path)), "encrypted").tools

"""The file of a telemetry log."""

import resource

import pytest
from pymavlink import mavutil

from thbridge.files.errors import BadFile
from thbridge.mavlink.files.tlog import TlogFile
from thbridge.mavlink.wire.dialect import mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.traffic import Traffic
from thbridge.ros.messages.stamps import stamp_ns

HEARTBEAT = Frame(1, 1, 0, 0, payload_of(mav.MAVLink_heartbeat_message(10, 0, 1, 0, 4, 3)), 50)
SAID = [Traffic(0, False, "a", HEARTBEAT)]
RECORD = 8 + HEARTBEAT.size


def test_pymavlink_reads_the_frames_with_the_stamps_of_the_bag(tmp_path):
    path = tmp_path / "run.tlog"
    with TlogFile(path) as log:
        for tick in range(3):
            log.record(stamp_ns(tick), SAID)
    reader = mavutil.mavlogfile(str(path))
    messages = [reader.recv_msg() for _ in range(3)]
    assert [message.get_type() for message in messages] == ["HEARTBEAT"] * 3
    assert [message._timestamp for message in messages] == pytest.approx([1.0, 1.02, 1.04])
    assert reader.recv_msg() is None
    reader.close()


def test_each_tick_is_in_the_file_at_once(tmp_path):
    path = tmp_path / "run.tlog"
    with TlogFile(path) as log:
        log.record(stamp_ns(0), SAID)
        assert path.stat().st_size == RECORD


def test_a_full_disk_is_told_and_leaves_whole_records(tmp_path):
    path = tmp_path / "run.tlog"
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    with TlogFile(path) as log:
        resource.setrlimit(resource.RLIMIT_FSIZE, (RECORD * 2 + 5, hard))
        try:
            log.record(stamp_ns(0), SAID)
            with pytest.raises(BadFile, match=r"run\.tlog: the telemetry log cannot be written \(File too large"):
                log.record(stamp_ns(1), SAID * 3)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert path.stat().st_size == RECORD


def test_a_log_is_never_written_over(tmp_path):
    path = tmp_path / "run.tlog"
    path.write_bytes(b"old")
    with pytest.raises(BadFile, match="this file already exists"):
        TlogFile(path)
    assert path.read_bytes() == b"old"


def test_a_folder_that_is_not_there_is_told(tmp_path):
    with pytest.raises(BadFile, match="Name a folder that exists"):
        TlogFile(tmp_path / "none" / "run.tlog")

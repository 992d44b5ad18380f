from pathlib import Path

import pytest
from mcap.reader import make_reader

from tests.support.bags.bags_with_faults import STATIC_LINE, clean, write
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, snapshots
from thbridge.analysis.to_mcap import COMPRESSIONS, to_mcap
from thbridge.app.session.broadcast import Broadcast
from thbridge.files.errors import BadFile
from thbridge.recording.bag.reading.reader import recorded
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.messages.types import plain_definition
from thbridge.ros.publisher import TeamPublisher


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    return write(tmp_path / "a.bag", clean())


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_every_message_is_there_byte_for_byte(tmp_path: Path, bag: Path, compression: str) -> None:
    done = to_mcap(bag, tmp_path / "a.mcap", compression)
    with done.path.open("rb") as file:
        reader = make_reader(file)
        told = [
            (channel.topic, message.log_time, message.publish_time, message.data)
            for _, channel, message in reader.iter_messages(log_time_order=False)
        ]
        summary = reader.get_summary()
    assert told == [(publisher.topic, stamp, stamp, data) for publisher, stamp, data in recorded(bag)]
    assert summary is not None
    expected = "" if compression == "none" else compression
    assert {chunk.compression for chunk in summary.chunk_indexes} == {expected}
    assert (done.messages, done.channels, done.session) == (92, 5, False)


def test_the_conventions_of_ros_1(tmp_path: Path, bag: Path) -> None:
    done = to_mcap(bag, tmp_path / "a.mcap")
    with done.path.open("rb") as file:
        reader = make_reader(file)
        assert reader.get_header().profile == "ros1"
        summary = reader.get_summary()
    assert summary is not None
    (channel,) = [channel for channel in summary.channels.values() if channel.topic == "/tf_static"]
    schema = summary.schemas[channel.schema_id]
    plain = plain_definition(STATIC_LINE.msgtype)
    assert channel.message_encoding == "ros1"
    assert channel.metadata == {"callerid": "/robot", "latching": "true", "md5sum": plain.md5}
    assert (schema.name, schema.encoding, schema.data.decode()) == ("tf2_msgs/TFMessage", "ros1msg", plain.text)


def test_a_session_of_ours_can_be_found(tmp_path: Path) -> None:
    path = tmp_path / "ours.bag"
    with BagWriter(path) as writer:
        recorder = Broadcast(TeamPublisher(1, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
        for snapshot in snapshots(1, 10):
            recorder.record(snapshot)
    done = to_mcap(path, tmp_path / "ours.mcap")
    assert done.session
    with done.path.open("rb") as file:
        reader = make_reader(file)
        (attachment,) = reader.iter_attachments()
        (metadata,) = reader.iter_metadata()
    assert (attachment.name, attachment.data.decode()) == ("study.yaml", SESSION.study)
    assert metadata.name == "thbridge:session"
    assert metadata.metadata == {"seed": str(SESSION.seed), **SESSION.versions}


def test_nothing_is_overwritten_unasked(tmp_path: Path, bag: Path) -> None:
    (tmp_path / "a.mcap").write_text("mine")
    with pytest.raises(BadFile, match="--overwrite"):
        to_mcap(bag, tmp_path / "a.mcap")

import dataclasses
from hashlib import sha256
from pathlib import Path

import pytest

from tests.support.bags.small_bags import CHATTER, HELLO, write_four_messages
from thbridge.recording.bag.options import Compression, SplitLimits
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.recording.digest import MessageDigest, digest_of
from thbridge.ros import names
from thbridge.ros.messages import pack
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.ros.messages.types import SESSION, STRING
from thbridge.ros.publisher import RosMessage, Topic

NEWS = Topic("/news", STRING, latched=True)
FIRST = Topic(names.SESSION, SESSION, latched=True)
RECORD = SessionRecord("", 1, {"processor": "one"}, "play", (), "")
SAID = [RosMessage(NEWS, 1, HELLO), *(RosMessage(CHATTER, 2_000_000_000 * each, HELLO) for each in range(1, 4))]


def digest_of_messages(said: list[RosMessage]) -> str:
    digest = MessageDigest()
    for message in said:
        digest.add(message.topic.name, message.topic.msgtype, message.stamp_ns, message.data)
    return digest.hexdigest()


def test_it_is_the_sum_that_the_docs_define(tmp_path: Path) -> None:
    def sized(data: bytes) -> bytes:
        return len(data).to_bytes(8, "little") + data

    parts = [
        sized(message.topic.encode())
        + sized(message.msgtype.encode())
        + message.stamp_ns.to_bytes(8, "little")
        + sized(message.data)
        for message in messages(write_four_messages(tmp_path / "a.bag"))
    ]
    assert len(parts) == 4
    assert digest_of(tmp_path / "a.bag") == sha256(b"".join(parts)).hexdigest()


def test_machine_packing_and_parts_make_no_difference(tmp_path: Path) -> None:
    other = dataclasses.replace(RECORD, versions={"processor": "other"})
    with BagWriter(tmp_path / "one.bag") as one:
        one.take(0, [RosMessage(FIRST, 1, pack.session(0, RECORD)), *SAID])
    limits = SplitLimits(duration_ns=1_000_000_000)
    with BagWriter(tmp_path / "other.bag", compression=Compression.BZ2, splitting=limits) as writer:
        writer.take(0, [RosMessage(FIRST, 1, pack.session(0, other)), *SAID])
    assert (tmp_path / "other_1.bag").exists()
    assert digest_of(tmp_path / "one.bag") == digest_of(tmp_path / "other.bag") == digest_of_messages(SAID)


@pytest.mark.parametrize(
    "changed",
    [
        RosMessage(Topic("/news2", STRING), 1, HELLO),
        RosMessage(Topic("/news", "std_msgs/Other"), 1, HELLO),
        RosMessage(NEWS, 2, HELLO),
        RosMessage(NEWS, 1, HELLO + b"!"),
    ],
    ids=["topic", "type", "time", "bytes"],
)
def test_it_tells_any_change(changed: RosMessage) -> None:
    assert digest_of_messages([changed, *SAID[1:]]) != digest_of_messages(SAID)


def test_it_tells_the_order() -> None:
    assert digest_of_messages(SAID[::-1]) != digest_of_messages(SAID)

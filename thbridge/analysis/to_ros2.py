"""Conversion of a recording to a folder of rosbag2, as if the session had been recorded there."""

import shutil
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.synced import make_folder
from thbridge.files.errors import BadFile, reason_of
from thbridge.recording.bag.mcap_records import MOST_CHANNELS
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reading.reader import recorded
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.rosbag2_metadata import write_metadata
from thbridge.recording.bag.writing.bag_file import BagFile
from thbridge.recording.bag.writing.formats import MCAP_FILE
from thbridge.recording.recordings import MCAP
from thbridge.ros2.message_copies import MessageCopy
from thbridge.ros2.recorded_types import recorded_type


@dataclass(frozen=True, slots=True)
class Ros2Result:
    """Result of a conversion.

    Attributes:
        path: folder that was written.
        messages: number of messages.
        left_out: topics that could not be converted.
        broken: number of omitted messages of other topics. These messages do not match the definition of their topic.
    """

    path: Path
    messages: int
    left_out: tuple[str, ...]
    broken: int = 0


def to_ros2(bag: Path, out: Path, compression: Compression = Compression.ZSTD) -> Ros2Result:
    """Write a recording as a folder of rosbag2.

    Args:
        bag: recording, or name of a split recording.
        out: new folder.
        compression: compression of the chunks; `Compression.BZ2` is not possible.

    Raises:
        BadFile: the bag cannot be read, or the folder exists or cannot be written.
    """
    if out.exists():
        raise BadFile(out, "this folder already exists", "choose another folder with --to, or remove this one")
    part = out.with_name(out.name + ".part")
    try:
        shutil.rmtree(part, ignore_errors=True)
        make_folder(out.absolute().parent)
        part.mkdir()
        messages, left_out, broken = _write(bag, part / f"{out.name}_0{MCAP}", compression)
        write_metadata(part)
        part.rename(out)
    except OSError as error:
        problem = f"it cannot be written ({reason_of(error)})"
        raise BadFile(out, problem, "choose another path with --to, or free disk space") from error
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return Ros2Result(out, messages, left_out, broken)


def _write(bag: Path, file: Path, compression: Compression) -> tuple[int, tuple[str, ...], int]:
    """Write the file; return the number of messages, the omitted topics, and the number of other omitted messages."""
    target = BagFile(file, compression, MCAP_FILE)
    conversions: dict[BagConnection, tuple[BagConnection, MessageCopy] | None] = {}
    messages, broken, left_out = 0, 0, set[str]()
    for publisher, stamp_ns, data in recorded(bag):
        if publisher not in conversions:
            if len(conversions) == MOST_CHANNELS:
                problem = f"it has more than {MOST_CHANNELS} publishers, the limit of an MCAP file"
                raise BadFile(
                    bag, problem, "copy some of its topics with `thbridge bag cut --topics`, and convert those"
                )
            conversions[publisher] = _conversion(publisher, target)
        conversion = conversions[publisher]
        if conversion is None:
            left_out.add(publisher.topic)
            continue
        connection, to_cdr = conversion
        try:
            converted = to_cdr(data)
        except ValueError:
            broken += 1
            continue
        target.write(connection, stamp_ns, converted)
        messages += 1
    target.close()
    return messages, tuple(sorted(left_out)), broken


def _conversion(publisher: BagConnection, target: BagFile) -> tuple[BagConnection, MessageCopy] | None:
    """Return a publisher's connection in the new file, and the conversion of its messages; None if there is none."""
    try:
        theirs = recorded_type(publisher.msgtype, publisher.definition)
    except ValueError:
        return None
    connection = target.connect(
        publisher.topic, theirs.name, theirs.hash, theirs.definition, publisher.caller, publisher.latching
    )
    return connection, theirs.from_ros1

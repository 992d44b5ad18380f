"""Conversion of a recording to rosbag2: a folder with an MCAP file of CDR messages, and its metadata.

Source: rosbag2's metadata.yaml, version 9; mcap.dev, the profile `ros2`. Messages get the types of ROS 2 Jazzy if these
exist, otherwise the types that the bag defines. Fields that exist only in ROS 2 are 0; fields that exist only in ROS 1
are omitted.
"""

import io
import shutil
import struct
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path

from rosbags.convert.converter import generate_message_converter
from rosbags.interfaces import (
    Connection,
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer, WriterError
from rosbags.serde.errors import SerdeError
from rosbags.typesys import Stores, TypesysError, get_typestore
from rosbags.typesys.msg import normalize_msgtype

from thbridge.analysis.to_mcap import METADATA, STUDY
from thbridge.files.disk.synced import make_folder
from thbridge.files.errors import BadFile, reason_of
from thbridge.recording.bag.reading.reader import recorded
from thbridge.recording.bag.records import BagConnection
from thbridge.ros.messages import unpack
from thbridge.ros.messages.foreign_types import register, store_of, types_in
from thbridge.ros.messages.types import SESSION

_FOREVER = QosTime(2147483647, 4294967295)


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


def to_ros2(bag: Path, out: Path, packed: bool = True) -> Ros2Result:
    """Write a recording as a rosbag2 folder.

    For sessions of thbridge, the metadata's custom data contain the study, the seed and the versions.

    Args:
        bag: recording, or name of a split recording.
        out: new folder.
        packed: True to compress the file with zstd.

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
        result = _write(bag, part / out.name, packed)
        (part / out.name).rename(out)
    except OSError as error:
        problem = f"it cannot be written ({reason_of(error)})"
        raise BadFile(out, problem, "choose another path with --to, or free disk space") from error
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return Ros2Result(out, *result)


def _write(bag: Path, folder: Path, packed: bool) -> tuple[int, tuple[str, ...], int]:
    """Write the folder; return the number of messages, the omitted topics, and the number of other omitted messages."""
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    if packed:
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    messages, broken, left_out = 0, 0, set[str]()
    with writer:
        conversion = _Conversion(writer)
        for publisher, stamp_ns, data in recorded(bag):
            way = conversion.way_of(publisher)
            if way is None:
                left_out.add(publisher.topic)
                continue
            connection, convert = way
            try:
                converted = convert(data)
            except (SerdeError, ValueError, LookupError, MemoryError, struct.error):
                broken += 1
                continue
            writer.write(connection, stamp_ns, converted)
            messages += 1
            if publisher.msgtype == SESSION:
                _keep_session(writer, data)
    return messages, tuple(sorted(left_out)), broken


class _Conversion:
    """Connections and converters of a folder that is being written."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self._theirs = get_typestore(Stores.ROS2_JAZZY)
        self._ways: dict[BagConnection, tuple[Connection, Callable[[bytes], memoryview]] | None] = {}
        self._connections: dict[tuple[str, str, bool], Connection] = {}

    def way_of(self, publisher: BagConnection) -> tuple[Connection, Callable[[bytes], memoryview]] | None:
        """Return a publisher's connection and the function that converts its messages; None if there is none."""
        if publisher not in self._ways:
            try:
                self._ways[publisher] = self._way(publisher)
            except (TypesysError, WriterError, LookupError, ValueError, AttributeError):
                self._ways[publisher] = None
        return self._ways[publisher]

    def _way(self, publisher: BagConnection) -> tuple[Connection, Callable[[bytes], memoryview]]:
        source = normalize_msgtype(publisher.msgtype)
        target = "tf2_msgs/msg/TFMessage" if source == "tf/msg/tfMessage" else source
        ours = store_of(types_in(publisher.msgtype, publisher.definition))
        if target not in self._theirs.fielddefs:
            fields = ours.fielddefs.items()
            register(self._theirs, {name: own for name, own in fields if name not in self._theirs.fielddefs})
        with redirect_stdout(io.StringIO()):  # the converter prints what it does
            convert = generate_message_converter(ours, self._theirs, source, target, {}, src_is2=False, dst_is2=True)
        key = publisher.topic, target, publisher.latching is True
        if key not in self._connections:
            profiles = [_latched()] if publisher.latching else []
            self._connections[key] = self._writer.add_connection(
                publisher.topic, target, typestore=self._theirs, offered_qos_profiles=profiles
            )
        return self._connections[key], convert


def _latched() -> Qos:
    """Return the quality of service of publishers whose last message is also sent to later subscribers."""
    return Qos(
        QosHistory.KEEP_LAST,
        1,
        QosReliability.RELIABLE,
        QosDurability.TRANSIENT_LOCAL,
        _FOREVER,
        _FOREVER,
        QosLiveliness.AUTOMATIC,
        _FOREVER,
        avoid_ros_namespace_conventions=False,
    )


def _keep_session(writer: Writer, data: bytes) -> None:
    try:
        session = unpack.session(data)
    except ValueError:
        return  # recorded by a version with other fields; the message itself is kept
    writer.set_custom_data(STUDY, session.study)
    for name, value in {"seed": str(session.seed), **session.versions}.items():
        writer.set_custom_data(f"{METADATA}:{name}", value)

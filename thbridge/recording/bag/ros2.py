"""ROS 2 recordings and MCAP files, converted to ROS 1 bags for reading.

A recording is converted when it is read, into a temporary folder. The bags of the last recordings are kept. So readers
of bags need only one format. Messages get the types of ROS Noetic: fields that only ROS 2 has are left out, fields that
only ROS 1 has are 0. Publishers with durability "transient local" become latched publishers.
"""

import errno
import io
import shutil
import tempfile
import weakref
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path

from mcap.reader import make_reader
from mcap.well_known import MessageEncoding, SchemaEncoding
from rosbags.convert.converter import generate_message_converter
from rosbags.interfaces import QosDurability
from rosbags.typesys import Stores, TypesysError, get_typestore
from rosbags.typesys.store import Typestore

from thbridge.files.errors import BadFile, reason_of
from thbridge.recording.bag.damage import TooLargeChunk
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.ros2_storage import (
    bounded_sqlite,
    open_reader,
    plain_recording,
    size_of,
    stored_messages,
)
from thbridge.recording.bag.unpacking import MCAP_MAGIC, UnpackedBytes
from thbridge.recording.bag.writing.bag_file import BagFile
from thbridge.recording.recordings import MCAP, METADATA, parts_of
from thbridge.ros.messages.foreign_types import register, types_in
from thbridge.ros.messages.types import md5_of, typestore
from thbridge.ros2.message_copies import CDR_HEAD, MessageCopy
from thbridge.ros2.recorded_types import ros1_name

SQLITE = ".db3"
_DISK_FAULTS = {errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.EFBIG}


@dataclass(frozen=True, slots=True, weakref_slot=True)
class ConvertedRecording:
    """The ROS 1 bag of a converted recording. The file is removed with this object; files that are open stay readable.

    Attributes:
        path: path of the bag.
        kind: kind of the original, as a phrase: "a ROS 2 recording".
        left_out: topics that could not be converted, with the reasons.
        is_cdr: True if messages of the original are CDR.
    """

    path: Path
    kind: str
    left_out: Mapping[str, str]
    is_cdr: bool


def is_other_recording(path: Path) -> bool:
    """Return True for a folder of rosbag2, and for a file in one of rosbag2's formats, MCAP and SQLite."""
    return (path / METADATA).is_file() if path.is_dir() else path.suffix in {MCAP, SQLITE} and path.is_file()


def as_ros1(path: Path, unchanged: bool = False) -> Path:
    """Return the path of this recording as a ROS 1 bag. Convert recordings of ROS 2 and MCAP files; return other paths.

    Args:
        path: the recording.
        unchanged: True to keep messages in CDR as they are, although no other reader of bags can decode them.

    Raises:
        BadFile: the recording cannot be read or converted.
    """
    return converted(path, unchanged).path if is_other_recording(path) else path


def has_cdr(path: Path) -> bool:
    """Return True if the messages of a recording, or of its first file, are CDR. Raises BadFile, like `converted`."""
    first = parts_of(path)[0]
    return is_other_recording(first) and converted(first, unchanged=True).is_cdr


def converted(path: Path, unchanged: bool = False) -> ConvertedRecording:
    """Return the converted bag of a ROS 2 recording or an MCAP file; see `as_ros1` for the arguments.

    Raises:
        BadFile: the recording cannot be read or converted.
    """
    found = path.stat()
    return _converted(path.resolve(), unchanged, found.st_mtime_ns, found.st_size)


@lru_cache(maxsize=4)
def _converted(path: Path, unchanged: bool, _mtime_ns: int, _size: int) -> ConvertedRecording:
    bag = _folder() / f"{path.stem}.bag"
    bag.unlink(missing_ok=True)
    try:
        with plain_recording(path, bag.parent) as plain:
            if _is_ros1_mcap(plain):
                _repack(plain, bag)
                return _removed_at_end(ConvertedRecording(bag, "an MCAP file of ROS 1", {}, is_cdr=False))
            with bounded_sqlite(plain):
                left_out = _convert(plain, bag, unchanged)
    except BadFile:
        bag.unlink(missing_ok=True)
        raise
    except TooLargeChunk as error:
        bag.unlink(missing_ok=True)
        raise BadFile(path, str(error), "the recording is forged or damaged; name another recording") from error
    except Exception as error:  # For damaged bytes, rosbags and its parsers raise many kinds of errors.
        bag.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.errno in _DISK_FAULTS:
            remedy = "free space in the folder of temporary files (TMPDIR)"
            problem = f"there is no space for the converted bag ({reason_of(error)})"
            raise BadFile(path, problem, remedy) from error
        remedy = "try `thbridge bag reindex`, `ros2 bag reindex` or `mcap recover`, or name another recording"
        raise BadFile(path, f"it cannot be read: {_sentence(error)}", remedy) from error
    return _removed_at_end(ConvertedRecording(bag, "a ROS 2 recording", left_out, is_cdr=True))


def _removed_at_end(found: ConvertedRecording) -> ConvertedRecording:
    """Return the converted recording, whose file is removed with it: a study has many recordings."""
    removal = weakref.finalize(found, shutil.rmtree, found.path.parent, ignore_errors=True)
    removal.atexit = False  # At the end of the process, the whole folder is removed.
    return found


@lru_cache(maxsize=1)
def _kept() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="thbridge-ros2-")


def _folder() -> Path:
    """Return a new folder, inside a folder that is removed when the process ends."""
    return Path(tempfile.mkdtemp(dir=_kept().name))


def _sentence(error: Exception) -> str:
    """Return the first line of an error's text, or its type if it has no text."""
    return (str(error).splitlines() or [""])[0].rstrip(".") or type(error).__name__


def _is_ros1_mcap(path: Path) -> bool:
    """Return True for an MCAP file with a schema of ROS 1."""
    if path.is_dir() or path.suffix != MCAP:
        return False
    with path.open("rb") as file:
        if file.read(len(MCAP_MAGIC)) != MCAP_MAGIC:
            raise BadFile(path, "this is not an MCAP file", "name a file that a recorder has closed")
        file.seek(0)
        summary = make_reader(file).get_summary()
    schemas = () if summary is None else summary.schemas.values()
    return any(schema.encoding == SchemaEncoding.ROS1 for schema in schemas)


def _repack(path: Path, bag: Path) -> None:
    """Write the messages of an MCAP file of ROS 1 to a bag, byte for byte."""
    target = BagFile(bag)
    connections: dict[int, BagConnection] = {}
    so_far = UnpackedBytes(size_of(path))
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            so_far.add(len(message.data))  # Bytes are counted, because an index can list a chunk several times.
            if schema is None or channel.message_encoding != MessageEncoding.ROS1:
                continue
            connection = connections.get(channel.id)
            if connection is None:
                text, meta = schema.data.decode(), channel.metadata
                md5 = meta.get("md5sum") or md5_of(schema.name, text) or "*"
                latching = {"true": True, "1": True, "false": False, "0": False}.get(meta.get("latching", ""))
                connection = target.connect(channel.topic, schema.name, md5, text, meta.get("callerid"), latching)
                connections[channel.id] = connection
            target.write(connection, message.log_time, message.data)
    target.close()


def _convert(path: Path, bag: Path, unchanged: bool) -> dict[str, str]:
    """Write the messages of a ROS 2 recording to a bag; return the topics that were left out, with reasons."""
    ours = get_typestore(Stores.EMPTY)
    ours.register(typestore().fielddefs)
    target = BagFile(bag)
    ways: dict[int, tuple[BagConnection, Callable[[bytes], bytes]]] = {}
    left_out: dict[str, str] = {}
    with open_reader(path) as reader:
        for source in reader.connections:
            try:
                msgtype, convert = _conversion(source.msgtype, reader.typestore, ours)
            except (TypesysError, LookupError, ValueError, AttributeError) as error:
                left_out[source.topic] = f"{source.msgtype}: {_sentence(error)}"
                continue
            text, md5 = ours.generate_msgdef(msgtype)
            profiles = getattr(source.ext, "offered_qos_profiles", ())
            latching = any(profile.durability is QosDurability.TRANSIENT_LOCAL for profile in profiles)
            name = msgtype.replace("/msg/", "/")
            ways[source.id] = target.connect(source.topic, name, md5, text, None, latching), convert
        known = [source for source in reader.connections if source.id in ways]
        for source, stamp_ns, data in stored_messages(path, reader, known) if known else ():
            connection, convert = ways[source.id]
            target.write(connection, stamp_ns, bytes(data) if unchanged else convert(bytes(data)))
    target.close()
    return left_out


def _conversion(msgtype: str, theirs: Typestore, ours: Typestore) -> tuple[str, Callable[[bytes], bytes]]:
    """Return the ROS 1 type for messages of a ROS 2 type, and the converter. A new type is added to `ours`."""
    target = ros1_name(msgtype)
    if target not in ours.fielddefs:
        text, _ = theirs.generate_msgdef(msgtype, ros_version=1)
        found = types_in(target, text)
        register(ours, {name: fields for name, fields in found.items() if name not in ours.fielddefs})

    @cache
    def decoding() -> Callable[[bytes], memoryview]:
        """Return rosbags' converter, which also converts numbers of other sizes, and CDR in big-endian order."""
        with redirect_stdout(io.StringIO()):  # The converter prints what it will do.
            return generate_message_converter(theirs, ours, msgtype, target, {}, src_is2=True, dst_is2=False)

    def decoded(data: bytes) -> bytes:
        return bytes(decoding()(data))

    try:
        copy = MessageCopy(theirs.fielddefs, msgtype, ours.fielddefs, target, to_cdr=False)
    except ValueError:
        decoding()  # Types that it cannot convert raise an error here.
        return target, decoded
    return target, lambda data: copy(data) if data.startswith(CDR_HEAD[:2]) else decoded(data)

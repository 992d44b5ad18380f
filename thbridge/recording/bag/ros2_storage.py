"""Reading of rosbag2's storages with limits: packed files and messages, SQLite, and untrusted metadata.

rosbags unpacks without limits, and does not limit SQLite and YAML. So a few kilobytes could expand to gigabytes.
"""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path, PurePath
from typing import cast

import apsw
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader
from rosbags.typesys import Stores, get_typestore
from ruamel.yaml import YAML
from ruamel.yaml.events import AliasEvent, CollectionEndEvent, CollectionStartEvent, NodeEvent

from thbridge.files.disk.inside import path_inside
from thbridge.files.disk.regular_files import content_of, open_regular
from thbridge.files.errors import BadFile
from thbridge.recording.bag.damage import TooLargeChunk
from thbridge.recording.bag.unpacking import ALWAYS, UnpackedBytes, check_mcap, unpack_file, unpacked_message
from thbridge.recording.recordings import METADATA

LARGEST_METADATA = 1 << 26
"""Largest size of metadata.yaml, in bytes. It has a few hundred bytes for each file and topic. For our sessions, it
also contains the study."""
MOST_VALUES = 1 << 20
"""Maximum number of values in metadata.yaml, with aliases expanded."""
_INFORMATION = "rosbag2_bagfile_information"

_STEPS_ALWAYS, _STEPS_BYTE, _STEPS_ONCE = 1 << 26, 128, 1 << 16
"""Steps of SQLite's virtual machine: steps allowed for any file, further steps allowed for each byte of the file, and
steps between two checks.

A message has at least a dozen bytes, and needs about twenty steps in each of three queries.
"""


@contextmanager
def plain_recording(path: Path, work: Path) -> Iterator[Path]:
    """Yield the path of an unpacked recording of ROS 2 or MCAP file: its own path, or the path of a temporary copy.

    MCAP files in the recording are checked.

    Args:
        path: the file or folder.
        work: a folder for the copy.

    Raises:
        TooLargeChunk: its unpacked size is above the limit.
        BadFile: a file of the recording is a pipe or a device, or a link leads out of the recording's folder.
        OSError, YAMLError: a file cannot be read.
    """
    for file in path.rglob("*") if path.is_dir() else [path]:
        if file.is_symlink() and file != path:
            path_inside(path, *file.relative_to(path).parts)
        if file.exists() and not file.is_dir():
            open_regular(file).close()
    copy = _unpacked_folder(path, work) if path.is_dir() else None
    try:
        plain = copy or path
        for file in plain.rglob("*") if plain.is_dir() else [plain]:
            check_mcap(file)
        yield plain
    finally:
        if copy is not None:
            shutil.rmtree(copy, ignore_errors=True)


def stored_messages(path: Path, reader: AnyReader, known: list[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
    """Yield the messages of an open reader, with their stamps; messages that are packed one by one are unpacked.

    Raises:
        TooLargeChunk: the messages are larger than a recording of this size can contain.
    """
    size = size_of(path)
    (opened,) = cast(Sequence[Reader], reader.readers)
    storage = opened.storage
    is_packed = storage.metadata.compression_mode == "message"
    storage.metadata = storage.metadata._replace(compression_mode=None)  # rosbags would unpack without limits.
    # An MCAP index can refer to a chunk twice. SQLite has each message once, unless its table is a computed view.
    sqlite = any(isinstance(file, Sqlite3Reader) for file in (storage, *getattr(storage, "storages", ())))
    stored = UnpackedBytes(0, size) if sqlite else UnpackedBytes(size)
    so_far = UnpackedBytes(size)
    for source, stamp_ns, data in reader.messages(known):
        stored.add(len(data))
        yield source, stamp_ns, unpacked_message(bytes(data), so_far) if is_packed else data


def open_reader(path: Path) -> AnyReader:
    """Return a reader of a ROS 2 recording. Open and use the reader inside `bounded_sqlite`."""
    # Older recordings have no definitions; the definitions of Humble fit all types that have not changed.
    return AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))


@contextmanager
def bounded_sqlite(path: Path) -> Iterator[None]:
    """Limit SQLite's work on the files of a recording that are opened during the block.

    Raises:
        TooLargeChunk: a query takes more steps than a recording of this size can need. (A table can refer to a page of
            the file any number of times.)
    """
    left = _STEPS_ALWAYS + _STEPS_BYTE * size_of(path)
    exceeded = False

    def count() -> bool:
        nonlocal left, exceeded
        left -= _STEPS_ONCE
        exceeded = exceeded or left < 0
        return exceeded

    def bound(connection: apsw.Connection) -> None:
        connection.limit(apsw.SQLITE_LIMIT_LENGTH, ALWAYS)
        connection.set_progress_handler(count, _STEPS_ONCE)

    apsw.connection_hooks.append(bound)
    try:
        yield
    except TooLargeChunk:
        raise
    except Exception as error:
        if exceeded or isinstance(error, apsw.TooBigError):
            problem = "the database expands to more data than a recording of this size can contain"
            raise TooLargeChunk(problem) from error
        raise
    finally:
        apsw.connection_hooks.remove(bound)


def size_of(path: Path) -> int:
    """Return the size of a recording in bytes: of its file, or of all files in its folder."""
    return sum(file.stat().st_size for file in path.iterdir()) if path.is_dir() else path.stat().st_size


def _unpacked_folder(path: Path, work: Path) -> Path | None:
    """Return an unpacked copy of a folder that has packed files; None for a folder without packed files."""
    text = content_of(path / METADATA, LARGEST_METADATA).decode()
    _check_aliases(path / METADATA, text)
    metadata = cast(dict[str, dict[str, object]], YAML(typ="safe").load(text))
    facts = metadata.get(_INFORMATION) if isinstance(metadata, dict) else None
    if not isinstance(facts, dict) or str(facts.get("compression_mode")).lower() != "file":
        return None
    packing, names = facts.get("compression_format"), facts.get("relative_file_paths")
    if packing != "zstd" or not isinstance(names, list):
        return None  # The reader reports the error.
    copy = work / "unpacked"
    copy.mkdir()
    try:
        files = [PurePath(str(name)) for name in names]
        so_far = UnpackedBytes(size_of(path))
        for file in files:
            unpack_file(path_inside(path, file.name), path_inside(copy, file.stem), so_far)
        facts |= {"compression_format": "", "compression_mode": "", "relative_file_paths": [it.stem for it in files]}
        with (copy / METADATA).open("w", encoding="utf-8") as out:
            YAML(typ="safe").dump(metadata, out)
    except BaseException:
        shutil.rmtree(copy, ignore_errors=True)
        raise
    return copy


def _check_aliases(path: Path, text: str) -> None:
    """Raise BadFile if a document has too many values with aliases expanded, because error messages expand them."""
    sizes: dict[str, int] = {}
    open_nodes: list[tuple[str | None, int]] = []
    count = 0
    for event in YAML(typ="safe", pure=True).parse(text):
        if isinstance(event, AliasEvent):
            count += sizes.get(str(event.anchor), 1)
        elif isinstance(event, CollectionEndEvent):
            anchor, before = open_nodes.pop()
            if anchor is not None:
                sizes[str(anchor)] = count - before
        elif isinstance(event, NodeEvent):
            count += 1
            if isinstance(event, CollectionStartEvent):
                open_nodes.append((event.anchor, count - 1))
        if count > MOST_VALUES:
            remedy = "the file is forged or damaged; name another recording"
            raise BadFile(path, f"more than {MOST_VALUES} values", remedy)

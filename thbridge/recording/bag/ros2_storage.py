"""Reading of rosbag2's storages within bounds: packed files and messages, SQLite and metadata of others.

rosbags unpacks whatever there is, and lets SQLite and YAML multiply as they like; some kilobytes could stand for
gigabytes.
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

METADATA = "metadata.yaml"
LARGEST_METADATA = 1 << 26
"""Bytes of metadata.yaml; it has some hundred for each file and topic, and the study of a session of ours."""
MOST_VALUES = 1 << 20
"""Values in it, its aliases expanded."""
_INFORMATION = "rosbag2_bagfile_information"

_STEPS_ALWAYS, _STEPS_BYTE, _STEPS_ONCE = 1 << 26, 128, 1 << 16
"""Steps of SQLite's virtual machine for all of a file, for each of its bytes, and between two counts of them.

A message has at least a dozen bytes, and takes some twenty steps in each of three queries.
"""


@contextmanager
def plain_recording(path: Path, work: Path) -> Iterator[Path]:
    """Yield a recording of ROS 2 or an MCAP file whose files are not packed as a whole: itself, or a copy for the time.

    Its MCAP files are checked.

    Args:
        path: the file or folder.
        work: a folder for the copy.

    Raises:
        TooLargeChunk: it unpacks to more than it may.
        BadFile: a file of it is a pipe or a device, or a link leads out of its folder.
        OSError, YAMLError: it cannot be read.
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
    """Yield the messages of an open reader, with their stamps; those that are packed one by one are unpacked.

    Raises:
        TooLargeChunk: they are more than a recording of its size can hold.
    """
    size = size_of(path)
    (opened,) = cast(Sequence[Reader], reader.readers)
    storage = opened.storage
    is_packed = storage.metadata.compression_mode == "message"
    storage.metadata = storage.metadata._replace(compression_mode=None)  # rosbags unpacks without bounds
    # An index of MCAP can name a chunk twice. SQLite has each message once, unless its table computes them.
    sqlite = any(isinstance(file, Sqlite3Reader) for file in (storage, *getattr(storage, "storages", ())))
    stored = UnpackedBytes(0, size) if sqlite else UnpackedBytes(size)
    so_far = UnpackedBytes(size)
    for source, stamp_ns, data in reader.messages(known):
        stored.add(len(data))
        yield source, stamp_ns, unpacked_message(bytes(data), so_far) if is_packed else data


def open_reader(path: Path) -> AnyReader:
    """A reader of a recording of ROS 2, not yet open; within `bounded_sqlite` it opens, and reads, within bounds."""
    # Older recordings have no definitions; those of Humble fit all that does not change.
    return AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))


@contextmanager
def bounded_sqlite(path: Path) -> Iterator[None]:
    """Bound what SQLite does with the files of a recording that are opened within the block.

    Raises:
        TooLargeChunk: it takes more steps than a recording of its size can need; a table can refer to a page of the
            file any number of times.
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
            raise TooLargeChunk("its database expands to more than a recording of its size can hold") from error
        raise
    finally:
        apsw.connection_hooks.remove(bound)


def size_of(path: Path) -> int:
    """Bytes of a recording: of its file, or of all files in its folder."""
    return sum(file.stat().st_size for file in path.iterdir()) if path.is_dir() else path.stat().st_size


def _unpacked_folder(path: Path, work: Path) -> Path | None:
    """A copy of a folder of which each file is packed, without that; None for another."""
    text = content_of(path / METADATA, LARGEST_METADATA).decode()
    _check_aliases(path / METADATA, text)
    metadata = cast(dict[str, dict[str, object]], YAML(typ="safe").load(text))
    told = metadata.get(_INFORMATION) if isinstance(metadata, dict) else None
    if not isinstance(told, dict) or str(told.get("compression_mode")).lower() != "file":
        return None
    packing, names = told.get("compression_format"), told.get("relative_file_paths")
    if packing != "zstd" or not isinstance(names, list):
        return None  # which its reader tells
    copy = work / "unpacked"
    copy.mkdir()
    try:
        files = [PurePath(str(name)) for name in names]
        so_far = UnpackedBytes(size_of(path))
        for file in files:
            unpack_file(path_inside(path, file.name), path_inside(copy, file.stem), so_far)
        told |= {"compression_format": "", "compression_mode": "", "relative_file_paths": [it.stem for it in files]}
        with (copy / METADATA).open("w", encoding="utf-8") as out:
            YAML(typ="safe").dump(metadata, out)
    except BaseException:
        shutil.rmtree(copy, ignore_errors=True)
        raise
    return copy


def _check_aliases(path: Path, text: str) -> None:
    """Raise BadFile when the values of a document are too many with its aliases expanded, as texts of faults do it."""
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
            raise BadFile(path, f"more than {MOST_VALUES} values", "it is forged or damaged; name another recording")

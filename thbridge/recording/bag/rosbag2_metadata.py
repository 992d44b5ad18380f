"""The file metadata.yaml of a folder of rosbag2, version 9, computed from the folder's MCAP files."""

from collections.abc import Mapping
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from mcap.reader import make_reader
from mcap.records import Channel
from ruamel.yaml import YAML

from thbridge.files.disk.whole import write_whole
from thbridge.recording.bag.damage import damaged
from thbridge.recording.recordings import MCAP, METADATA, files_in
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros2.recorded_types import DISTRIBUTION, recorded_type

STUDY = "study.yaml"
SESSION = "thbridge:session"
VERSION = 9
"""Version of the metadata, which rosbag2 writes since Jazzy."""


@dataclass(frozen=True, slots=True)
class _File:
    """Facts about one MCAP file: its name, first and last stamp (nanoseconds), and its channels with their messages."""

    name: str
    start_ns: int
    end_ns: int
    counts: Mapping[int, int]
    channels: Mapping[int, Channel]
    schemas: Mapping[int, str]

    @property
    def messages(self) -> int:
        """Number of messages."""
        return sum(self.counts.values())

    def times(self) -> dict[str, object]:
        """Return start and duration as in the metadata."""
        return _times(self.start_ns, self.end_ns)


def write_metadata(folder: Path) -> None:
    """Write metadata.yaml for the complete MCAP files of a folder, `STEM_0.mcap` and so on.

    Raises:
        BadFile: a file has no index.
        OSError: a file cannot be read or written.
    """
    files = [_file(path) for _, path in files_in(folder, MCAP)]
    started = [file for file in files if file.messages]
    start, end = min((each.start_ns for each in started), default=0), max((each.end_ns for each in started), default=0)
    topics: dict[tuple[str, str], dict[str, object]] = {}
    counts: dict[tuple[str, str], int] = {}
    for file in files:
        for number, channel in file.channels.items():
            key = channel.topic, file.schemas[channel.schema_id]
            counts[key] = counts.get(key, 0) + file.counts.get(number, 0)
            topics.setdefault(key, _topic(channel, key[1]))
    information = {
        "version": VERSION,
        "storage_identifier": "mcap",
        **_times(start, end),
        "message_count": sum(counts.values()),
        "topics_with_message_count": [
            {"topic_metadata": topic, "message_count": counts[key]} for key, topic in topics.items()
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file.name for file in files],
        "files": [{"path": file.name, **file.times(), "message_count": file.messages} for file in files],
        "custom_data": _session_facts(folder / files[0].name) if files else None,
        "ros_distro": DISTRIBUTION,
    }
    text = StringIO()
    yaml = YAML(typ="safe")
    yaml.default_flow_style = False
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]  # ruamel's annotation is wrong
    yaml.dump({"rosbag2_bagfile_information": information}, text)
    write_whole(folder / METADATA, text.getvalue().encode())


def _times(start_ns: int, end_ns: int) -> dict[str, object]:
    return {
        "duration": {"nanoseconds": end_ns - start_ns},
        "starting_time": {"nanoseconds_since_epoch": start_ns},
    }


def _file(path: Path) -> _File:
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    if summary is None or summary.statistics is None:
        raise damaged(path)
    found = summary.statistics
    return _File(
        path.name,
        found.message_start_time,
        found.message_end_time,
        found.channel_message_counts,
        summary.channels,
        {number: schema.name for number, schema in summary.schemas.items()},
    )


def _topic(channel: Channel, msgtype: str) -> dict[str, object]:
    return {
        "name": channel.topic,
        "type": msgtype,
        "serialization_format": channel.message_encoding,
        "offered_qos_profiles": YAML(typ="safe").load(channel.metadata.get("offered_qos_profiles", "")) or [],
        "type_description_hash": channel.metadata.get("topic_type_hash", ""),
    }


def _session_facts(path: Path) -> dict[str, str] | None:
    """Return study, seed and versions of a session of thbridge; None for other recordings."""
    with path.open("rb") as file:
        first = next(make_reader(file).iter_messages([names.SESSION]), None)
    if first is None:
        return None
    _, _, message = first
    try:
        plain = types.plain_definition(types.SESSION)
        session = unpack.session(recorded_type(types.SESSION, plain.text).to_ros1(message.data))
    except ValueError:
        return None  # Another release made the recording.
    facts = {"seed": str(session.seed), **session.versions}
    return {STUDY: session.study, **{f"{SESSION}:{name}": value for name, value in facts.items()}}

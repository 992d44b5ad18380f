"""Conversion of a recording to MCAP, the format that Foxglove prefers.

Source: mcap.dev, the profile `ros1` and the registry of encodings. Channels have md5sum, as with `mcap convert`.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import IO

from mcap.well_known import MessageEncoding, Profile, SchemaEncoding
from mcap.writer import CompressionType, Writer

from thbridge.files.disk.new_file import new_file
from thbridge.files.progress import Tell, followed, untold
from thbridge.recording.bag.reading.reader import info, recorded
from thbridge.recording.bag.records import BagConnection
from thbridge.ros.messages import unpack
from thbridge.ros.messages.identification import missing_types
from thbridge.ros.messages.types import SESSION

COMPRESSIONS = {"zstd": CompressionType.ZSTD, "lz4": CompressionType.LZ4, "none": CompressionType.NONE}
METADATA = "thbridge:session"
STUDY = "study.yaml"


@dataclass(frozen=True, slots=True)
class McapResult:
    """Result of a conversion.

    Attributes:
        path: MCAP file.
        messages: number of messages.
        channels: number of publishers.
        session: True if the bag has a session record of thbridge.
        undefined: topics without a complete definition, which readers cannot decode.
    """

    path: Path
    messages: int
    channels: int
    session: bool
    undefined: tuple[str, ...] = ()


def to_mcap(
    bag: Path, out: Path, compression: str = "zstd", overwrite: bool = False, tell: Tell = untold
) -> McapResult:
    """Write a recording as an MCAP file that has the same message bytes, definitions and publishers.

    For sessions of thbridge, the file also has the attachment `study.yaml` and the metadata `thbridge:session`, with
    seed and versions.

    Args:
        bag: recording, or name of a split recording.
        out: new file.
        compression: "zstd", "lz4" or "none".
        overwrite: True to replace an existing file.
        `tell`: receives the progress.

    Raises:
        BadFile: the bag cannot be read, or the file cannot be written.
        KeyError: there is no such compression.
    """
    with new_file(out, bag, overwrite) as path, path.open("wb") as file:
        conversion = _Conversion(file, COMPRESSIONS[compression])
        for publisher, stamp_ns, data in followed(recorded(bag), "messages", info(bag).messages, tell):
            conversion.add(publisher, stamp_ns, data)
        conversion.finish()
    return McapResult(
        out, conversion.messages, conversion.channels, conversion.session, tuple(sorted(conversion.undefined))
    )


class _Conversion:
    """MCAP file that is being written."""

    def __init__(self, file: IO[bytes], compression: CompressionType) -> None:
        self.messages = 0
        self.session = False
        self.undefined: set[str] = set()
        self._writer = Writer(file, compression=compression)
        self._writer.start(Profile.ROS1, "thbridge")
        self._schemas: dict[tuple[str, str], int] = {}
        self._channels: dict[BagConnection, int] = {}
        self._sequences: dict[int, int] = {}

    @property
    def channels(self) -> int:
        """Number of channels so far."""
        return len(self._channels)

    def add(self, publisher: BagConnection, stamp_ns: int, data: bytes) -> None:
        channel = self._channels.get(publisher)
        if channel is None:
            channel = self._channels[publisher] = self._channel(publisher)
        sequence = self._sequences[channel] = self._sequences.get(channel, 0) + 1
        # A bag has only one time for each message, the time of recording.
        self._writer.add_message(channel, stamp_ns, data, publish_time=stamp_ns, sequence=sequence)
        self.messages += 1
        if publisher.msgtype == SESSION and not self.session:
            self._keep_session(stamp_ns, data)

    def finish(self) -> None:
        self._writer.finish()  # type: ignore[no-untyped-call]  # mcap has no annotation there

    def _channel(self, publisher: BagConnection) -> int:
        if missing_types(publisher.msgtype, publisher.md5, publisher.definition):
            self.undefined.add(publisher.topic)
        kind = (publisher.msgtype, publisher.definition)
        if kind not in self._schemas:
            text = publisher.definition.encode()
            self._schemas[kind] = self._writer.register_schema(publisher.msgtype, SchemaEncoding.ROS1, text)
        metadata = {"md5sum": publisher.md5}
        if publisher.caller is not None:
            metadata["callerid"] = publisher.caller
        if publisher.latching is not None:
            metadata["latching"] = "true" if publisher.latching else "false"
        return self._writer.register_channel(publisher.topic, MessageEncoding.ROS1, self._schemas[kind], metadata)

    def _keep_session(self, stamp_ns: int, data: bytes) -> None:
        try:
            session = unpack.session(data)
        except ValueError:
            return  # recorded by a version with other fields; the message itself is kept
        self._writer.add_attachment(stamp_ns, stamp_ns, STUDY, "application/yaml", session.study.encode())
        self._writer.add_metadata(METADATA, {"seed": str(session.seed), **session.versions})
        self.session = True

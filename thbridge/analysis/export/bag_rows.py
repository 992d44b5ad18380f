"""Rows of a bag's tables: the chosen messages, and other messages needed to interpret them."""

from collections.abc import Collection, Iterator
from pathlib import Path

from thbridge.analysis.export.exporting import ExportSummary, export, rooms_in, session_in
from thbridge.analysis.export.tables import TableRows
from thbridge.analysis.report.game_starts import game_starts
from thbridge.files.progress import Tell, followed, untold
from thbridge.recording.bag.reading.reader import info, recorded
from thbridge.recording.bag.records import BagConnection
from thbridge.ros.messages.types import SESSION
from thbridge.ros.names import ROOMS


def rows_of_bag(
    bag: Path,
    exported: ExportSummary,
    topics: Collection[str] | None = None,
    start: float = 0.0,
    until: float | None = None,
    tables: Collection[str] | None = None,
    tell: Tell = untold,
) -> Iterator[TableRows]:
    """Yield the rows of a recording's tables in pieces; the rows of one table are in order.

    Args:
        bag: bag, or name of a split recording.
        exported: summary to fill.
        topics: names of the topics to export. If None, all topics are exported.
        start: start of the export, seconds from the beginning of the recording.
        until: end of the export, seconds from the beginning of the recording. If None, everything is exported.
        tables: names of the tables to create, including tables of lists. If None, all tables are created.
        `tell`: receives the progress.

    Raises:
        BadFile: the bag cannot be read.
    """
    found = info(bag)
    first_ns = found.start_ns or 0
    # The session and the names of rooms are always read, because no table can be interpreted without them.
    sessions = frozenset(topic.name for topic in found.topics if topic.msgtype == SESSION)
    read = None if topics is None else sessions.union(topics, {ROOMS} & {topic.name for topic in found.topics})

    def wanted() -> Iterator[tuple[BagConnection, int, bytes]]:
        total = sum(topic.messages for topic in found.topics if read is None or topic.name in read)
        for publisher, stamp_ns, data in followed(recorded(bag, read), "messages", total, tell):
            if publisher.topic in sessions:
                exported.session = exported.session or session_in(data)
            elif publisher.topic == ROOMS:
                exported.rooms = rooms_in(data)
            if topics is not None and publisher.topic not in topics:
                continue
            seconds = (stamp_ns - first_ns) / 1e9
            if start <= seconds and (until is None or seconds <= until):
                yield publisher, stamp_ns, data

    return export(wanted(), first_ns, exported, game_starts(bag), tables)

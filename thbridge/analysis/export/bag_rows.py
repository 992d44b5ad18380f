"""Rows of the tables of a bag: the messages that are chosen, with what else is needed to read them."""

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
    """Yield the rows of a recording's tables in pieces; those of one table are in order.

    Args:
        bag: the bag, or the name of a split recording.
        exported: the summary to fill.
        topics: names of the topics to export; None for all.
        start: seconds after the recording's beginning.
        until: seconds after the recording's beginning; None for its end.
        tables: names of the tables to make, with the tables of their lists; None for all.
        tell: takes how far it is.

    Raises:
        BadFile: the bag cannot be read.
    """
    found = info(bag)
    first_ns = found.start_ns or 0
    # The session is read whatever is chosen: without its conditions no table can be used. So are the names of rooms.
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

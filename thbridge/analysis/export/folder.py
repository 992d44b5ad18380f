"""Export of a bag to a folder of tables."""

from collections.abc import Collection, Iterator
from pathlib import Path

from thbridge.analysis.export.dictionary import dictionary_csv, readme, session_json
from thbridge.analysis.export.exporting import ExportSummary, export, rooms_in, session_in
from thbridge.analysis.games import game_starts
from thbridge.files.errors import BadFile, reason_of
from thbridge.files.table_files import TableFiles, TableFormat
from thbridge.recording.bag.reader import info, recorded
from thbridge.recording.bag.records import BagConnection
from thbridge.ros.messages.types import SESSION
from thbridge.ros.names import ROOMS


def export_bag(
    bag: Path,
    folder: Path,
    formats: Collection[TableFormat],
    topics: Collection[str] | None = None,
    start: float = 0.0,
    until: float | None = None,
    tables: Collection[str] | None = None,
) -> ExportSummary:
    """Write the tables of a recording, its data dictionary, a README and its session.json.

    Args:
        bag: the bag, or the name of a split recording.
        folder: the folder to write; made if it is missing.
        formats: formats of the tables.
        topics: names of the topics to export; None for all.
        start: seconds after the recording's beginning.
        until: seconds after the recording's beginning; None for its end.
        tables: names of the tables to write, with the tables of their lists; None for all.

    Raises:
        BadFile: the bag cannot be read, or the folder is not empty or cannot be written.
    """
    found, exported = info(bag), ExportSummary()
    first_ns = found.start_ns or 0

    # The session is read whatever is chosen: without its conditions no table can be used. So are the names of rooms.
    sessions = frozenset(topic.name for topic in found.topics if topic.msgtype == SESSION)
    read = None if topics is None else sessions.union(topics, {ROOMS} & {topic.name for topic in found.topics})

    def wanted() -> Iterator[tuple[BagConnection, int, bytes]]:
        for publisher, stamp_ns, data in recorded(bag, read):
            if publisher.topic in sessions:
                exported.session = exported.session or session_in(data)
            elif publisher.topic == ROOMS:
                exported.rooms = rooms_in(data)
            if topics is not None and publisher.topic not in topics:
                continue
            seconds = (stamp_ns - first_ns) / 1e9
            if start <= seconds and (until is None or seconds <= until):
                yield publisher, stamp_ns, data

    try:
        folder.mkdir(parents=True, exist_ok=True)
        if next(folder.iterdir(), None) is not None:
            raise BadFile(folder, "there is something in this folder", "choose a new or an empty one by --to")
        files = TableFiles(folder, formats)
        try:
            for piece in export(wanted(), first_ns, exported, game_starts(bag), tables):
                files.write(piece.table.name, piece.table.columns, piece.values)
        finally:
            files.close()
        for name, text in (
            ("dictionary.csv", dictionary_csv(exported)),
            ("session.json", session_json(exported, bag.name, first_ns, found.duration)),
            ("README.md", readme(exported, bag.name, first_ns, found.duration)),
        ):
            (folder / name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise BadFile(folder, f"it cannot be written ({reason_of(error)})", "choose another folder by --to") from None
    return exported

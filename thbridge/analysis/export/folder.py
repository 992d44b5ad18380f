"""Export of a bag to a folder of tables."""

from collections.abc import Collection
from pathlib import Path

from thbridge.analysis.export.bag_rows import rows_of_bag
from thbridge.analysis.export.dictionary import dictionary_csv, readme, session_json
from thbridge.analysis.export.exporting import ExportSummary
from thbridge.files.disk.whole import new_folder
from thbridge.files.progress import Tell, untold
from thbridge.files.tables.table_files import TableFiles, TableFormat
from thbridge.recording.bag.reading.reader import info


def export_bag(
    bag: Path,
    folder: Path,
    formats: Collection[TableFormat],
    topics: Collection[str] | None = None,
    start: float = 0.0,
    until: float | None = None,
    tables: Collection[str] | None = None,
    tell: Tell = untold,
) -> ExportSummary:
    """Write the tables of a recording, its data dictionary, a README and its session.json.

    Args:
        bag: bag, or name of a split recording.
        folder: folder to write; a missing folder is created.
        formats: formats of the tables.
        topics: names of the topics to export. If None, all topics are exported.
        start: start of the export, seconds from the beginning of the recording.
        until: end of the export, seconds from the beginning of the recording. If None, everything is exported.
        tables: names of the tables to write, including tables of lists. If None, all tables are written.
        `tell`: receives the progress.

    Raises:
        BadFile: the bag cannot be read, or the folder is not empty or cannot be written.
    """
    found, exported = info(bag), ExportSummary()
    first_ns = found.start_ns or 0

    with new_folder(folder, "choose another folder with --to", empty=True) as new:
        files = TableFiles(new, formats)
        try:
            for piece in rows_of_bag(bag, exported, topics, start, until, tables, tell):
                files.write(piece.table.name, piece.table.columns, piece.values)
        finally:
            files.finish(tell)
        for name, text in (
            ("dictionary.csv", dictionary_csv(exported)),
            ("session.json", session_json(exported, bag.name, first_ns, found.duration)),
            ("README.md", readme(exported, bag.name, first_ns, found.duration)),
        ):
            (new / name).write_text(text, encoding="utf-8")
    return exported

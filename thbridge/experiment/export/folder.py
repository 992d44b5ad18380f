"""The export of an experiment: a Psych-DS folder with additional tables for pandas and R."""

import csv
import dataclasses
import hashlib
import io
import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.families.described import ExperimentTable
from thbridge.experiment.export.manifest import MANIFEST, last_event_of, manifest_text, register_export
from thbridge.experiment.export.methods.text import methods_text
from thbridge.experiment.export.psych_ds import dataset_description, file_name, sidecar
from thbridge.experiment.export.tables import ExperimentRecords, game_tables, group_tables, log_tables, records_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.recordings import notes_on_leftovers
from thbridge.experiment.store.events import LogEntry
from thbridge.files.disk.synced import make_folder, sync_file, sync_folder
from thbridge.files.disk.whole import PART, new_folder
from thbridge.files.errors import BadFile, reason_of
from thbridge.files.tables.csv_cells import SENTENCE, text_cell
from thbridge.files.tables.table_files import TableFiles, TableFormat

SCRIPTS = Path(__file__).parent / "scripts"


@dataclass(slots=True)
class WrittenExport:
    """A written export.

    Attributes:
        rows: number of rows of each table, by its name.
        notes: sentences about missing, changed or unreadable recordings, and about incomplete recordings after crashes.
    """

    rows: dict[str, int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def export_experiment(
    study: ExperimentFolder,
    design: ExperimentDesign,
    entries: Sequence[LogEntry],
    folder: Path,
    versions: Mapping[str, str],
    changed: Sequence[str] | None,
) -> WrittenExport:
    """Write an export. The study stores the path of the export's folder. Exports of the same log are bit-identical.

    Args:
        study: the experiment's folder, with its recordings.
        design: the experiment.
        entries: entries of its log.
        folder: target folder; it is created if it does not exist.
        versions: versions of the programs.
        changed: changes since the experiment was registered, or None if the experiment was not registered.

    Raises:
        BadFile: the folder is not empty, or cannot be written.
    """
    records = records_of(design, entries, study.root)
    with _writing(folder):
        make_folder(folder)
    # The hidden folder is inside the target: if the program is killed, withdrawals still find the data there.
    with new_folder(folder, "choose another folder with --to", empty=True) as new:
        register_export(study, folder)
        return _write_export(study, records, new, versions, changed)


def remake_export(
    study: ExperimentFolder,
    design: ExperimentDesign,
    entries: Sequence[LogEntry],
    folder: Path,
    versions: Mapping[str, str],
    changed: Sequence[str] | None,
) -> tuple[Path, ...]:
    """Write an export again in the same folder, from the same events of the log.

    Events that were deleted meanwhile are left out.

    Tables, texts and results of the scripts are replaced or deleted. Scripts that a user changed are kept. If the
    program is interrupted, the old manifest remains.

    Returns:
        Files and folders in the export's folder that do not belong to the export. They are not changed.

    Raises:
        BadFile: the export has no manifest, or cannot be written.
    """
    last = last_event_of(folder)
    if last is None:
        raise BadFile(
            folder, f"its {MANIFEST} is missing or damaged", "Delete this study's data in the folder yourself"
        )
    records = records_of(design, entries, study.root, last)
    new = _remade(folder)
    with _writing(folder), ExitStack() as written:
        shutil.rmtree(new, ignore_errors=True)
        new.mkdir()
        written.callback(shutil.rmtree, new, ignore_errors=True)
        _write_export(study, records, new, versions, changed, scripts=folder)
        kept = {path.name for path in new.iterdir()}
        for path in new.rglob("*"):
            (sync_folder if path.is_dir() else sync_file)(path)
        for name in ("results", "data", "tables"):
            if (folder / name).is_dir():
                shutil.rmtree(folder / name)
        # Replace the manifest last: while the old manifest exists, the export can be written again.
        for path in sorted(new.iterdir(), key=lambda path: path.name == MANIFEST):
            if path.name == MANIFEST:
                sync_folder(folder)
            path.replace(folder / path.name)
        sync_folder(folder)
        return tuple(sorted(path for path in folder.iterdir() if path.name not in kept))


def clear_remains(folder: Path) -> None:
    """Delete files of unfinished exports, which killed programs left in the export's folder and next to it."""
    for path in (_remade(folder), *folder.glob(f".all.*{PART}")):
        shutil.rmtree(path, ignore_errors=True)


def _remade(folder: Path) -> Path:
    """Return the temporary folder for writing an export again."""
    return folder.with_name(f".{folder.name}-new")


@contextmanager
def _writing(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise BadFile(folder, f"it cannot be written ({reason_of(error)})", "Choose another folder with --to") from None


def _write_export(
    study: ExperimentFolder,
    records: ExperimentRecords,
    folder: Path,
    versions: Mapping[str, str],
    changed: Sequence[str] | None,
    scripts: Path | None = None,
) -> WrittenExport:
    """Write the files of an export. Copy scripts from the folder `scripts` if they exist there."""
    for name in ("data", "tables"):
        (folder / name).mkdir(exist_ok=True)
    title, entries = records.design.file.title, records.progress.sequence
    (folder / MANIFEST).write_text(manifest_text(title, records.progress.runs, entries), encoding="utf-8")
    written, tables = _write_tables(records, folder)
    written.notes += notes_on_leftovers(study, records.progress, records.events)
    registered = _registered(study, changed)
    texts = {
        "dataset_description.json": dataset_description(title, tables, (_medium(records), registered, *written.notes)),
        "dictionary.csv": _dictionary(tables),
        "methods.md": methods_text(records, versions, registered),
        "README.md": _readme(records, tables, written),
        "CHANGES.md": "\n".join((registered, *written.notes)) + "\n",
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    for script in sorted(SCRIPTS.iterdir()):
        if script.suffix in {".py", ".R"}:
            changed_one = None if scripts is None else scripts / script.name
            source = script if changed_one is None or not changed_one.is_file() else changed_one
            (folder / script.name).write_bytes(source.read_bytes())
    (folder / "checksums.sha256").write_text(_checksums(folder), encoding="utf-8")
    return written


def _medium(records: ExperimentRecords) -> str:
    if records.is_rehearsal:
        return "Programs took part in this rehearsal instead of people: a treasure hunt with simulated robots."
    return "People took part in a treasure hunt with simulated robots, which they saw in a window."


def _registered(study: ExperimentFolder, changed: Sequence[str] | None) -> str:
    if changed is None:
        return "The experiment was not frozen for a preregistration."
    digest = json.loads(study.freeze.read_text(encoding="utf-8"))["digest"] if study.freeze.exists() else "unknown"
    if not changed:
        return f"The experiment has not changed since it was frozen for its preregistration (SHA-256 {digest})."
    frozen = f"Changes since the experiment was frozen for its preregistration (SHA-256 {digest})"
    return f"{frozen}: {'; '.join(changed)}."


def _write_tables(records: ExperimentRecords, folder: Path) -> tuple[WrittenExport, list[ExperimentTable]]:
    """Write all tables with at least one row. Return these tables without their rows."""
    title, written = records.design.file.title, WrittenExport()
    parquet = TableFiles(folder / "tables", [TableFormat.PARQUET])
    texts = TableFiles(folder / "data", [TableFormat.CSV])
    tables: dict[str, ExperimentTable] = {}
    for piece in log_tables(records):
        _write(piece, title, (parquet, texts), written, tables)
    for piece_or_note in game_tables(records):
        if isinstance(piece_or_note, str):
            written.notes.append(piece_or_note)
        else:
            _write(piece_or_note, title, (parquet, texts), written, tables)
    for piece in group_tables(records):
        _write(piece, title, (parquet, texts), written, tables)
    for files in (parquet, texts):
        files.finish(lambda *_: None)
    for table in tables.values():
        beside = (folder / "data" / file_name(title, table.name)).with_suffix(".json")
        beside.write_text(sidecar(table), encoding="utf-8")
    return written, [*tables.values()]


def _write(
    piece: ExperimentTable,
    title: str,
    files: tuple[TableFiles, TableFiles],
    written: WrittenExport,
    tables: dict[str, ExperimentTable],
) -> None:
    if not piece.rows:
        return
    columns, values = [column.column for column in piece.columns], piece.values()
    files[0].write(piece.name, columns, values)
    files[1].write(file_name(title, piece.name).removesuffix(".csv"), columns, values)
    written.rows[piece.name] = written.rows.get(piece.name, 0) + len(piece.rows)
    tables.setdefault(piece.name, dataclasses.replace(piece, rows=()))


def _dictionary(tables: Sequence[ExperimentTable]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("table", "column", "type", "unit", "meaning", "least", "greatest", "factor", "levels"))
    for table in tables:
        for each in table.columns:
            range_ = ("" if bound is None else f"{bound:g}" for bound in (each.least, each.greatest))
            row = (table.name, each.name, each.kind, each.unit, each.meaning, *range_, each.role)
            writer.writerow(map(text_cell, (*row, "; ".join(each.levels))))
    return text.getvalue()


def _readme(records: ExperimentRecords, tables: Sequence[ExperimentTable], written: WrittenExport) -> str:
    lines = [
        f"# {records.design.file.title}",
        "",
        _medium(records),
        "",
        *(f"* {note}" for note in written.notes),
        *([""] if written.notes else []),
        "| table | one row is | number of rows |",
        "|---|---|---|",
        *(f"| {table.name} | {table.meaning} | {written.rows[table.name]} |" for table in tables),
        "",
        "`tables/` has the tables as Parquet files with units. `data/` has the same tables as CSV files with Psych-DS "
        "names and descriptions.",
        SENTENCE,
        "`dictionary.csv` explains each column: its type, unit, meaning, range, and the levels of factors. The column",
        "`counts` is true for valid data: rows of complete runs that were not excluded, except practice and checks.",
        "`python analysis.py` (pandas, pyarrow, scipy, matplotlib) and `Rscript analysis.R` (base R) compare the "
        "conditions",
        "and write figures to `results/`. `methods.md` is a text for the paper. `manifest.json` lists the people in "
        "this export.",
        "`sha256sum -c checksums.sha256` checks whether a file was changed after the export.",
        "",
    ]
    return "\n".join(lines)


def _checksums(folder: Path) -> str:
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name != "checksums.sha256")
    return "".join(
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(folder).as_posix()}\n" for path in files
    )

"""The export of an experiment: a folder that Psych-DS accepts, with tables for pandas and R beside it."""

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
from thbridge.experiment.export.tables import ExperimentRecords, game_tables, log_tables, records_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.recordings import told_leftovers
from thbridge.experiment.store.events import LogEntry
from thbridge.files.disk.synced import make_folder, sync_file, sync_folder
from thbridge.files.disk.whole import PART, new_folder
from thbridge.files.errors import BadFile, reason_of
from thbridge.files.tables.csv_cells import SENTENCE, text_cell
from thbridge.files.tables.table_files import TableFiles, TableFormat

SCRIPTS = Path(__file__).parent / "scripts"


@dataclass(slots=True)
class WrittenExport:
    """Export that was written.

    Attributes:
        rows: number of rows of each table, by its name.
        notes: sentences on recordings that are missing, changed, or cannot be read, and on those left by crashes.
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
    """Write an export; the study's folder keeps where it is. Exports of the same log are the same to the byte.

    Args:
        study: the experiment's folder, with its recordings.
        design: the experiment.
        entries: its log.
        folder: where to; made if it is missing.
        versions: of the programs.
        changed: what differs from the registered experiment; None: it was not registered.

    Raises:
        BadFile: there is something in the folder, or it cannot be written.
    """
    records = records_of(design, entries, study.root)
    with _writing(folder):
        make_folder(folder)
    # Within it: should this be killed, whoever withdraws is looked for there.
    with new_folder(folder, "choose another folder by --to", empty=True) as new:
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
    """Write an export anew where it is, of the same events of the log without those that were deleted since.

    Its tables and texts, and what its scripts wrote, are replaced or deleted; scripts that were changed stay. When this
    is interrupted, the old manifest is still there.

    Returns:
        Files and folders in it that no export has: they are as they were.

    Raises:
        BadFile: it has no manifest, or cannot be written.
    """
    last = last_event_of(folder)
    if last is None:
        raise BadFile(folder, f"its {MANIFEST} is missing or damaged", "Delete what is in it of this study yourself")
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
        # The manifest last: as long as it is the old one, this can be done once more.
        for path in sorted(new.iterdir(), key=lambda path: path.name == MANIFEST):
            if path.name == MANIFEST:
                sync_folder(folder)
            path.replace(folder / path.name)
        sync_folder(folder)
        return tuple(sorted(path for path in folder.iterdir() if path.name not in kept))


def clear_remains(folder: Path) -> None:
    """Delete what programs that were killed while they wrote an export have left in its folder and beside it."""
    for path in (_remade(folder), *folder.glob(f".all.*{PART}")):
        shutil.rmtree(path, ignore_errors=True)


def _remade(folder: Path) -> Path:
    """Return the folder in which an export is written again."""
    return folder.with_name(f".{folder.name}-new")


@contextmanager
def _writing(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise BadFile(folder, f"it cannot be written ({reason_of(error)})", "Choose another folder by --to") from None


def _write_export(
    study: ExperimentFolder,
    records: ExperimentRecords,
    folder: Path,
    versions: Mapping[str, str],
    changed: Sequence[str] | None,
    scripts: Path | None = None,
) -> WrittenExport:
    """Write the files of an export; those of its scripts that lie in `scripts` are taken from there."""
    for name in ("data", "tables"):
        (folder / name).mkdir(exist_ok=True)
    title, entries = records.design.file.title, records.progress.sequence
    (folder / MANIFEST).write_text(manifest_text(title, records.progress.runs, entries), encoding="utf-8")
    written, tables = _write_tables(records, folder)
    written.notes += told_leftovers(study, records.progress, records.events)
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
        return "Rehearsed by programs, without people: a treasure hunt with simulated robots."
    return "People on a treasure hunt with simulated robots, which they see in a window."


def _registered(study: ExperimentFolder, changed: Sequence[str] | None) -> str:
    if changed is None:
        return "The experiment was not frozen for a preregistration."
    digest = json.loads(study.freeze.read_text(encoding="utf-8"))["digest"] if study.freeze.exists() else "unknown"
    if not changed:
        return f"The experiment is the one that was frozen for its preregistration (SHA-256 {digest})."
    frozen = f"Since the experiment was frozen for its preregistration (SHA-256 {digest}), this changed"
    return f"{frozen}: {'; '.join(changed)}."


def _write_tables(records: ExperimentRecords, folder: Path) -> tuple[WrittenExport, list[ExperimentTable]]:
    """Write all tables; return them without rows. Tables without rows are left out."""
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
        "| table | a row is | rows |",
        "|---|---|---|",
        *(f"| {table.name} | {table.meaning} | {written.rows[table.name]} |" for table in tables),
        "",
        "`tables/` has them as Parquet, with units; `data/` as CSV, named as Psych-DS asks, each described beside it.",
        SENTENCE,
        "`dictionary.csv` explains each column: its type, unit, meaning, range, and of factors the levels. `counts` is",
        "true of rows that are data: those of complete runs that were not excluded, and of no practice or check.",
        "`python analysis.py` (pandas, pyarrow, scipy, matplotlib) and `Rscript analysis.R` (base R) compare",
        "conditions and draw them into `results/`. `methods.md` is for the paper. `manifest.json` says of whom",
        "this folder has data. `sha256sum -c checksums.sha256` tells whether all files are as they were exported.",
        "",
    ]
    return "\n".join(lines)


def _checksums(folder: Path) -> str:
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name != "checksums.sha256")
    return "".join(
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(folder).as_posix()}\n" for path in files
    )

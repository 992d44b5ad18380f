"""The export of an experiment: a folder that Psych-DS accepts, with tables for pandas and R beside it."""

import csv
import hashlib
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.methods import methods_text
from thbridge.experiment.export.psych_ds import dataset_description, file_name
from thbridge.experiment.export.tables import ExperimentTable, tables_of
from thbridge.experiment.progress import Progress
from thbridge.experiment.store.events import LogEntry
from thbridge.files.errors import BadFile, reason_of
from thbridge.files.table_files import TableFiles, TableFormat

SCRIPTS = Path(__file__).parent / "scripts"


def export_experiment(
    design: ExperimentDesign,
    entries: Sequence[LogEntry],
    folder: Path,
    versions: Mapping[str, str],
    changed: Sequence[str] | None,
) -> tuple[ExperimentTable, ...]:
    """Write an export.

    Args:
        design: the experiment.
        entries: its log.
        folder: where to; made if it is missing.
        versions: of the programs.
        changed: what differs from the registered experiment; None: it was not registered.

    Returns:
        The tables that were written.

    Raises:
        BadFile: there is something in the folder, or it cannot be written.
    """
    tables = tables_of(design, entries)
    progress = Progress(design).after(entries)
    registered = _registered(changed)
    try:
        (folder / "data").mkdir(parents=True, exist_ok=True)
        (folder / "tables").mkdir(exist_ok=True)
        if any(path.is_file() for path in folder.rglob("*")):
            raise BadFile(folder, "there is something in this folder", "Choose a new or an empty one by --to")
        named = {table.name: table for table in tables}
        _write_tables(tables, folder, design.file.title)
        texts = {
            "dataset_description.json": dataset_description(design.file.title, tables, (registered,)),
            "dictionary.csv": _dictionary(tables),
            "methods.md": methods_text(design, progress, named, versions, registered),
            "README.md": _readme(design, tables),
            "CHANGES.md": f"{registered}\n",
        }
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
        for script in sorted(SCRIPTS.iterdir()):
            if script.suffix in {".py", ".R"}:
                (folder / script.name).write_bytes(script.read_bytes())
        (folder / "checksums.sha256").write_text(_checksums(folder), encoding="utf-8")
    except OSError as error:
        raise BadFile(folder, f"it cannot be written ({reason_of(error)})", "Choose another folder by --to") from None
    return tables


def _registered(changed: Sequence[str] | None) -> str:
    if changed is None:
        return "The experiment was not frozen for a preregistration."
    if not changed:
        return "The experiment is the one that was frozen for its preregistration."
    return (
        f"Since the experiment was frozen for its preregistration, {len(changed)} things changed: {'; '.join(changed)}."
    )


def _write_tables(tables: Sequence[ExperimentTable], folder: Path, title: str) -> None:
    parquet = TableFiles(folder / "tables", [TableFormat.PARQUET])
    texts = TableFiles(folder / "data", [TableFormat.CSV])
    for table in tables:
        parquet.write(table.name, table.columns, table.values())
        texts.write(file_name(title, table.name).removesuffix(".csv"), table.columns, table.values())
    for files in (parquet, texts):
        files.finish(lambda *_: None)


def _dictionary(tables: Sequence[ExperimentTable]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("table", "column", "type", "unit", "meaning"))
    for table in tables:
        for column in table.columns:
            writer.writerow((table.name, column.name, column.kind, column.unit, column.meaning))
    return text.getvalue()


def _readme(design: ExperimentDesign, tables: Sequence[ExperimentTable]) -> str:
    lines = [f"# {design.file.title}", "", "| table | a row is |", "|---|---|"]
    lines += [f"| {table.name} | {table.meaning} |" for table in tables]
    lines += [
        "",
        "`tables/` has them as Parquet, with units; `data/` as CSV, named as Psych-DS asks. `dictionary.csv` explains",
        "each column. `python analysis.py` and `Rscript analysis.R` draw the scores of each condition. `methods.md`",
        "is for the paper. `sha256sum -c checksums.sha256` tells whether all files are as they were exported.",
        "",
    ]
    return "\n".join(lines)


def _checksums(folder: Path) -> str:
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name != "checksums.sha256")
    return "".join(
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(folder).as_posix()}\n" for path in files
    )

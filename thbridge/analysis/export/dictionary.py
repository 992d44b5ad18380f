"""Files next to exported tables: the data dictionary, a README, and the session's seed, study and versions."""

import csv
import io
import json

from thbridge.analysis.export.exporting import ExportSummary
from thbridge.files.tables.csv_cells import SENTENCE, text_cell

HEADER = ("table", "column", "type", "unit", "frame", "meaning")


def dictionary_csv(exported: ExportSummary) -> str:
    """Return the text of dictionary.csv: each column of each table."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    for name, (table, _) in sorted(exported.tables.items()):
        for column in table.columns:
            frame = exported.frames.get((name, column.name), "")
            row = (name, column.name, column.kind, column.unit, frame, column.meaning)
            writer.writerow(map(text_cell, row))
    return text.getvalue()


def session_json(exported: ExportSummary, bag: str, start_ns: int, duration: float) -> str:
    """Return the text of session.json: seed, study and versions; null if thbridge did not record the session."""
    session = exported.session
    values = {
        "bag": bag,
        "start_ns": start_ns,
        "duration_s": duration,
        "seed": None if session is None else session.seed,
        "versions": None if session is None else dict(sorted(session.versions.items())),
        "program": None if session is None else session.program,
        "roles": None if session is None else list(session.roles),
        "participant": None if session is None else session.participant,
        "study": None if session is None else session.study,
    }
    return json.dumps(values, indent=2, ensure_ascii=False) + "\n"


def readme(exported: ExportSummary, bag: str, start_ns: int, duration: float) -> str:
    """Return the text of README.md: the tables in the folder, and their conventions."""
    rows = [
        f"| `{name}` | {_cell(table.source)} | {_cell(table.msgtype)} | {count} | {_cell(table.meaning)} |"
        for name, (table, count) in sorted(exported.tables.items())
    ]
    notices = ["", "Not exported:", "", *(f"* {notice}" for notice in exported.notices)] if exported.notices else []
    return "\n".join(
        [
            f"# Tables of {bag}",
            "",
            f"{duration:.1f} s from {start_ns} ns. `dictionary.csv` explains each column, with its unit and frame;",
            "`session.json` describes the session: seed, study, versions.",
            "",
            "| table | source | type of a row | rows | meaning |",
            "|---|---|---|---|---|",
            *rows,
            *notices,
            "",
            *_CONVENTIONS,
            "",
        ]
    )


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


_CONVENTIONS = (
    "Conventions:",
    "",
    "* SI units and radians; a column's name ends with its unit. Angles are counterclockwise. Stamps are nanoseconds.",
    "* `t_s` is the time of recording since the beginning; `stamp_ns` is the stamp in the message itself.",
    "* Each quaternion (`qx` to `qw`) has a column with its `yaw_rad`; each covariance (36 columns",
    "  `..._cov_ROW_COLUMN`) has columns with the standard deviations of x, y and yaw.",
    "* Arrays of numbers are list columns in Parquet, and numbers separated by blanks in CSV. Bytes are base64 in CSV.",
    "* Arrays of messages are separate tables, `TABLE.FIELD`: `row` is the row of `TABLE` with the array, `index`",
    "  the index in this array. If a message consists of one array (tf), its elements are the topic's rows.",
    "* Simple values in the JSON of game events are columns `event_...`. Robots are numbered from 1; 0 means no robot.",
    f"* {SENTENCE}",
    "* `nan` in CSV and NaN in Parquet mean: the value was not measured, or is nan in the message itself.",
)

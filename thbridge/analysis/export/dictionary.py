"""Files beside exported tables: the data dictionary, a README, and the session's seed, study and versions."""

import csv
import io
import json

from thbridge.analysis.export.exporting import ExportSummary
from thbridge.files.tables.csv_cells import SENTENCE, text_cell

HEADER = ("table", "column", "type", "unit", "frame", "meaning")


def dictionary_csv(exported: ExportSummary) -> str:
    """The text of dictionary.csv: every column of every table."""
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
    """The text of session.json: seed, study and versions of the session; null for recordings of others."""
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
    """The text of README.md: the tables in the folder, and their conventions."""
    rows = [
        f"| `{name}` | {_cell(table.source)} | {_cell(table.msgtype)} | {count} | {_cell(table.meaning)} |"
        for name, (table, count) in sorted(exported.tables.items())
    ]
    notices = ["", "Not exported:", "", *(f"* {notice}" for notice in exported.notices)] if exported.notices else []
    return "\n".join(
        [
            f"# Tables of {bag}",
            "",
            f"{duration:.1f} s from {start_ns} ns. `dictionary.csv` says what each column is, its unit and its frame;",
            "`session.json` what the session was run with.",
            "",
            "| table | from | a row is | rows | |",
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
    "* `t_s` is the time of recording since the beginning; `stamp_ns` the stamp that the message itself carries.",
    "* Beside each quaternion (`qx` to `qw`) stands its `yaw_rad`; beside each covariance (36 columns",
    "  `..._cov_ROW_COLUMN`) the standard deviations of x, y and yaw.",
    "* Arrays of numbers are list columns in Parquet, and numbers with blanks between in CSV. Bytes are base64 in CSV.",
    "* Arrays of messages are tables of their own, `TABLE.FIELD`: `row` is the row of `TABLE` they belong to, `index`",
    "  the place in the array. Where a message is nothing but one array (tf), the elements are the topic's own rows.",
    "* Plain values in the JSON of game events are columns `event_...`. Robots count from 1, 0 is none.",
    f"* {SENTENCE}",
    "* `nan` in CSV and NaN in Parquet: not measured, or not a number in the message itself.",
)

"""Descriptions of an export and its tables for Psych-DS: JSON-LD files with schema.org terms.

Source: Psych-DS 1.0, https://psych-ds.github.io.
"""

import json
import re
from collections.abc import Iterable, Sequence

from thbridge.experiment.export.families.described import ColumnDescription, ExperimentTable

JsonLd = dict[str, object]

LONGEST_WORD = 100
"""Maximum number of characters of a title in a file name. File names have at most 255 bytes."""


def file_name(title: str, table: str) -> str:
    """Return the name of a table's file, with keywords and values as in Psych-DS. A long title is shortened."""
    return f"study-{_word(title)[:LONGEST_WORD]}_description-{_word(table.replace('_', ' '))}_data.csv"


def dataset_description(title: str, tables: Iterable[ExperimentTable], notes: Sequence[str]) -> str:
    """Return the text of dataset_description.json.

    Args:
        title: title of the experiment.
        tables: all exported tables. The text describes all columns. If several tables have a column with the same
            name, the text describes the column of the first table. The sidecar of each table describes the table's
            own column.
        notes: sentences about the data, for the description of the data set.
    """
    columns = {column.name: column for table in reversed([*tables]) for column in reversed(table.columns)}
    whole: JsonLd = {
        "@context": "https://schema.org",
        "@type": "Dataset",
        "name": title,
        "description": " ".join(notes),
        "schemaVersion": "Psych-DS 1.0.0",
        "variableMeasured": [_variable(column) for column in reversed(columns.values())],
        "keywords": ["human-robot interaction", "treasure hunt"],
    }
    return json.dumps(whole, indent=2, ensure_ascii=False) + "\n"


def sidecar(table: ExperimentTable) -> str:
    """Return the text of the file that describes the columns of one table."""
    described: JsonLd = {
        "@context": "https://schema.org",
        "@type": "Dataset",
        "name": table.name,
        "description": f"One row is {table.meaning}.",
        "variableMeasured": [_variable(column) for column in table.columns],
    }
    return json.dumps(described, indent=2, ensure_ascii=False) + "\n"


def _variable(column: ColumnDescription) -> JsonLd:
    described: JsonLd = {"@type": "PropertyValue", "name": column.name, "description": column.meaning}
    if column.unit:
        described["unitText"] = column.unit
    if column.least is not None:
        described["minValue"] = column.least
    if column.greatest is not None:
        described["maxValue"] = column.greatest
    if column.levels:
        described["valueReference"] = list(column.levels)
    return described


def _word(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9]", "", text.title() if " " in text else text) or "experiment"
